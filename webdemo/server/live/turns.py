"""The thread that computes for all live streams, a step of each in turn."""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable, Generator, Hashable
from concurrent.futures import Future
from dataclasses import dataclass, field
from typing import Any

from motion import InputError

Steps = Generator[None, None, dict[str, Any]]
"""A job in steps; it returns its answer."""
REPLACED = "A newer message of this live stream took this one's place: send one after the other."
STOPPING = "The server is stopping: press Start again in a minute."


class Replaced(InputError):
    """A newer job of the same owner took the place of a waiting one."""


@dataclass(eq=False)
class _Job:
    begin: Callable[[], Steps]
    answer: Future[dict[str, Any]] = field(default_factory=Future)
    steps: Steps | None = None


class StepTurns:
    """Does jobs in one thread, a step of each owner in turn (round robin).

    Each owner has at most one job in work and one that waits; a newer one replaces that. So nobody's jobs pile up, and
    an owner with long jobs delays a step of another by no more than one step of each owner. Several threads would be no
    faster, since they would wait for Python's interpreter lock.

    Args:
        name: of the thread.
        clock: gives the time; seconds.
    """

    def __init__(self, name: str, clock: Callable[[], float] = time.monotonic) -> None:
        self.name, self.clock = name, clock
        self._change = threading.Condition()
        self._turns: deque[Hashable] = deque()
        self._working: dict[Hashable, _Job] = {}
        self._waiting: dict[Hashable, _Job] = {}
        self._thread: threading.Thread | None = None
        self._current: Hashable | None = None
        self._began: float | None = None
        self._stopped = False

    @property
    def stuck(self) -> float:
        """Seconds for which the present step has taken; 0 between two steps."""
        began = self._began
        return 0.0 if began is None else self.clock() - began

    def submit(self, owner: Hashable, begin: Callable[[], Steps]) -> Future[dict[str, Any]]:
        """Takes a job; ``begin`` is called at its first turn.

        Returns:
            its answer, its error, or :class:`Replaced`.

        Raises:
            InputError: after :meth:`stop`.
        """
        job = _Job(begin)
        with self._change:
            if self._stopped:
                raise InputError(STOPPING)
            if self._thread is None:
                self._thread = threading.Thread(target=self._work, name=self.name, daemon=True)
                self._thread.start()
            earlier = self._waiting.get(owner)
            self._waiting[owner] = job
            if owner not in self._turns and owner != self._current:
                self._turns.append(owner)
            self._change.notify()
        if earlier is not None and earlier.answer.set_running_or_notify_cancel():
            earlier.answer.set_exception(Replaced(REPLACED))
        return job.answer

    def stop(self) -> None:
        """Ends the thread when all jobs are done."""
        with self._change:
            self._stopped = True
            self._change.notify()

    def _work(self) -> None:
        while True:
            with self._change:
                while not self._turns:
                    if self._stopped:
                        return
                    self._change.wait()
                owner = self._current = self._turns.popleft()
                job = self._working.pop(owner, None) or self._waiting.pop(owner)
            self._began = self.clock()
            going_on = self._step(job)
            self._began = None
            with self._change:
                if going_on:
                    self._working[owner] = job
                if going_on or owner in self._waiting:
                    self._turns.append(owner)
                self._current = None

    @staticmethod
    def _step(job: _Job) -> bool:
        """One step of a job; returns whether there are more."""
        try:
            if job.steps is None:
                if not job.answer.set_running_or_notify_cancel():
                    return False
                job.steps = job.begin()
            next(job.steps)
            return True
        except StopIteration as end:
            job.answer.set_result(end.value)
        except BaseException as error:
            job.answer.set_exception(error)
        return False
