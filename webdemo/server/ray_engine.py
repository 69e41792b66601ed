"""The engine on Ray Serve: networks in processes of their own, on this machine or on several.

Every model is an application of Ray Serve with replicas that come and go with the load; the page's process
holds no network. A request goes to one replica, which runs it together with others that fit, and streams
its progress back. Where the replica dies, the request begins again on another, from its seed.
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

from webdemo.inference.cancel import CancelToken
from webdemo.inference.requests import Progress, Result, SamplingRequest
from webdemo.motion import InputError

from .ray_messages import Began

if TYPE_CHECKING:  # imported when first needed, so that the page is up before Ray is
    from ray.serve.handle import DeploymentHandle

log = logging.getLogger(__name__)

NAMESPACE = "pas-de-deux"
MODELS = ("intergen", "bigraphdiff", "regennet", "interformer", "motion-mlp", "mawgan")
"""Those that have replicas of their own; what else there is goes to the first's."""
TRIES = 4
"""How often a request is begun, where replicas die under it."""
TICK = 0.2
"""Seconds between two looks at whether a run was cancelled."""
AGAIN_AFTER = 0.5
"""Seconds between a replica's death and the next try."""
STORE_BYTES = 128 * 2**20
"""Shared memory of a cluster that is started here; a result is 1 MB."""
MOST_PARALLEL = 128
"""Requests of one model that a page's process has on their way; each holds two threads."""
LOOPBACK = "127.0.0.1"


