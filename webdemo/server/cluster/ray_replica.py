"""A Ray Serve replica: an engine of one model, which streams the progress of its runs back."""

from __future__ import annotations

import logging
import os
import queue
import threading
from collections.abc import AsyncIterator
from pathlib import Path
from typing import Any

from anyio.to_thread import run_sync

from motion import InputError
from webdemo.inference.engine import Engine
from webdemo.inference.requests import SamplingRequest
from webdemo.inference.run import Cancelled, CancelToken, Progress, Result
from webdemo.server.logs import set_up_logs

log = logging.getLogger(__name__)
Event = Progress | Result | Exception


class ReplicaError(Exception):
    """A run ended with an internal error; the message names its type and the process whose log has it."""


class ModelReplica:
    """Runs the requests of one model, one after another.

    Args:
        model: its name; the default model is loaded at the start, any other with its first request.
        weights: folder with one folder per model; None for the shipped one.
        loopback: refuse connections from other machines.
    """

    def __init__(self, model: str, weights: str | None, *, loopback: bool) -> None:
        set_up_logs("warning", content=False)
        if loopback:
            listen_on_loopback()
        self._engine = Engine() if weights is None else Engine(Path(weights))
        if model == SamplingRequest.model:
            self._engine.warm_up()

    async def run(self, request: Any) -> AsyncIterator[tuple[Event, ...]]:
        """Yields a request's events in tuples, each of what has come since the one before.

        The last event is a Result or the exception that ended the run. Closing the stream stops the run
        within one denoising step.
        """
        token, come = CancelToken(), queue.SimpleQueue[Event | None]()

        def work() -> None:
            try:
                for event in self._engine.run(request, cancel=token):
                    come.put(event)
            except Exception as error:
                come.put(portable(error))
            come.put(None)

        threading.Thread(target=work, name="run", daemon=True).start()
        try:
            while True:
                events = [await run_sync(come.get, abandon_on_cancel=True)]
                while not come.empty():
                    events.append(come.get())
                yield tuple(event for event in events if event is not None)
                if events[-1] is None:
                    return
        finally:
            token.cancel()


def listen_on_loopback() -> None:
    """Makes the server that Ray Serve starts for this replica listen on loopback only.

    As of Ray 2.60 it is the only server that ignores the address of Ray's node. If a later Ray starts it in
    another way, Ray's access token still protects it.
    """
    from ray.serve._private import replica

    add = getattr(replica, "add_port_to_grpc_server", None)
    if add is not None:
        replica.add_port_to_grpc_server = lambda server, at: add(server, at.replace("[::]", "127.0.0.1"))


def portable(error: Exception) -> Exception:
    """An error that any process can unpickle: InputError and Cancelled keep their type, others are named."""
    for kind in (InputError, Cancelled):
        if isinstance(error, kind):
            return kind(str(error))
    log.error("A run failed.", exc_info=error)
    return ReplicaError(f"{type(error).__name__} in process {os.getpid()} of Ray Serve; its log says more.")
