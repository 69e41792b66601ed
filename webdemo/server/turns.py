"""Whose turn it is: everybody's account of the work done for them, and the batch that goes next.

The next run is that of the waiting person who has had least (start-time fair queueing). Nobody gains by
asking more often, and a long run costs its owner later turns.
"""

from __future__ import annotations

import queue
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol

from webdemo.inference.cancel import CancelToken
from webdemo.inference.requests import Progress, Result

MAX_ACCOUNTS = 1000
"""Accounts of people who are no longer here are dropped above this."""


class Batcher(Protocol):
    """Runs several requests in one pass."""

    def key(self, request: Any) -> tuple[Any, ...] | None:
        """Requests of equal keys may share a pass; None for one that must run alone."""

    def fits(self, requests: Sequence[Any], other: Any) -> bool:
        """Whether another request of the same key may join these."""

    def run_together(
        self, items: Sequence[tuple[Any, CancelToken]]
    ) -> Iterator[tuple[int, Progress | Result | Exception]]:
        """(which request, what happened to it); each ends in a Result or an Exception."""


@dataclass(frozen=True, kw_only=True)
class QueueLimits:
    """How much may run and wait: of one person, from one address, of all; how many motions in one pass, and
    how many batches of a model at a time."""

    running: int = 2
    waiting: int = 4
    address: int = 32
    queue: int = 64
    batch: int = 8
    workers: int = 1


@dataclass(eq=False)
class Job:
    """One run in the line.

    Attributes:
        person: who waits for it.
        group: which worker does it.
        cost: its work, in units.
        key: jobs of equal keys may share a pass; None for one that runs alone.
        events: progress, then a result or an error; read by whoever asked.
        told: seconds that were foretold when it came.
        batch: how many shared its pass.
    """

    person: str
    request: Any
    group: str
    cost: float
    key: tuple[Any, ...] | None
    address: str = ""
    token: CancelToken = field(default_factory=CancelToken)
    events: queue.SimpleQueue[Any] = field(default_factory=queue.SimpleQueue)
    came: float = field(default_factory=time.monotonic)
    started: float = 0.0
    told: float | None = None
    batch: int = 1


class Turns:
    """Accounts, and the choice of a batch by them; whoever uses it holds a lock.

    Args:
        limits: caps.
        batcher: says what may share a pass; without it nothing does.
    """

    def __init__(self, limits: QueueLimits, batcher: Batcher | None) -> None:
        self.limits, self.batcher = limits, batcher
        self.served: dict[str, float] = {}
        """Units of work that each person has had."""
        self._elsewhere: Mapping[str, float] | None = None

    def meet(self, person: str, waiting: Iterable[Job], running: Iterable[Job]) -> None:
        """Opens an account: whoever comes anew has had as much as the least served who are here.

        What runs now does not count for that, or its owner's next run would be level with the newcomer's.
        """
        running = list(running)
        here = {job.person for job in waiting} | {job.person for job in running}
        before = {name: self.served[name] for name in here}
        for job in running:
            before[job.person] -= job.cost
        least = min(before.values(), default=0.0)
        if person not in here:
            self.served[person] = max(self.served.get(person, 0.0), least)
        if not here:  # an idle server forgets
            self.served = {person: 0.0}
        elif len(self.served) > MAX_ACCOUNTS:
            self.served = {name: self.served[name] for name in {*here, person}}

    def charge(self, job: Job) -> None:
        """A job begins."""
        self.served[job.person] = self.served.get(job.person, 0.0) + job.cost

    def charge_elsewhere(self, totals: Mapping[str, float]) -> None:
        """Counts the work that people have had at other processes since this was last told.

        Args:
            totals: units by person, of all other processes since these began.
        """
        before, self._elsewhere = self._elsewhere, dict(totals)
        if before is None:  # what was before this process does not count
            return
        for person, total in totals.items():
            if person in self.served:
                self.served[person] += max(total - before.get(person, 0.0), 0.0)

    def pick(self, waiting: Sequence[Job], served: Mapping[str, float], running: Sequence[Job]) -> list[Job]:
        """The next batch: the least served person's first run, and whatever may share its pass."""
        count: dict[str, int] = {}
        for job in running:
            count[job.person] = count.get(job.person, 0) + 1
        batch: list[Job] = []
        rest = list(waiting)
        extra: dict[str, float] = {}
        while rest:
            able = [
                job
                for job in rest
                if count.get(job.person, 0) < self.limits.running and self._joins(batch, job)
            ]
            if not able:
                break
            job = min(
                able, key=lambda j: (served.get(j.person, 0.0) + extra.get(j.person, 0.0), waiting.index(j))
            )
            batch.append(job)
            rest.remove(job)
            count[job.person] = count.get(job.person, 0) + 1
            extra[job.person] = extra.get(job.person, 0.0) + job.cost
            if job.key is None:
                break
        return batch

    def _joins(self, batch: Sequence[Job], job: Job) -> bool:
        if not batch:
            return True
        if self.batcher is None or job.key is None or job.key != batch[0].key:
            return False
        motions = sum(other.request.samples for other in batch) + job.request.samples
        return motions <= self.limits.batch and self.batcher.fits([o.request for o in batch], job.request)
