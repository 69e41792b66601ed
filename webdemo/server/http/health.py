"""The health check, a tiny generation that shows that the server can do its work; and figures for Prometheus."""

from __future__ import annotations

import gc
import logging
import threading
import time
from collections.abc import Callable
from typing import Any

from prometheus_client import CollectorRegistry, Counter, Gauge, Histogram, generate_latest
from prometheus_client.process_collector import ProcessCollector

from motion import InputError
from webdemo.inference.requests import GenerateRequest
from webdemo.inference.run import CancelToken, Result
from webdemo.ui.runs import EngineLike

log = logging.getLogger(__name__)

Report = tuple[bool, dict[str, Any]]
"""Whether all is well, and the status with the state of each part."""

PAUSE = 30.0
"""Seconds between two tries after one that failed."""
EVERY = 5.0
"""Seconds between two looks."""
LATE = 60.0
"""Seconds after which a look that does not come is a failure."""


class Health:
    """Ready once a tiny generation has worked, and until a run breaks; then another one is tried.

    Args:
        engine: what generates.
        wants: further things that must hold, by name; each raises where it does not, an InputError with a sentence
            that anybody may read.
        works: what must make progress, by name: seconds for which it has made none.
        stuck_seconds: after which it is stuck.
    """

    def __init__(
        self,
        engine: EngineLike,
        wants: dict[str, Callable[[], Any]] | None = None,
        *,
        works: dict[str, Callable[[], float]] | None = None,
        stuck_seconds: float = 300.0,
    ) -> None:
        self.engine = engine
        self.wants, self.works = wants or {}, {"health check": self._trying, **(works or {})}
        self.stuck_seconds = stuck_seconds
        self.stopping = False
        self.error = ""
        self._works = False
        self._tried_at = -PAUSE
        self._found: dict[str, str] = {}
        self._found_at = time.monotonic()
        self._lock = threading.Lock()
        self._thread: threading.Thread | None = None

    @property
    def ready(self) -> bool:
        """True if requests should be sent here."""
        return self._works and not self.stopping

    def probe(self) -> None:
        """Starts a tiny generation in its own thread, unless one is running or has just failed."""
        with self._lock:
            busy = self._thread is not None and self._thread.is_alive()
            if self._works or busy or time.monotonic() - self._tried_at < PAUSE:
                return
            self._tried_at = time.monotonic()
            self._thread = threading.Thread(target=self._try, name="health", daemon=True)
            self._thread.start()

    def broken(self, error: BaseException) -> None:
        """A run ended in an error that was not its user's."""
        self._works = False
        self.error = f"a run ended in {type(error).__name__}"

    def keep_looking(self) -> None:
        """Looks every few seconds, in a thread of its own, so that nobody who asks waits for anything."""
        threading.Thread(target=self._look, name="look", daemon=True).start()

    def _look(self) -> None:
        while not self.stopping:
            self.probe()
            self._found = {name: _state_of(check) for name, check in self.wants.items()}
            self._found_at = time.monotonic()
            time.sleep(EVERY)

    def report(self) -> Report:
        """What the last look has found, and how runs are."""
        checks = dict(self._found)
        if (late := time.monotonic() - self._found_at) > LATE:
            checks["looks"] = f"failed: nothing was looked at for {late:.0f} s"
        checks["generation"] = "ok" if self._works else f"failed: {self.error}" if self.error else "loading"
        checks["progress"] = f"failed: {stuck}" if (stuck := self.stuck()) else "ok"
        whole = self.ready and all(state == "ok" for state in checks.values())
        failed = any(state.startswith("failed") for state in checks.values())
        status = "stopping" if self.stopping else "ready" if whole else "failed" if failed else "loading"
        return whole, {"status": status, "checks": checks}

    def stuck(self) -> str:
        """A sentence about what has made no progress for too long; empty while everything goes on."""
        for name, still in self.works.items():
            if (seconds := still()) > self.stuck_seconds:
                return f"The {name} has made no progress for {seconds:.0f} s."
        return ""

    def _trying(self) -> float:
        """Seconds for which a tiny generation has been going on."""
        alive = self._thread is not None and self._thread.is_alive()
        return time.monotonic() - self._tried_at if alive else 0.0

    def _try(self) -> None:
        request = GenerateRequest(prompt="Two people wave.", seconds=1.0, steps=1, damping=0.0)
        try:
            self.engine.warm_up()
            *_, result = self.engine.run(request, CancelToken())
            if not isinstance(result, Result):
                raise RuntimeError("no result")
        except InputError as error:
            self.error = str(error)
        except Exception as error:
            log.exception("A tiny generation failed.")
            self.error = f"a tiny generation ended in {type(error).__name__}"
        else:
            self._works, self.error = True, ""
            gc.freeze()  # the networks stay: a search for garbage among their objects stops everything for 0.3 s


def _state_of(check: Callable[[], Any]) -> str:
    """What /healthz says of a check."""
    try:
        check()
    except InputError as error:
        return f"failed: {error}"
    except Exception as error:
        return f"failed ({type(error).__name__})"
    return "ok"


# ---- figures for Prometheus ----------------------------------------------------------------------


_SECONDS = (0.01, 0.05, 0.1, 0.25, 0.5, 1, 2.5, 5, 10, 30, 60, 120, 300)


class Figures:
    """The server's metrics. Each server has its own registry, so two in one process do not mix."""

    def __init__(self) -> None:
        self.registry = registry = CollectorRegistry()
        ProcessCollector(registry=registry)
        self.requests = Counter(
            "pasdedeux_http_requests", "HTTP requests", ["route", "method", "status"], registry=registry
        )
        self.answer_seconds = Histogram(
            "pasdedeux_http_seconds", "Time to the first byte", ["route"], buckets=_SECONDS, registry=registry
        )
        self.runs = Counter("pasdedeux_runs", "Runs by how they ended", ["model", "outcome"], registry=registry)
        self.stage_seconds = Histogram(
            "pasdedeux_stage_seconds",
            "Time in each stage of a run",
            ["model", "stage"],
            buckets=_SECONDS,
            registry=registry,
        )
        self.errors = Counter("pasdedeux_errors", "Errors that are not the user's", ["kind"], registry=registry)
        self.refused = Counter("pasdedeux_refused", "Requests refused", ["reason"], registry=registry)

    def watch(self, name: str, documentation: str, value: Callable[[], float]) -> None:
        """Adds a gauge whose value is taken whenever the figures are read."""
        Gauge(f"pasdedeux_{name}", documentation, registry=self.registry).set_function(value)

    def text(self) -> bytes:
        """All figures in Prometheus' text format."""
        return generate_latest(self.registry)
