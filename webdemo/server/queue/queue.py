"""The run queue: the person served least goes first.

Runs of one model go to one worker; :mod:`webdemo.server.queue.turns` decides the order. Where a run takes long, a
spare worker does much shorter ones of other people beside it.
"""

from __future__ import annotations

import queue
import threading
import time
from collections import defaultdict
from collections.abc import Callable, Iterator
from itertools import takewhile
from typing import Any

from motion import InputError
from webdemo.inference.run import Cancelled, CancelToken, Progress, Result
from webdemo.server.accounts.quotas import OverQuota, Quota
from webdemo.server.http.health import Figures
from webdemo.ui.runs import EngineLike, Waiting
from webdemo.ui.visitor import Visitor, visitor

from .turns import Accounts, Job, Pace, in_turn, next_job, units

TICK = 0.5
"""Seconds between two updates of the place in the queue."""
PATIENCE = 5.0
"""Seconds after which a run takes long."""
SHORTER = 8.0
"""Times as much work as a run that is much shorter has a long one; the largest takes minutes, a usual one seconds."""


class FairQueue:
    """Runs for all sessions.

    Args:
        engine: runs the requests.
        quota: of waiting runs.
        running: most running runs of a person.
        workers: runs of a model at a time.
        seconds: that one run may take; 0 for any.
        figures: metrics to update.
        broken: called with errors of the program, not those of the user.
    """

    def __init__(
        self,
        engine: EngineLike,
        quota: Quota,
        *,
        running: int,
        workers: int,
        seconds: float,
        figures: Figures,
        broken: Callable[[BaseException], None],
    ) -> None:
        self.engine, self.quota, self.figures, self.broken = engine, quota, figures, broken
        self.most_running, self.workers, self.seconds = running, workers, seconds
        self.paces: defaultdict[str, Pace] = defaultdict(Pace)
        self._change = threading.Condition()
        self._waiting: list[Job] = []
        self._running: list[Job] = []
        self._accounts = Accounts()
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

    def run(self, session: str, request: Any) -> Iterator[Progress | Result]:
        """Runs a request; yields its place in the queue, its progress and its result.

        An earlier run of the same session is cancelled. Closing the iterator cancels the run.

        Args:
            session: owner of the run.
            request: the request.

        Raises:
            InputError: if the queue or the person's share of it is full, the server is stopping, the run takes too
                long, or the engine cannot fulfil the request.
            Cancelled: if the run was cancelled.
        """
        job, outcome = self._enter(session, request, visitor()), "cancelled"
        try:
            for event in self._watch(job):
                if isinstance(event, Result):
                    outcome = "done"
                    for stage, seconds in event.timings.items():
                        self.figures.stage_seconds.labels(job.model, stage).observe(seconds)
                yield event
        except Exception as error:
            if not isinstance(error, Cancelled):
                outcome = "refused" if isinstance(error, InputError) else "failed"
            raise
        finally:
            self.figures.runs.labels(job.model, outcome).inc()
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

    def _enter(self, session: str, request: Any, who: Visitor) -> Job:
        token, person = CancelToken(self.seconds), who.person
        job = Job(person, request, cost=units(request), address=who.address, token=token)
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
            if job.model not in self._workers:
                self._workers.add(job.model)
                for _ in range(self.workers + 1):
                    threading.Thread(target=self._work, args=(job.model,), daemon=True).start()
            running = [(job.person, job.cost) for job in self._running]
            self._accounts.meet(person, {job.person for job in (*self._waiting, *self._running)}, running)
            self._sessions[session] = job.token
            self._waiting.append(job)
            self._change.notify_all()
        return job

    def _watch(self, job: Job) -> Iterator[Progress | Result]:
        while True:
            try:
                event = job.events.get(timeout=TICK)
            except queue.Empty:
                event = None
            if isinstance(event, Exception):
                raise event
            if not isinstance(event, Result) or job.token.cancelled:  # a result that is there is not too late
                job.token.raise_if_cancelled()
            if event is None:
                with self._change:
                    if job not in self._waiting:
                        continue
                    place, left = self._place(job)
                    count = len(self._waiting)
                elapsed = time.monotonic() - job.came
                yield Waiting(stage="queue", step=place, total=count, elapsed=elapsed, seconds_left=left)
                continue
            yield event
            if isinstance(event, Result):
                return

    def _place(self, job: Job) -> tuple[int, float | None]:
        """A waiting run's place in its model's queue, from 1, and the seconds until it starts, if they are known; the
        caller holds the lock."""
        mine = [other for other in self._waiting if other.model == job.model]
        before = list(takewhile(lambda other: other is not job, in_turn(mine, self._accounts.served)))
        running = [other for other in self._running if other.model == job.model]
        ahead = sum(other.cost for other in before)
        return len(before) + 1, self.paces[job.model].wait(ahead, running, self.workers)

    # ---- the workers -----------------------------------------------------------------------------

    def _work(self, model: str) -> None:
        while True:
            with self._change:
                while (job := self._next(model)) is None:
                    if self._stopping:
                        return
                    self._change.wait(TICK if self._waiting else None)
                self._waiting.remove(job)
                self._accounts.charge(job.person, job.cost)
                job.started = job.moved = time.monotonic()
                job.token.start()
                self._running.append(job)
            try:
                whole = self._run(job)
            finally:
                with self._change:
                    self._running.remove(job)
                    self._rested = time.monotonic()
                    self._change.notify_all()
            if whole:
                self.paces[model].learn(job.cost, time.monotonic() - job.started)
            self.figures.stage_seconds.labels(job.model, "queue").observe(job.started - job.came)

    def _next(self, model: str) -> Job | None:
        self._waiting = [job for job in self._waiting if not job.token.cancelled]
        mine = [job for job in self._waiting if job.model == model]
        busy = [job for job in self._running if job.model == model]
        if len(busy) >= self.workers:
            work, people = min(job.cost for job in busy) / SHORTER, {job.person for job in busy}
            late = len(busy) == self.workers and time.monotonic() - max(job.started for job in busy) > PATIENCE
            mine = [job for job in mine if late and job.cost <= work and job.person not in people]
        return next_job(mine, self._accounts.served, self._running, self.most_running)

    def _run(self, job: Job) -> bool:
        """Runs a job; returns whether it finished, so that its duration can be used to learn the pace."""
        try:
            for event in self.engine.run(job.request, cancel=job.token):
                job.moved = time.monotonic()
                job.events.put(event)
                if isinstance(event, Result):
                    return True
        except Exception as error:
            if not isinstance(error, (InputError, Cancelled)):
                self.figures.errors.labels(type(error).__name__).inc()
                self.broken(error)
            job.events.put(error)
        else:  # an engine stops without a result only when cancelled
            job.events.put(Cancelled("The run ended without a result."))
        return False
