"""Fair scheduling: an account of the work done for each person, the choice of the next batch, and how long a run waits.

The next run is that of the waiting person who has been served least (start-time fair queueing). Sending more
requests brings no advantage, and a long run delays its owner's later ones. A wait is estimated by a simulation of the
queue at the pace of earlier runs.
"""

from __future__ import annotations

import queue
import secrets
import time
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol

from webdemo.inference.run import CancelToken, Progress, Result

MAX_ACCOUNTS = 1000
"""Above this number, accounts of people without runs are dropped."""


class Batcher(Protocol):
    """Runs several requests in one pass."""

    def key(self, request: Any) -> tuple[Any, ...] | None:
        """Requests of equal keys may share a pass; None for one that must run alone."""

    def fits(self, requests: Sequence[Any], other: Any) -> bool:
        """True if another request of the same key may join these."""

    def run_together(
        self, items: Sequence[tuple[Any, CancelToken]]
    ) -> Iterator[tuple[int, Progress | Result | Exception]]:
        """(index of a request, its event); each request ends in a Result or an Exception."""


@dataclass(frozen=True, kw_only=True)
class QueueLimits:
    """Limits of a person's running runs, of motions per pass, of concurrent batches per model, and of the seconds of
    one run (0: none)."""

    running: int = 2
    batch: int = 8
    workers: int = 1
    seconds: float = 0.0


@dataclass(eq=False)
class Job:
    """One run in the queue.

    Attributes:
        person: its owner.
        group: the model group whose worker runs it.
        cost: its work, in units.
        key: jobs of equal keys may share a pass; None for one that runs alone.
        events: progress, then a result or an error; read by the caller.
        moved: when its pass last began or made progress.
        estimate: estimated wait in seconds when it arrived.
        batch: number of runs that shared its pass.
        ended: the sentence with which an administrator has ended it.
        id: names it for administrators.
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
    moved: float = 0.0
    estimate: float | None = None
    batch: int = 1
    ended: str = ""
    id: str = field(default_factory=lambda: secrets.token_hex(6))


class Accounts:
    """The work done for each person.

    Attributes:
        served: units of work by person.
    """

    def __init__(self) -> None:
        self.served: dict[str, float] = {}

    def meet(self, person: str, here: Collection[str], running: Iterable[tuple[str, float]] = ()) -> None:
        """Opens an account; a newcomer starts at the level of the least served person present.

        Args:
            person: who asks for something.
            here: people with anything unfinished.
            running: (person, units) already charged for running work. It does not count towards that level, or its
                owner would be tied with the newcomer.
        """
        before = {name: self.served.get(name, 0.0) for name in here}
        for name, cost in running:
            before[name] -= cost
        least = min(before.values(), default=0.0)
        if person not in here:
            self.served[person] = max(self.served.get(person, 0.0), least)
        if not here:  # an idle server resets the accounts
            self.served = {person: 0.0}
        elif len(self.served) > MAX_ACCOUNTS:
            self.served = {name: self.served.get(name, 0.0) for name in {*here, person}}

    def charge(self, person: str, units: float) -> None:
        """Adds work done for a person."""
        self.served[person] = self.served.get(person, 0.0) + units


class Turns(Accounts):
    """Keeps the accounts and chooses batches by them; the caller must hold a lock.

    Args:
        limits: upper limits.
        batcher: decides which runs may share a pass; without it none do.
    """

    def __init__(self, limits: QueueLimits, batcher: Batcher | None) -> None:
        super().__init__()
        self.limits, self.batcher = limits, batcher

    def pick(self, waiting: Sequence[Job], served: Mapping[str, float], running: Sequence[Job]) -> list[Job]:
        """The next batch: the first run of the least served person, and the runs that may share its pass."""
        count: dict[str, int] = {}
        for job in running:
            count[job.person] = count.get(job.person, 0) + 1
        batch: list[Job] = []
        rest = list(waiting)
        extra: dict[str, float] = {}
        while rest:
            able = [job for job in rest if count.get(job.person, 0) < self.limits.running and self._joins(batch, job)]
            if not able:
                break
            job = min(able, key=lambda j: (served.get(j.person, 0.0) + extra.get(j.person, 0.0), waiting.index(j)))
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


# ---- how long it will take ---------------------------------------------------------------------------


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
class Pace:
    """Seconds per unit of work of a model group, learned from finished runs; None before the first."""

    seconds_a_unit: float | None = None

    def learn(self, work: float, seconds: float) -> None:
        """Updates the pace with a batch of ``work`` units; recent batches weigh more."""
        new = seconds / max(work, 1e-9)
        old = self.seconds_a_unit
        self.seconds_a_unit = new if old is None else 0.7 * old + 0.3 * new


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
    pace: Pace
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
