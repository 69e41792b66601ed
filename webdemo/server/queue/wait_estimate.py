"""Estimates how long a run will wait: simulates the queue at the pace of earlier runs."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any


def units(request: Any) -> float:
    """The work of a request: samples × denoising steps × seconds of motion, plus a constant overhead.

    Of further tries half are counted: the first that does all is the last. A factor that a kind of request lacks counts
    as 1 (5 s for the length).
    """
    seconds = getattr(request, "seconds", None)
    if seconds is None:
        actor = getattr(request, "actor", None)
        seconds = actor.seconds if actor is not None else 5.0
    tries = (1 + float(getattr(request, "tries", 1))) / 2
    return tries * float(getattr(request, "samples", 1)) * (float(seconds) * float(getattr(request, "steps", 1)) + 10.0)


@dataclass
class GroupPace:
    """Seconds per unit of work, learned from finished runs; None before the first."""

    seconds_a_unit: float | None = None

    def learn(self, work: float, seconds: float) -> None:
        """Updates the pace with a batch of ``work`` units; recent batches weigh more."""
        new = seconds / max(work, 1e-9)
        old = self.seconds_a_unit
        self.seconds_a_unit = new if old is None else 0.7 * old + 0.3 * new


class Pace:
    """The pace of each model group."""

    def __init__(self) -> None:
        self._groups: dict[str, GroupPace] = {}

    def of(self, group: str) -> GroupPace:
        """The pace of a group of requests."""
        return self._groups.setdefault(group, GroupPace())


@dataclass
class Line:
    """A snapshot of one group's queue.

    Attributes:
        waiting: jobs in order of arrival.
        running: jobs that are running.
        served: each person's account.
        pick: chooses the next batch from (waiting, accounts, running).
        pace: a worker's pace.
        workers: number of batches that run at a time.
    """

    waiting: Sequence[Any]
    running: Sequence[Any]
    served: dict[str, float]
    pick: Callable[[list[Any], dict[str, float], Sequence[Any]], list[Any]]
    pace: GroupPace
    workers: int = 1

    def place(self, job: Any) -> tuple[int, float | None]:
        """(place in the queue from 1, seconds until it starts, None while the pace is unknown)."""
        waiting, served = list(self.waiting), dict(self.served)
        ahead, work = 0, 0.0
        while waiting:
            batch = self.pick(waiting, served, ())
            if job in batch:
                place = ahead + batch.index(job) + 1
                return place, self._seconds(work)
            for other in batch:
                waiting.remove(other)
                served[other.person] = served.get(other.person, 0.0) + other.cost
            ahead += len(batch)
            work += sum(other.cost for other in batch)
        return ahead + 1, self._seconds(work)

    def _seconds(self, work: float) -> float | None:
        if self.pace.seconds_a_unit is None:
            return None
        now = time.monotonic()
        batches: dict[float, float] = {}
        for job in self.running:  # the jobs of a batch started together
            batches[job.started] = batches.get(job.started, 0.0) + job.cost * self.pace.seconds_a_unit
        # A batch that is late is taken to need a tenth of its time yet.
        left = [max(whole - (now - started), 0.1 * whole) for started, whole in batches.items()]
        busy = sum(left) if len(left) >= self.workers else 0.0
        return (busy + work * self.pace.seconds_a_unit) / self.workers