@contextlib.contextmanager
def keeping_sigterm() -> Iterator[None]:
    """Leaves what SIGTERM does as it was: Ray's own handler would abort the process three seconds later.

    Python's signal module cannot do it, since it changes handlers in the main thread alone.
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
        address: of a running cluster; empty starts one on this machine that listens on loopback alone.
        replicas: (fewest, most) of the default model; the others have none until they are asked for.
        cores: of one replica.
        batch: motions in one pass, and requests that a replica takes at a time.
        weights: folder that holds a folder a model, on every machine of the cluster; None for the shipped.

    Raises:
        InputError: where Ray is not installed.
    """

    def __init__(
        self,
        *,
        address: str = "",
        replicas: tuple[int, int] = (1, 1),
        cores: float = 1.0,
        batch: int = 8,
        weights: Path | None = None,
    ) -> None:
        if find_spec("ray") is None:
            raise InputError(
                "Ray is not installed: `pip install -r requirements-ray.txt`, or set PASDEDEUX_ENGINE=local."
            )
        self.address, self.replicas, self.cores, self.batch = address, replicas, cores, batch
        self.weights = weights
        self.at_work: dict[int, int] = {}
        """How many runs of this process each replica has, by its process id."""
        self._handles: dict[str, DeploymentHandle] = {}
        self._lock, self._counting = threading.Lock(), threading.Lock()
        self._cluster: threading.Thread | None = None
        self._closing = threading.Event()

    # ---- as the page knows an engine -------------------------------------------------------------

    @property
    def parallel(self) -> int:
        """How many requests of a model it is good to have on their way at a time."""
        return min(self.replicas[1] * self.batch, MOST_PARALLEL)

    @property
    def ready(self) -> bool:
        """Whether the replicas of the default model are up."""
        return SamplingRequest.model in self._handles

    def warm_up(self) -> None:
        """Starts the cluster, where none is named, and the replicas; returns when the default model's are up.

        Raises:
            InputError: where the cluster cannot be reached.
        """
        self._handle(SamplingRequest.model)

    def info(self) -> dict[str, Any]:
        """The default model's card, from a replica."""
        return self._handle(SamplingRequest.model).info.remote().result(timeout_s=60)

    def run(self, request: Any, cancel: CancelToken | None = None) -> Iterator[Progress | Result]:
        """As :meth:`webdemo.inference.engine.Engine.run`, on a replica; begun anew where that dies."""
        cancel = cancel or CancelToken()
        if not self.ready:
            yield Progress(stage="load")
        handle = self._handle(request.model if request.model in MODELS else SamplingRequest.model)
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
        """Ends the cluster where it was started here; another's goes on."""
        with self._lock:
            self._handles.clear()
            self._closing.set()
            if self._cluster is not None:
                self._cluster.join()

    # ---- a request on its way --------------------------------------------------------------------

    def _once(
        self, handle: DeploymentHandle, request: Any, cancel: CancelToken
    ) -> Iterator[Progress | Result]:
        stream = handle.options(stream=True).run.remote(request)
        arrived: queue.SimpleQueue[Any] = queue.SimpleQueue()

        def read() -> None:  # a thread of its own: an iterator of Ray's cannot be left while it waits
            try:
                for events in stream:
                    arrived.put(events)
                arrived.put((InputError("The run ended without a result: send it again."),))
            except BaseException as error:
                arrived.put((error,))

        threading.Thread(target=read, name="ray stream", daemon=True).start()
        pid = 0
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
                    if isinstance(event, Began):
                        pid = event.pid
                        self._count(pid, 1)
                        continue
                    yield event
                    if isinstance(event, Result):
                        return
        finally:
            stream.cancel()  # what has ended does not mind
            if pid:
                self._count(pid, -1)

    def _count(self, pid: int, change: int) -> None:
        with self._counting:
            self.at_work[pid] = self.at_work.get(pid, 0) + change
            if not self.at_work[pid]:
                del self.at_work[pid]

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
        """Joins or starts the cluster, in a thread that lives as long as it.

        Ray lets its processes be killed by the system when the thread ends that has started them.
        """
        if self._cluster is not None and self._cluster.is_alive():
            return
        told: queue.SimpleQueue[Exception | None] = queue.SimpleQueue()
        self._closing.clear()
        self._cluster = threading.Thread(target=self._hold, args=(told,), name="ray cluster", daemon=True)
        self._cluster.start()
        error = told.get()
        if error is not None:
            log.error("Ray did not start.", exc_info=error)
            reason = str(error).partition("\n")[0][:200]
            raise InputError(
                f"There is no Ray cluster to be had at {self.address or 'this machine'} ({reason}): "
                "correct PASDEDEUX_RAY_ADDRESS, or set PASDEDEUX_ENGINE=local."
            )

    def _hold(self, told: queue.SimpleQueue[Exception | None]) -> None:
        """Starts or joins the cluster, says so, and ends it when the engine is closed."""
        os.environ.setdefault("RAY_USAGE_STATS_ENABLED", "0")
        if not self.address:
            # Ray's name for "one machine": its processes then listen on loopback alone. Read at the import.
            os.environ.setdefault("RAY_ENABLE_WINDOWS_OR_OSX_CLUSTER", "0")
        try:
            import ray
            from ray import serve

            where: dict[str, Any] = {"address": self.address}
            if not self.address:
                cores = self.replicas[1] * self.cores + (len(MODELS) - 1) * self._cores(MODELS[-1])
                where = {
                    "address": "local", "include_dashboard": False, "_node_ip_address": LOOPBACK,
                    "object_store_memory": STORE_BYTES,
                    "num_cpus": max(os.cpu_count() or 1, math.ceil(cores)),
                }  # fmt: skip
            with keeping_sigterm():
                ray.init(namespace=NAMESPACE, configure_logging=False, log_to_driver=False, **where)
            serve.start(proxy_location="Disabled")
            logger = logging.getLogger("ray.serve")  # what it says goes into the server's own log
            logger.handlers.clear()
            logger.propagate = True
            logger.setLevel(logging.WARNING)
        except Exception as error:
            told.put(error)
            return
        told.put(None)
        self._closing.wait()
        if not self.address:
            serve.shutdown()
        ray.shutdown()

    def _deployed(self, model: str) -> DeploymentHandle:
        """The model's application, deployed unless another page's process did."""
        from ray import serve

        from .ray_replica import ModelReplica

        name = f"{NAMESPACE}-{model}"
        there = serve.status().applications.get(name)
        if there is not None and there.status in ("RUNNING", "DEPLOYING"):
            return serve.get_app_handle(name)
        fewest, most = self.replicas if model == SamplingRequest.model else (0, 1)
        replica = serve.deployment(
            ModelReplica,
            name=model,
            max_ongoing_requests=self.batch,
            autoscaling_config={
                "min_replicas": fewest,
                "max_replicas": most,
                "target_ongoing_requests": max(self.batch / 2, 1),
                "upscale_delay_s": 5,
                "downscale_delay_s": 120,
            },
            ray_actor_options={"num_cpus": self._cores(model)},
            health_check_period_s=5,
        )
        weights = None if self.weights is None else str(self.weights)
        application = replica.bind(model, weights, self.batch, loopback=not self.address)
        return serve.run(application, name=name, route_prefix=None)

    def _cores(self, model: str) -> float:
        return self.cores if model == SamplingRequest.model else self.cores / 2
