"""Figures for Prometheus."""

from __future__ import annotations

import resource
import sys
from collections.abc import Callable

from prometheus_client import CollectorRegistry, Counter, Gauge, Histogram, generate_latest
from prometheus_client.process_collector import ProcessCollector

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
        self.batch_size = Histogram(
            "pasdedeux_batch_runs",
            "Runs in one pass through a network",
            ["model"],
            buckets=(1, 2, 3, 4, 6, 8, 16),
            registry=registry,
        )
        self.estimate_ratio = Histogram(
            "pasdedeux_estimate_ratio",
            "Waiting time of a run divided by its first estimate",
            buckets=(0.25, 0.5, 0.8, 1, 1.25, 2, 4),
            registry=registry,
        )
        self.errors = Counter("pasdedeux_errors", "Errors that are not the user's", ["kind"], registry=registry)
        self.refused = Counter("pasdedeux_refused", "Requests refused", ["reason"], registry=registry)
        self._waiting = Gauge("pasdedeux_queue_waiting", "Runs that wait", registry=registry)
        self._running = Gauge("pasdedeux_queue_running", "Runs that run", registry=registry)
        self._live = Gauge("pasdedeux_live_streams", "Live streams", registry=registry)
        self._ready = Gauge("pasdedeux_ready", "1 where a tiny generation works", registry=registry)
        self._memory = Gauge("pasdedeux_memory_peak_bytes", "Most memory so far", registry=registry)
        unit = 1 if sys.platform == "darwin" else 1024
        self._memory.set_function(lambda: resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit)

    def watch(
        self,
        *,
        waiting: Callable[[], int],
        running: Callable[[], int],
        ready: Callable[[], bool],
        live: Callable[[], int],
    ) -> None:
        """Takes the gauges' values from these whenever the figures are read."""
        self._waiting.set_function(waiting)
        self._running.set_function(running)
        self._ready.set_function(ready)
        self._live.set_function(live)

    def text(self) -> bytes:
        """All figures in Prometheus' text format."""
        return generate_latest(self.registry)
