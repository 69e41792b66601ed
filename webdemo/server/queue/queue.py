"""The run queue: the person served least goes first, and compatible runs share a pass.

Runs of one model group go to one worker; :mod:`webdemo.server.queue.turns` decides the order.
"""

from __future__ import annotations

import queue
import threading
import time
from collections import defaultdict
from collections.abc import Callable, Iterator
from typing import Any

from motion import InputError
from webdemo.inference.run import Cancelled, CancelToken, Progress, Result
from webdemo.server.accounts.quotas import OverQuota, Quota
from webdemo.server.http.health import Figures
from webdemo.ui.runs import EngineLike, Waiting
from webdemo.ui.visitor import Visitor, visitor

from .turns import Batcher, Job, Line, Pace, QueueLimits, Turns, units

TICK = 0.5
"""Seconds between two updates of the place in the queue."""
MAX_GROUPS = 8
"""Model groups with workers of their own; further ones share them."""


class FairQueue:
    """Runs for all sessions; the same use as :class:`webdemo.ui.runs.Runs`.

    Args:
        engine: runs the requests.
        limits: of what runs.
        quota: of waiting runs.
        batcher: runs several requests at once; without it each runs alone.
        figures: metrics to update.
        broken: called with errors of the program, not those of the user.
    """

    def __init__(
        self,
        engine: EngineLike,
        limits: QueueLimits | None = None,
        quota: Quota | None = None,
        *,
        batcher: Batcher | None = None,
        figures: Figures | None = None,
        broken: Callable[[BaseException], None] = lambda error: None,
    ) -> None:
        self.engine = engine
        self.limits, self.quota = limits or QueueLimits(), quota or Quota("runs waiting", person=4)
        self.batcher = batcher
        self.figures = figures or Figures()
        self.broken = broken
        self.paces: defaultdict[str, Pace] = defaultdict(Pace)
        self._change = threading.Condition()
        self._waiting: list[Job] = []
        self._running: list[Job] = []
        self._turns = Turns(self.limits, batcher)
        self._sessions: dict[str, CancelToken] = {}
        self._workers: set[str] = set()
        self._stopping = False
        self._rested = time.monotonic()
        """When the last run ended."""

    # ---- for callers -----------------------------------------------------------------------------

    @property
    def waiting(self) -> int:
        """Number of waiting runs."""
        return len(self._waiting)

    @property
    def running(self) -> int:
        """Number of running runs."""
        return len(self._running)

    @property
    def stuck(self) -> float:
        """Seconds for which a running run has made no progress, or nothing has run although something waits."""
        now = time.monotonic()
        with self._change:
            still = [now - job.moved for job in self._running]
            if self._waiting and not self._running:
                still.append(now - max(self._rested, min(job.came for job in self._waiting)))
        return max(still, default=0.0)

    def cancel(self, session: str) -> bool:
        """Stops the session's run, waiting or running; False if it has none."""
        with self._change:
            token = self._sessions.get(session)
            if token is not None:
                token.cancel()
                self._change.notify_all()
        return token is not None

    def jobs(self) -> list[tuple[Job, bool]]:
        """All runs here, and whether each has begun."""
        with self._change:
            return [(job, True) for job in self._running] + [(job, False) for job in self._waiting]

    def end(self, key: str, sentence: str) -> bool:
        """Ends the run of an id; its person is told the sentence. False if there is none."""
        with self._change:
            for job in (*self._running, *self._waiting):
                if job.id == key:
                    job.ended = sentence
                    job.token.cancel()
                    self._change.notify_all()
                    return True
        return False

    def run(self, session: str, request: Any, *, alone: bool = False) -> Iterator[Progress | Result]:
        """Runs a request; yields its place in the queue, its progress and its result.

        An earlier run of the same session is cancelled. Closing the iterator cancels the run.

        Args:
            session: owner of the run.
            request: the request.
            alone: share its pass with no other run, so the same request gives the same bytes.

        Raises:
            InputError: if the queue or the person's share of it is full, the server is stopping, the run takes too
                long, or the engine cannot fulfil the request.
            Cancelled: if the run was cancelled.
        """
        job = self._enter(session, request, visitor(), alone=alone)
        try:
            yield from self._watch(job)
        finally:
            with self._change:
                job.token.cancel()
                if job in self._waiting:
                    self._waiting.remove(job)
                if self._sessions.get(session) is job.token:
                    del self._sessions[session]
                self._change.notify_all()

    def close(self, grace: float) -> int:
        """Accepts no more runs, refuses the waiting ones, and gives running ones ``grace`` seconds to finish.

        Returns:
            number of runs that had to be stopped.
        """
        until = time.monotonic() + grace
        with self._change:
            self._stopping = True
            for job in self._waiting:
                job.events.put(InputError("The server is stopping: send this again in a minute."))
            self._waiting.clear()
            self._change.notify_all()
            while self._running and time.monotonic() < until:
                self._change.wait(max(0.0, min(0.2, until - time.monotonic())))
            left = list(self._running)
            for job in left:
                job.token.cancel()
                job.events.put(InputError("The server stopped before this was finished: send it again in a minute."))
        return len(left)

    # ---- the queue -------------------------------------------------------------------------------

    def _enter(self, session: str, request: Any, who: Visitor, *, alone: bool = False) -> Job:
        key, person = self.batcher.key(request) if self.batcher and not alone else None, who.person
        job = Job(
            person,
            request,
            group="",
            cost=units(request),
            key=key,
            address=who.address,
            token=CancelToken(self.limits.seconds),
        )
        with self._change:
            if self._stopping:
                raise InputError("The server is stopping: send this again in a minute.")
            if (earlier := self._sessions.get(session)) is not None:
                earlier.cancel()
            self._waiting = [other for other in self._waiting if not other.token.cancelled]
            try:
                self.quota.check(person, who.address, ((other.person, other.address) for other in self._waiting))
            except OverQuota as over:
                self.figures.refused.labels(f"queue of {over.whose}").inc()
                raise
            job.group = self._group(request)
            running = [(job.person, job.cost) for job in self._running]
            self._turns.meet(person, {job.person for job in (*self._waiting, *self._running)}, running)
            self._sessions[session] = job.token
            self._waiting.append(job)
            job.estimate = self._line(job.group).place(job)[1]
            self._change.notify_all()
        return job

    def _group(self, request: Any) -> str:
        """The model group of a request; starts its workers if needed."""
        name = str(getattr(request, "model", "default"))
        if name not in self._workers and len(self._workers) >= MAX_GROUPS:
            name = min(self._workers)
        if name not in self._workers:
            self._workers.add(name)
            for _ in range(self.limits.workers):
                threading.Thread(target=self._work, args=(name,), name=f"worker {name}", daemon=True).start()
        return name

    def _watch(self, job: Job) -> Iterator[Progress | Result]:
        while True:
            try:
                event = job.events.get(timeout=TICK)
            except queue.Empty:
                event = None
            if job.ended:
                raise InputError(job.ended)
            if isinstance(event, Exception):
                raise event
            if not isinstance(event, Result) or job.token.cancelled:  # a result that is there is not too late
                job.token.raise_if_cancelled()
            if event is None:
                with self._change:
                    if job not in self._waiting:
                        continue
                    place, left = self._line(job.group).place(job)
                    count = len(self._waiting)
                elapsed = time.monotonic() - job.came
                yield Waiting(stage="queue", step=place, total=count, elapsed=elapsed, seconds_left=left)
                continue
            yield event
            if isinstance(event, Result):
                return

    def _line(self, group: str) -> Line:
        """A snapshot of the group's queue; the caller holds the lock."""
        return Line(
            waiting=[job for job in self._waiting if job.group == group],
            running=[job for job in self._running if job.group == group],
            served=self._turns.served,
            pick=self._turns.pick,
            pace=self.paces[group],
            workers=self.limits.workers,
        )

    # ---- the workers -----------------------------------------------------------------------------

    def _work(self, group: str) -> None:
        while True:
            with self._change:
                while not (batch := self._next(group)):
                    if self._stopping:
                        return
                    self._change.wait()
                began = time.monotonic()
                for job in batch:
                    self._waiting.remove(job)
                    self._turns.charge(job.person, job.cost)
                    job.batch = len(batch)
                    job.started = job.moved = began
                    job.token.start()
                    self._running.append(job)
            try:
                whole = self._run_batch(batch)
            finally:
                with self._change:
                    for job in batch:
                        self._running.remove(job)
                    self._rested = time.monotonic()
                    self._change.notify_all()
            if whole:
                self.paces[group].learn(sum(job.cost for job in batch), time.monotonic() - began)
            self._count(group, batch, began)

    def _next(self, group: str) -> list[Job]:
        self._waiting = [job for job in self._waiting if not job.token.cancelled]
        mine = [job for job in self._waiting if job.group == group]
        return self._turns.pick(mine, self._turns.served, self._running) if mine else []

    def _run_batch(self, batch: list[Job]) -> bool:
        """Runs a batch; returns whether all of it finished, so its duration can be used to learn the pace."""
        ended: set[int] = set()
        whole = True
        try:
            for i, event in self._events(batch):
                for job in batch:
                    job.moved = time.monotonic()
                batch[i].events.put(event)
                if isinstance(event, Result):
                    ended.add(i)
                elif isinstance(event, Exception):
                    ended.add(i)
                    whole = False
                    self._note(batch[i], event)
        except Exception as error:  # of the whole batch
            whole = False
            for i in set(range(len(batch))) - ended:
                batch[i].events.put(error)
                self._note(batch[i], error)
            return whole
        for i in set(range(len(batch))) - ended:  # an engine stops without a result only when cancelled
            whole = False
            batch[i].events.put(Cancelled("The run ended without a result."))
        return whole

    def _events(self, batch: list[Job]) -> Iterator[tuple[int, Progress | Result | Exception]]:
        if len(batch) > 1 and self.batcher is not None:
            yield from self.batcher.run_together([(job.request, job.token) for job in batch])
            return
        for event in self.engine.run(batch[0].request, cancel=batch[0].token):
            yield 0, event
            if isinstance(event, Result):
                return

    def _note(self, job: Job, error: Exception) -> None:
        kind = type(error).__name__
        ours = not isinstance(error, (InputError, Cancelled))
        outcome = "failed" if ours else "cancelled" if isinstance(error, Cancelled) else "refused"
        self.figures.runs.labels(job.group, outcome).inc()
        if ours:
            self.figures.errors.labels(kind).inc()
            self.broken(error)

    def _count(self, group: str, batch: list[Job], began: float) -> None:
        self.figures.batch_size.labels(group).observe(len(batch))
        for job in batch:
            waited = began - job.came
            self.figures.stage_seconds.labels(group, "queue").observe(waited)
            if job.estimate and job.estimate > 1:
                self.figures.estimate_ratio.observe(waited / job.estimate)
