"""Fair scheduling: an account of the work done for each person, whose run is next, and how long one waits.

The next run is that of the waiting person who has been served least (start-time fair queueing). Sending more
requests brings no advantage, and a long run delays its owner's later ones. A wait is estimated at the pace of earlier
runs.
"""

from __future__ import annotations

import math
import queue
import time
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from webdemo.inference.run import CancelToken

MAX_ACCOUNTS = 1000
"""Above this number, accounts of people without runs are dropped."""


@dataclass(eq=False)
class Job:
    """One run in the queue.

    Attributes:
        person: its owner.
        cost: its work, in units.
        events: progress, then a result or an error; read by the caller.
        moved: when it last began or made progress.
    """

    person: str
    request: Any
    cost: float
    address: str = ""
    token: CancelToken = field(default_factory=CancelToken)
    events: queue.SimpleQueue[Any] = field(default_factory=queue.SimpleQueue)
    came: float = field(default_factory=time.monotonic)
    started: float = 0.0
    moved: float = 0.0

    @property
    def model(self) -> str:
        """The method that it is to be done by."""
        return str(getattr(self.request, "model", "default"))


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


def next_job(
    waiting: Sequence[Job], served: Mapping[str, float], running: Iterable[Job] = (), most: float = math.inf
) -> Job | None:
    """The first run of the person who has been served least; None if nothing waits that may begin.

    Args:
        waiting: runs in order of arrival.
        served: units of work by person.
        running: runs.
        most: running runs of a person.
    """
    busy = Counter(job.person for job in running)
    able = (job for job in waiting if busy[job.person] < most)
    return min(able, key=lambda job: served.get(job.person, 0.0), default=None)


def in_turn(waiting: Sequence[Job], served: Mapping[str, float]) -> Iterator[Job]:
    """Waiting runs in the order in which they will run, if nobody else comes."""
    left, accounts = list(waiting), dict(served)
    while job := next_job(left, accounts):
        left.remove(job)
        accounts[job.person] = accounts.get(job.person, 0.0) + job.cost
        yield job


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
    """Seconds per unit of work of a model, learned from finished runs; None before the first."""

    seconds_a_unit: float | None = None

    def learn(self, work: float, seconds: float) -> None:
        """Updates the pace with a run of ``work`` units; recent runs weigh more."""
        new = seconds / max(work, 1e-9)
        old = self.seconds_a_unit
        self.seconds_a_unit = new if old is None else 0.7 * old + 0.3 * new

    def wait(self, ahead: float, running: Collection[Job], workers: int) -> float | None:
        """Seconds until a run starts; None while the pace is unknown.

        Args:
            ahead: units of the runs before it.
            running: runs of its model.
            workers: number of runs of the model at a time.
        """
        if self.seconds_a_unit is None:
            return None
        now, left = time.monotonic(), 0.0
        if len(running) >= workers:
            for job in running:
                whole = job.cost * self.seconds_a_unit
                left += max(whole - (now - job.started), 0.1 * whole)  # one that is late is taken to need a tenth yet
        return (left + ahead * self.seconds_a_unit) / workers
