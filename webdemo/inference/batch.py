"""Several requests in one pass through the network, each otherwise run as if it were alone.

Every request runs in a thread of its own, through the engine as always, until it asks the denoiser for a
prediction, or the damping for a correction. There it waits for the others; then one pass answers all of them.
What a request is told differs from what it would be told alone by rounding only: its noise depends on its
seed, shorter motions are padded and the padding is not attended to, the damping's energy is a sum over
motions, and everything else is its own.
"""

from __future__ import annotations

import copy
import queue
import threading
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import torch
from torch import Tensor
from torch.nn.functional import pad

from models.intergen import InterGenDenoiser

from .cancel import CancelToken
from .damping import Damping, correct_together
from .engine import Engine
from .generator import DuetGenerator
from .requests import GenerateRequest, Progress, ReactRequest, Result

Event = Progress | Result | Exception


def run_batch(
    engine: Engine, items: Sequence[tuple[GenerateRequest | ReactRequest, CancelToken]]
) -> Iterator[tuple[int, Event]]:
    """Runs requests of one model, sampler and number of steps together.

    Args:
        engine: has the model.
        items: requests, each with what cancels it; a cancelled one leaves the others as they are.

    Yields:
        (index of a request, what happened to it): progress, then its result or the error that ended it.
    """
    generator = engine._generator(items[0][0].model)
    meeting = Meeting(generator.model.denoiser, len(items))
    events: queue.SimpleQueue[tuple[int, Event | None]] = queue.SimpleQueue()

    def work(i: int, request: GenerateRequest | ReactRequest, token: CancelToken) -> None:
        try:
            for event in _lane(engine, generator, meeting, i).run(request, cancel=token):
                events.put((i, event))
        except Exception as error:  # InputError and Cancelled, too: they are this request's alone
            events.put((i, error))
        finally:
            meeting.leave(i)
            events.put((i, None))

    for i, (request, token) in enumerate(items):
        threading.Thread(target=work, args=(i, request, token), name=f"lane {i}", daemon=True).start()
    left = len(items)
    while left:
        i, event = events.get()
        if event is None:
            left -= 1
        else:
            yield i, event


def _lane(engine: Engine, generator: DuetGenerator, meeting: Meeting, lane: int) -> Engine:
    """The engine with a generator whose denoiser meets the others'."""
    own = copy.copy(generator)
    own.model = _MeetingModel(generator.model, _MeetingDenoiser(meeting, lane))  # type: ignore[assignment]
    own.damp = partial(meeting.correct, lane)  # type: ignore[method-assign]
    alone = copy.copy(engine)
    alone._generators = {generator.name: own}
    return alone


class _MeetingModel:
    """A model in everything but its denoiser."""

    def __init__(self, model: Any, denoiser: _MeetingDenoiser) -> None:
        self._model, self.denoiser = model, denoiser

    def __getattr__(self, name: str) -> Any:
        return getattr(self._model, name)


class _MeetingDenoiser:
    """Predicts together with the other lanes of a meeting."""

    def __init__(self, meeting: Meeting, lane: int) -> None:
        self._meeting, self._lane = meeting, lane

    def guided(
        self, x: Tensor, t: Tensor, cond: Tensor, mask: Tensor | None = None, *, scale: float
    ) -> Tensor:
        """As :meth:`InterGenDenoiser.guided`."""
        return self._meeting.predict(self._lane, _Question(x, t, cond, mask, scale))


@dataclass(frozen=True)
class _Question:
    """What one lane asks of the denoiser; shapes as in :meth:`InterGenDenoiser.guided`."""

    x: Tensor
    t: Tensor
    cond: Tensor
    mask: Tensor | None
    scale: float


@dataclass(frozen=True)
class _Correction:
    """What one lane asks of the damping."""

    damping: Damping
    x0: Tensor
    timestep: int


