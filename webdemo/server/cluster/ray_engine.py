"""The engine on Ray Serve: networks run in separate processes, on this machine or on several.

Each model is a Ray Serve application whose number of replicas follows the load; the page's process holds no
network. A request goes to one replica, which streams its progress back. If the replica dies, the request starts again
on another one, from its seed.
"""

from __future__ import annotations

import contextlib
import ctypes
import logging
import math
import os
import queue
import signal
import threading
import time
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

from motion import InputError
from motion.cores import usable_cores
from webdemo.inference.methods import methods
from webdemo.inference.requests import SamplingRequest
from webdemo.inference.run import CancelToken, Progress, Result

if TYPE_CHECKING:  # imported when first needed, so that the page is up before Ray is
    from ray.serve.handle import DeploymentHandle

log = logging.getLogger(__name__)

NAMESPACE = "pas-de-deux"
TRIES = 4
"""Attempts at a request whose replicas die."""
TICK = 0.2
"""Seconds between two checks whether a run was cancelled."""
AGAIN_AFTER = 0.5
"""Seconds between a replica's death and the next try."""
STORE_BYTES = 128 * 2**20
"""Shared memory of a cluster started here; a result takes 1 MB."""
LOOPBACK = "127.0.0.1"


def replicated() -> tuple[str, ...]:
    """The methods that have replicas of their own: those with weights and without parts.

    Requests of the others go to the default method's replicas.
    """
    return tuple(m.name for m in methods() if m.weights and not m.needs)


@contextlib.contextmanager
def keeping_sigterm() -> Iterator[None]:
    """Preserves the handler of SIGTERM: Ray's own handler would abort the process three seconds later.

    Python's signal module cannot do this, since it sets handlers in the main thread only.
    """
    libc, saved = ctypes.CDLL(None), ctypes.create_string_buffer(1024)  # more than a struct sigaction
    libc.sigaction(int(signal.SIGTERM), None, saved)
    try:
        yield
    finally:
        libc.sigaction(int(signal.SIGTERM), saved, None)


