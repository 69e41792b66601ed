"""A Ray Serve replica: an engine whose requests share passes and which streams their progress back."""

from __future__ import annotations

import asyncio
import logging
import os
import threading
from collections.abc import AsyncIterator, Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ray import serve

from motion import InputError
from webdemo.inference.requests import SamplingRequest
from webdemo.inference.run import Cancelled, CancelToken, Progress, Result
from webdemo.server.logs import set_up_logs
from webdemo.server.queue.shared_engine import SharedEngine

from .ray_messages import Began, ReplicaError

log = logging.getLogger(__name__)
Event = Progress | Result | Exception
HEARTBEAT = 0.25
"""Seconds without an event after which a stream sends a heartbeat."""
GATHER_SECONDS = 0.03
"""Seconds that the first request of a batch waits for others."""
_batched: Any = serve.batch(max_batch_size=8, batch_wait_timeout_s=GATHER_SECONDS)
"""Untyped, since Ray's types know no batches of methods that are generators."""


@dataclass
class Job:
    """A request in a replica; the token is set when the caller closes the stream."""

    request: Any
    token: CancelToken = field(default_factory=CancelToken)


class ModelReplica:
    """Runs the requests of one model; compatible requests share passes.

    Args:
        model: its name; the default model is loaded at the start, any other with its first request.
        weights: folder with one folder per model; None for the shipped one.
        batch: most motions in one pass.
        loopback: refuse connections from other machines.
    """

    def __init__(self, model: str, weights: str | None, batch: int, *, loopback: bool) -> None:
        set_up_logs("warning", content=False)
        if loopback:
            listen_on_loopback()
        self._engine = SharedEngine(None if weights is None else Path(weights))
        self._batch = batch
        self._together.set_max_batch_size(batch)
        if model == SamplingRequest.model:
            self._engine.warm_up()

    async def run(self, request: Any) -> AsyncIterator[tuple[Began | Event, ...]]:
        """Yields a request's events in tuples; an empty tuple is a heartbeat.

        The last event is a Result or the exception that ended the run. Closing the stream stops the run
        within one denoising step and does not affect the runs that share its passes.
        """
        job = Job(request)
        yield (Began(os.getpid()),)
        try:
            async for events in self._together(job):
                yield events
                if any(isinstance(event, Result | Exception) for event in events):
                    return
        finally:
            job.token.cancel()

    @_batched
    async def _together(self, jobs: list[Job]) -> AsyncIterator[list[tuple[Event, ...]]]:
        """Yields the new events of each job."""
        async for events in in_thread(lambda: self._run_groups(jobs)):
            new: list[list[Event]] = [[] for _ in jobs]
            for i, event in events:
                new[i].append(event)
            yield [tuple(events_of_one) for events_of_one in new]

    def _run_groups(self, jobs: Sequence[Job]) -> Iterator[tuple[int, Event]]:
        for group in groups(self._engine, [job.request for job in jobs], self._batch):
            items = [(jobs[i].request, jobs[i].token) for i in group]
            try:
                for i, event in self._run_group(items):
                    yield group[i], portable(event) if isinstance(event, Exception) else event
            except Exception as error:  # of the whole group; a job that has its result is no longer read
                yield from ((i, portable(error)) for i in group)

    def _run_group(self, items: Sequence[tuple[Any, CancelToken]]) -> Iterator[tuple[int, Event]]:
        if len(items) > 1:
            yield from self._engine.run_together(items)
            return
        (request, token), *_ = items
        for event in self._engine.run(request, cancel=token):
            yield 0, event


def listen_on_loopback() -> None:
    """Makes the server that Ray Serve starts for this replica listen on loopback only.

    As of Ray 2.60 it is the only server that ignores the address of Ray's node. If a later Ray starts it in
    another way, Ray's access token still protects it.
    """
    from ray.serve._private import replica

    add = getattr(replica, "add_port_to_grpc_server", None)
    if add is not None:
        replica.add_port_to_grpc_server = lambda server, at: add(server, at.replace("[::]", "127.0.0.1"))


def groups(engine: SharedEngine, requests: Sequence[Any], batch: int) -> list[list[int]]:
    """Groups request indices by equal key and similar length, up to ``batch`` motions each."""
    made: list[list[int]] = []
    for i, request in enumerate(requests):
        key = engine.key(request)
        for group in made if key is not None else ():
            others = [requests[j] for j in group]
            motions = request.samples + sum(other.samples for other in others)
            if engine.key(others[0]) == key and motions <= batch and engine.fits(others, request):
                group.append(i)
                break
        else:
            made.append([i])
    return made


def portable(error: Exception) -> Exception:
    """An error that any process can unpickle: InputError and Cancelled keep their type, others are named."""
    for kind in (InputError, Cancelled):
        if isinstance(error, kind):
            return kind(str(error))
    log.error("A run failed.", exc_info=error)
    return ReplicaError(f"{type(error).__name__} in process {os.getpid()} of Ray Serve; its log says more.")


async def in_thread(items: Callable[[], Iterable[Any]]) -> AsyncIterator[list[Any]]:
    """Yields lists of what a thread iterates over; an empty list after each :data:`HEARTBEAT` without items."""
    loop, queue = asyncio.get_running_loop(), asyncio.Queue[Any]()
    end = object()

    def work() -> None:
        try:
            for item in items():
                loop.call_soon_threadsafe(queue.put_nowait, item)
        finally:
            loop.call_soon_threadsafe(queue.put_nowait, end)

    threading.Thread(target=work, name="group", daemon=True).start()
    while True:
        try:
            found = [await asyncio.wait_for(queue.get(), HEARTBEAT)]
        except TimeoutError:
            yield []
            continue
        while not queue.empty():
            found.append(queue.get_nowait())
        kept = [item for item in found if item is not end]
        if kept:
            yield kept
        if len(kept) < len(found):
            return