class Meeting:
    """Where lanes wait for each other's questions; the last one to come answers all in one pass.

    Args:
        denoiser: answers.
        lanes: how many take part; each must :meth:`leave` in the end.
    """

    def __init__(self, denoiser: InterGenDenoiser, lanes: int) -> None:
        self.denoiser = denoiser
        self.passes: list[int] = []
        """How many lanes each pass so far has answered."""
        self._here = set(range(lanes))
        self._questions: dict[int, _Question | _Correction] = {}
        self._answers: dict[int, Tensor | Exception] = {}
        self._change = threading.Condition()

    def predict(self, lane: int, question: _Question) -> Tensor:
        """The lane's prediction, when all who are still here have asked; raises what the pass raised."""
        return self._ask(lane, question)

    def correct(self, lane: int, damping: Damping, x0: Tensor, timestep: int) -> Tensor:
        """The lane's prediction corrected, when all who are still here ask for something.

        Who has no correction to make asks for the next prediction already, and waits for the others there.
        """
        if not damping.due(timestep):
            return x0
        return self._ask(lane, _Correction(damping, x0, timestep))

    def _ask(self, lane: int, question: _Question | _Correction) -> Tensor:
        with self._change:
            self._questions[lane] = question
            self._answer_if_all_asked()
            while lane not in self._answers:
                self._change.wait()
            answer = self._answers.pop(lane)
        if isinstance(answer, Exception):
            raise answer
        return answer

    def leave(self, lane: int) -> None:
        """The lane asks no more."""
        with self._change:
            self._here.discard(lane)
            self._answer_if_all_asked()

    def _answer_if_all_asked(self) -> None:
        if not self._questions or self._questions.keys() != self._here:
            return
        corrections = {lane: q for lane, q in self._questions.items() if isinstance(q, _Correction)}
        predictions = {lane: q for lane, q in self._questions.items() if isinstance(q, _Question)}
        due = list(corrections or predictions)
        for lane in due:
            del self._questions[lane]
        try:
            if corrections:
                answers = correct_all(list(corrections.values()))
            else:
                self.passes.append(len(predictions))
                with torch.no_grad():  # the thread that answers may be one that just left, with gradients on
                    answers = answer_together(self.denoiser, list(predictions.values()))
            self._answers.update(zip(due, answers, strict=True))
        except Exception as error:
            self._answers.update(dict.fromkeys(due, error))
        self._change.notify_all()


def correct_all(corrections: Sequence[_Correction]) -> list[Tensor]:
    """All corrections, those at one timestep together."""
    answers: dict[int, Tensor] = {}
    for timestep in {c.timestep for c in corrections}:
        at = [i for i, c in enumerate(corrections) if c.timestep == timestep]
        made = correct_together([(corrections[i].damping, corrections[i].x0) for i in at], timestep)
        answers.update(zip(at, made, strict=True))
    return [answers[i] for i in range(len(corrections))]


def answer_together(denoiser: InterGenDenoiser, questions: Sequence[_Question]) -> list[Tensor]:
    """The guided predictions for all questions, both halves of the guidance of all of them in one pass."""
    if len(questions) == 1:
        q = questions[0]
        return [denoiser.guided(q.x, q.t, q.cond, q.mask, scale=q.scale)]
    length = max(q.x.shape[1] for q in questions)
    padded = any(q.x.shape[1] < length or q.mask is not None for q in questions)
    guided = [q for q in questions if q.scale != 1]
    rows = [(q, q.cond) for q in questions] + [(q, torch.zeros_like(q.cond)) for q in guided]
    out = denoiser(
        torch.cat([pad(q.x, (0, 0, 0, length - q.x.shape[1])) for q, _ in rows]),
        torch.cat([q.t for q, _ in rows]),
        torch.cat([cond for _, cond in rows]),
        torch.cat([_mask(q, length) for q, _ in rows]) if padded else None,
    )
    parts = iter(out.split([len(q.x) for q, _ in rows]))
    conditional = [next(parts)[:, : q.x.shape[1]] for q in questions]
    unconditional = {id(q): next(parts)[:, : q.x.shape[1]] for q in guided}
    return [
        c if q.scale == 1 else q.scale * c + (1 - q.scale) * unconditional[id(q)]
        for q, c in zip(questions, conditional, strict=True)
    ]


def _mask(question: _Question, length: int) -> Tensor:
    """(B, length, 2), true at tokens that are real."""
    samples, own, _ = question.x.shape
    mask = torch.ones(samples, own, 2, dtype=torch.bool) if question.mask is None else question.mask != 0
    return pad(mask, (0, 0, 0, length - own))