class RayEngine:
    """An engine whose networks are replicas of Ray Serve; safe to share between threads.

    Args:
        address: of a running cluster; empty starts one on this machine that listens on loopback only.
        replicas: (fewest, most) of the default model; the others have none until their first request.
        cores: CPU cores of one replica.
        weights: folder with one folder per model, on every machine of the cluster; None for the shipped one.

    Raises:
        InputError: if Ray is not installed.
    """

    def __init__(
        self, *, address: str = "", replicas: tuple[int, int] = (1, 1), cores: float = 1.0, weights: Path | None = None
    ) -> None:
        if find_spec("ray") is None:
            raise InputError(
                "Ray is not installed: `pip install -r requirements-ray.txt`, or set PASDEDEUX_ENGINE=local."
            )
        self.address, self.replicas, self.cores, self.weights = address, replicas, cores, weights
        self._handles: dict[str, DeploymentHandle] = {}
        self._lock = threading.Lock()
        self._cluster: threading.Thread | None = None
        self._closing = threading.Event()

    # ---- the interface of an engine --------------------------------------------------------------

    @property
    def parallel(self) -> int:
        """Useful number of concurrent requests to a model."""
        return self.replicas[1]

    @property
    def ready(self) -> bool:
        """True if the replicas of the default model are up."""
        return SamplingRequest.model in self._handles

    def warm_up(self) -> None:
        """Starts the replicas, and the cluster if no address was given; returns when the default model's are up.

        Raises:
            InputError: if the cluster cannot be reached.
        """
        self._handle(SamplingRequest.model)

    def run(self, request: Any, cancel: CancelToken | None = None) -> Iterator[Progress | Result]:
        """As :meth:`webdemo.inference.engine.Engine.run`, on a replica; restarted if the replica dies."""
        cancel = cancel or CancelToken()
        if not self.ready:
            yield Progress(stage="load")
        handle = self._handle(request.model if request.model in replicated() else SamplingRequest.model)
        from ray.exceptions import RayActorError
        from ray.serve.exceptions import DeploymentUnavailableError

        for left in reversed(range(TRIES)):
            try:
                yield from self._once(handle, request, cancel)
                return
            except (RayActorError, DeploymentUnavailableError) as error:
                if not left:
                    raise
                log.warning("A replica was lost (%s): its run begins again.", type(error).__name__)
                yield Progress(stage="load")
                time.sleep(AGAIN_AFTER)

    def close(self) -> None:
        """Stops the cluster if it was started here; leaves any other running."""
        with self._lock:
            self._handles.clear()
            self._closing.set()
            if self._cluster is not None:
                self._cluster.join()

    # ---- one request -----------------------------------------------------------------------------

    def _once(self, handle: DeploymentHandle, request: Any, cancel: CancelToken) -> Iterator[Progress | Result]:
        stream: Any = handle.options(stream=True).run.remote(request)
        arrived: queue.SimpleQueue[Any] = queue.SimpleQueue()

        def read() -> None:  # in its own thread: a waiting iterator of Ray cannot be abandoned
            try:
                for events in stream:
                    arrived.put(events)
                arrived.put((InputError("The run ended without a result: send it again."),))
            except BaseException as error:
                arrived.put((error,))

        threading.Thread(target=read, name="ray stream", daemon=True).start()
        try:
            while True:
                cancel.raise_if_cancelled()
                try:
                    events = arrived.get(timeout=TICK)
                except queue.Empty:
                    continue
                for event in events:
                    if isinstance(event, BaseException):
                        raise event
                    yield event
                    if isinstance(event, Result):
                        return
        finally:
            stream.cancel()  # no effect on a stream that has ended

    # ---- the cluster -----------------------------------------------------------------------------

    def _handle(self, model: str) -> DeploymentHandle:
        if (known := self._handles.get(model)) is not None:  # not behind another model's first start
            return known
        with self._lock:
            if model not in self._handles:
                self._connect()
                self._handles[model] = self._deployed(model)
            return self._handles[model]

    def _connect(self) -> None:
        """Joins or starts the cluster in a thread that lives as long as the cluster.

        The system kills Ray's processes when the thread that started them ends.
        """
        if self._cluster is not None and self._cluster.is_alive():
            return
        started: queue.SimpleQueue[Exception | None] = queue.SimpleQueue()
        self._closing.clear()
        self._cluster = threading.Thread(target=self._hold, args=(started,), name="ray cluster", daemon=True)
        self._cluster.start()
        error = started.get()
        if error is not None:
            log.error("Ray did not start.", exc_info=error)
            reason = str(error).partition("\n")[0][:200]
            raise InputError(
                f"No Ray cluster answers at {self.address or 'this machine'} ({reason}): "
                "correct PASDEDEUX_RAY_ADDRESS, or set PASDEDEUX_ENGINE=local."
            )

    def _hold(self, started: queue.SimpleQueue[Exception | None]) -> None:
        """Starts or joins the cluster, reports it in ``started``, and stops it when the engine is closed."""
        os.environ.setdefault("RAY_USAGE_STATS_ENABLED", "0")
        if not self.address:
            # Ray's name for "one machine": its processes then listen on loopback only. Ray reads it when imported.
            os.environ.setdefault("RAY_ENABLE_WINDOWS_OR_OSX_CLUSTER", "0")
        try:
            import ray
            from ray import serve

            where: dict[str, Any] = {"address": self.address}
            if not self.address:
                cores = self.replicas[1] * self.cores + (len(replicated()) - 1) * self.cores / 2
                where = {
                    "address": "local",
                    "include_dashboard": False,
                    "_node_ip_address": LOOPBACK,
                    "object_store_memory": STORE_BYTES,
                    "num_cpus": max(usable_cores(), math.ceil(cores)),
                }
            with keeping_sigterm():
                ray.init(namespace=NAMESPACE, configure_logging=False, log_to_driver=False, **where)
            serve.start(proxy_location="Disabled")
            logger = logging.getLogger("ray.serve")  # its messages go into the server's own log
            logger.handlers.clear()
            logger.propagate = True
            logger.setLevel(logging.WARNING)
        except Exception as error:
            started.put(error)
            return
        started.put(None)
        self._closing.wait()
        if not self.address:
            serve.shutdown()
        ray.shutdown()

    def _deployed(self, model: str) -> DeploymentHandle:
        """The model's application, deployed unless another page's process already did so."""
        from ray import serve

        from .ray_replica import ModelReplica

        name = f"{NAMESPACE}-{model}"
        there = serve.status().applications.get(name)
        if there is not None and there.status in ("RUNNING", "DEPLOYING"):
            return serve.get_app_handle(name)
        fewest, most = self.replicas if model == SamplingRequest.model else (0, 1)
        replica: Any = serve.deployment(
            ModelReplica,
            name=model,
            max_ongoing_requests=1,
            autoscaling_config={
                "min_replicas": fewest,
                "max_replicas": most,
                "target_ongoing_requests": 1,
                "upscale_delay_s": 5,
                "downscale_delay_s": 120,
            },
            ray_actor_options={"num_cpus": self.cores if model == SamplingRequest.model else self.cores / 2},
            health_check_period_s=5,
        )
        weights = None if self.weights is None else str(self.weights)
        application = replica.bind(model, weights, loopback=not self.address)
        return serve.run(application, name=name, route_prefix=None)
