"""How long a run will wait: the line is played through ahead, at the pace of the runs before it."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any


def units(request: Any) -> float:
    """The work of a request: samples × denoising steps × seconds of motion, and a little for the rest.

    What a kind of request does not have counts once.
    """
    seconds = getattr(request, "seconds", None)
    if seconds is None:
        actor = getattr(request, "actor", None)
        seconds = actor.seconds if actor is not None else 5.0
    return float(getattr(request, "samples", 1)) * (
        float(seconds) * float(getattr(request, "steps", 1)) + 10.0
    )


@dataclass
class GroupPace:
    """Seconds a unit of work, learned from what was run; None until something was."""

    seconds_a_unit: float | None = None

    def learn(self, work: float, seconds: float) -> None:
        """A batch of ``work`` units took so long; later ones count for more."""
        new = seconds / max(work, 1e-9)
        old = self.seconds_a_unit
        self.seconds_a_unit = new if old is None else 0.7 * old + 0.3 * new


class Pace:
    """The pace of each model group."""

    def __init__(self) -> None:
        self._groups: dict[str, GroupPace] = {}

    def of(self, group: str) -> GroupPace:
        return self._groups.setdefault(group, GroupPace())


@dataclass
class Line:
    """One group's line at one moment.

    Attributes:
        waiting: in the order in which they came.
        running: what the worker does now.
        served: each person's account.
        pick: chooses the next batch from (waiting, accounts, running).
        pace: how fast a worker is.
        workers: how many batches are run at a time.
    """

    waiting: Sequence[Any]
    running: Sequence[Any]
    served: dict[str, float]
    pick: Callable[[list[Any], dict[str, float], Sequence[Any]], list[Any]]
    pace: GroupPace
    workers: int = 1

    def place(self, job: Any) -> tuple[int, float | None]:
        """(place in the line from 1, seconds until it starts; None while the pace is not known)."""
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
        for job in self.running:  # those of a batch have started together
            batches[job.started] = batches.get(job.started, 0.0) + job.cost * self.pace.seconds_a_unit
        # A batch that is late is taken to need a tenth of its time yet.
        left = [max(whole - (now - started), 0.1 * whole) for started, whole in batches.items()]
        busy = sum(left) if len(left) >= self.workers else 0.0
        return (busy + work * self.pace.seconds_a_unit) / self.workers
