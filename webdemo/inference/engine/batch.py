"""Runs several requests together, so that they share each pass through the network.

Each request runs through the engine in a thread of its own. Whenever it needs a prediction of the denoiser or a
correction by the damping, it waits for the other requests, and one pass computes the results of all. A request's
result differs from that of a run alone only by rounding: its noise depends on its seed, shorter motions are padded
and the padding is masked in attention, and the damping's energy is a sum over motions.
"""

from __future__ import annotations

import queue
import threading
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import torch
from torch import Tensor
from torch.nn.functional import pad

from models.diffusion import Term, terms, weighted
from models.intergen import InterGenDenoiser
from models.intergen.words import join_conditions
from webdemo.inference.finish.damping import Damping, correct_together
from webdemo.inference.requests import GenerateRequest, ReactRequest
from webdemo.inference.run import CancelToken, Progress, Result
from webdemo.inference.story.request import SceneRequest

from . import Engine

Event = Progress | Result | Exception


def run_batch(
    engine: Engine, items: Sequence[tuple[GenerateRequest | ReactRequest | SceneRequest, CancelToken]]
) -> Iterator[tuple[int, Event]]:
    """Runs requests of one model, sampler and number of steps together.

    Args:
        engine: has the model.
        items: requests with their cancel tokens; cancelling one does not affect the others.

    Yields:
        (index of a request, event): its progress, then its result or the error that ended it.
    """
    pipeline: Any = engine.pipeline(items[0][0].model)
    meeting = Meeting(pipeline.model.denoiser, len(items))
    events: queue.SimpleQueue[tuple[int, Event | None]] = queue.SimpleQueue()

    def work(i: int, request: GenerateRequest | ReactRequest | SceneRequest, token: CancelToken) -> None:
        try:
            for event in engine.run(request, cancel=token, passes=SharedPasses(meeting, i)):
                events.put((i, event))
        except Exception as error:  # InputError and Cancelled, too: they concern this request only
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


class SharedPasses:
    """The passes of one request among several; see :class:`.pipelines.two_person.Passes`.

    Args:
        meeting: where the requests wait for each other.
        lane: the request's number.
    """

    def __init__(self, meeting: Meeting, lane: int) -> None:
        self._meeting, self._lane = meeting, lane

    def guided(
        self,
        x: Tensor,
        t: Tensor,
        cond: Tensor,
        mask: Tensor | None = None,
        known: Tensor | None = None,
        *,
        scale: float,
    ) -> Tensor:
        """As the denoiser's own ``guided``, together with the other lanes."""
        return self._meeting.predict(self._lane, _Question(x, t, cond, mask, scale, known))

    def correct(self, damping: Damping, x0: Tensor, timestep: int) -> Tensor:
        """A prediction corrected by its damping, together with the other lanes."""
        return self._meeting.correct(self._lane, damping, x0, timestep)


@dataclass(frozen=True)
class _Question:
    """A request of one lane to the denoiser; shapes as in :meth:`InterGenDenoiser.guided`."""

    x: Tensor
    t: Tensor
    cond: Tensor
    mask: Tensor | None
    scale: float
    known: Tensor | None = None

    @property
    def terms(self) -> list[Term]:
        """The predictions whose sum is the answer."""
        return terms(self.scale)

    def told(self, term: Term) -> _Question:
        """The question of one of its terms."""
        return self if term.words else replace(self, cond=torch.zeros_like(self.cond))


@dataclass(frozen=True)
class _Correction:
    """A request of one lane to the damping."""

    damping: Damping
    x0: Tensor
    timestep: int


class Meeting:
    """A meeting point of lanes; the last one to arrive computes the results of all in one pass.

    Args:
        denoiser: computes the predictions.
        lanes: number of participants; each must call :meth:`leave` at its end.
    """

    def __init__(self, denoiser: InterGenDenoiser, lanes: int) -> None:
        self.denoiser = denoiser
        self.passes: list[int] = []
        """Number of lanes of each pass so far."""
        self._here = set(range(lanes))
        self._questions: dict[int, _Question | _Correction] = {}
        self._answers: dict[int, Tensor | Exception] = {}
        self._change = threading.Condition()

    def predict(self, lane: int, question: _Question) -> Tensor:
        """The lane's prediction, once all remaining lanes have asked; raises what the pass raised."""
        return self._ask(lane, question)

    def correct(self, lane: int, damping: Damping, x0: Tensor, timestep: int) -> Tensor:
        """The lane's corrected prediction, once all remaining lanes have asked for something.

        A lane without a correction asks for its next prediction and waits there.
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
        """Removes a lane, which will ask for nothing more."""
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
                with torch.no_grad():  # the computing thread may be one that just left, with gradients on
                    answers = answer_together(self.denoiser, list(predictions.values()))
            self._answers.update(zip(due, answers, strict=True))
        except Exception as error:
            self._answers.update(dict.fromkeys(due, error))
        self._change.notify_all()


def correct_all(corrections: Sequence[_Correction]) -> list[Tensor]:
    """Computes all corrections; those at one timestep share a pass."""
    answers: dict[int, Tensor] = {}
    for timestep in {c.timestep for c in corrections}:
        at = [i for i, c in enumerate(corrections) if c.timestep == timestep]
        made = correct_together([(corrections[i].damping, corrections[i].x0) for i in at], timestep)
        answers.update(zip(at, made, strict=True))
    return [answers[i] for i in range(len(corrections))]


def answer_together(denoiser: InterGenDenoiser, questions: Sequence[_Question]) -> list[Tensor]:
    """The guided predictions for all questions; one pass computes all terms of all guided sums."""
    if len(questions) == 1:
        q = questions[0]
        return [denoiser.guided(q.x, q.t, q.cond, q.mask, q.known, scale=q.scale)]
    length = max(q.x.shape[1] for q in questions)
    padded = any(q.x.shape[1] < length or q.mask is not None for q in questions)
    rows = [q.told(term) for q in questions for term in q.terms]
    known = _known(rows, length)
    out = denoiser(
        torch.cat([pad(q.x, (0, 0, 0, length - q.x.shape[1])) for q in rows]),
        torch.cat([q.t for q in rows]),
        join_conditions([q.cond for q in rows]),
        torch.cat([_mask(q, length) for q in rows]) if padded else None,
        **({} if known is None else {"known": known}),
    )
    parts = iter(out.split([len(q.x) for q in rows]))
    return [weighted(q.terms, [next(parts)[:, : q.x.shape[1]] for _ in q.terms]) for q in questions]


def _known(questions: Sequence[_Question], length: int) -> Tensor | None:
    """The known parts of all questions; None if none has one."""
    values = [q.known for q in questions]
    width = next((value.shape[-1] for value in values if value is not None), None)
    if width is None:
        return None
    rows = [
        (q.x.new_zeros(1, q.x.shape[1], width) if value is None else value).expand(len(q.x), -1, -1)
        for q, value in zip(questions, values, strict=True)
    ]
    return torch.cat([pad(row, (0, 0, 0, length - row.shape[1])) for row in rows])


def _mask(question: _Question, length: int) -> Tensor:
    """(B, length, 2), true at tokens that are real."""
    samples, own, _ = question.x.shape
    mask = torch.ones(samples, own, 2, dtype=torch.bool) if question.mask is None else question.mask != 0
    return pad(mask, (0, 0, 0, length - own))
