"""What goes through a run: its progress events and its result, its timer, and the token that ends it early."""

from __future__ import annotations

import threading
import time
from collections.abc import Generator, Iterable
from dataclasses import dataclass, field
from time import monotonic
from typing import Any

from motion import Clip, Duet, InputError

LATE = "The run took longer than the {limit} that this lab allows: ask for fewer steps, samples or seconds."


@dataclass(frozen=True, kw_only=True)
class Progress:
    """An event during a run.

    Attributes:
        stage: "load", "text", "sample", "finish".
        step: finished steps of the stage.
        total: all steps of the stage.
        elapsed: seconds since the request began.
        unit: what is counted: "step" for denoising steps, "frame", "pass".
        attempt: the number of the try, from 1, of ``attempts``.
    """

    stage: str
    step: int = 0
    total: int = 1
    elapsed: float = 0.0
    unit: str = "step"
    attempt: int = 1
    attempts: int = 1


@dataclass(frozen=True, kw_only=True)
class Result:
    """The result of a request.

    Attributes:
        duets: one a sample; a prediction for one person is that person's clip.
        manifest: request, plan, model, weights hash, versions: all that reproduces the result.
        readouts: one dictionary of interaction measures a sample (see :mod:`motion.metrics`), each
            measure with its value ``before`` and ``after`` the damping and clean-up where both exist; of a
            sentence also the share of the motion that was laid out for the network, ``planned`` (0 to 1).
        timings: seconds by stage; by default those that the engine measures.
        notes: sentences the user should read, such as a prompt far from all training captions.
        run: its id in the history; "" where none keeps it.
    """

    duets: tuple[Duet | Clip, ...]
    manifest: dict[str, Any] = field(default_factory=dict)
    readouts: tuple[dict[str, Any], ...] = ()
    timings: dict[str, float] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    run: str = ""


def until_result(events: Iterable[Progress | Result]) -> Generator[Progress, None, Result]:
    """Passes the progress of a run on and returns its result."""
    for event in events:
        if isinstance(event, Result):
            return event
        yield event
    raise AssertionError("A pipeline ends with its result.")


class Cancelled(Exception):
    """The run was cancelled by its owner; nothing was written."""


class CancelToken:
    """Set by the owner of a run and checked by the sampling loop before every step.

    Stopping the consumer of a generator does not stop the running step, so the loop itself has to check.
    Safe to use from several threads.

    Args:
        seconds: how long the run may take from :meth:`start` on; 0 for any time.
        late: what a run that takes longer is told; ``{limit}`` stands for the time in words.
    """

    def __init__(self, seconds: float = 0.0, late: str = LATE) -> None:
        self._event = threading.Event()
        self._seconds, self._late = seconds, late
        self._until: float | None = None

    def start(self) -> CancelToken:
        """Lets the time of the run begin, which does not count what it waits before; gives the token itself."""
        if self._seconds:
            self._until = monotonic() + self._seconds
        return self

    def cancel(self) -> None:
        """Asks the run to stop; it stops within one step. May be called more than once."""
        self._event.set()

    @property
    def cancelled(self) -> bool:
        """True if the owner asked the run to stop."""
        return self._event.is_set()

    def raise_if_cancelled(self) -> None:
        """Ends a run that shall stop.

        Raises:
            Cancelled: if it was asked to stop.
            InputError: one sentence, if its time is over.
        """
        if self.cancelled:
            raise Cancelled("The run was cancelled.")
        if self._until is not None and monotonic() > self._until:
            raise InputError(self._late.format(limit=_in_words(self._seconds)))


def _in_words(seconds: float) -> str:
    minutes = seconds / 60
    return f"{minutes:g} minutes" if minutes > 1 and minutes.is_integer() else f"{seconds:g} seconds"


class StageTimer:
    """Seconds since a run began, and by stage.

    Attributes:
        stages: stage → seconds.
    """

    def __init__(self) -> None:
        self._began = self._lapped = time.perf_counter()
        self.stages: dict[str, float] = {}

    @property
    def elapsed(self) -> float:
        """Seconds since the run began."""
        return time.perf_counter() - self._began

    def progress(self, stage: str, step: int = 0, total: int = 1, unit: str = "step") -> Progress:
        """A progress event with the time so far."""
        return Progress(stage=stage, step=step, total=total, elapsed=self.elapsed, unit=unit)

    @property
    def timings(self) -> dict[str, float]:
        """The stages, and the seconds of the whole run so far as "total"."""
        return {**self.stages, "total": round(self.elapsed, 4)}

    def lap(self, stage: str) -> None:
        """Adds the time since the last lap, at first since the start, to a stage."""
        now = time.perf_counter()
        self.stages[stage] = round(self.stages.get(stage, 0.0) + now - self._lapped, 4)
        self._lapped = now

    def sampled(self, steps: Iterable[Any], cancel: CancelToken) -> Generator[Progress, None, Any]:
        """The progress of denoising, a step at a time until it is cancelled; returns the last step's sample.

        Args:
            steps: one or more, as :func:`models.diffusion.sample_steps` gives them.
            cancel: looked at before every step.
        """
        cancel.raise_if_cancelled()
        for step in steps:
            yield self.progress("sample", step.step, step.total)
            cancel.raise_if_cancelled()
        self.lap("sample")
        return step.sample
