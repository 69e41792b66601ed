"""Throughput of requests that share their denoising passes, against the same requests one after the other."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable
from dataclasses import replace

from webdemo.inference.requests import GenerateRequest

from .jobs import PROMPTS

BATCHED_GOAL = 1.8
"""Throughput of eight requests of four seconds that share passes, over that of the same in turn."""


def measure_batching(*, requests: int = 8, steps: int = 50, seconds: float = 4.0, repeats: int = 3) -> dict[str, float]:
    """Throughput of requests that share passes over that of the same requests in turn, and the largest difference
    of their motions. Both run alternately ``repeats`` times, and the figures are medians. The ratio is also given by
    processor time, which other work on the machine does not change."""
    import numpy as np

    from webdemo.inference.engine import Engine
    from webdemo.inference.engine.batch import run_batch
    from webdemo.inference.run import CancelToken, Result

    engine = Engine()
    engine.warm_up()
    first = GenerateRequest(prompt=PROMPTS[0], seconds=seconds, steps=steps)
    asked = [replace(first, prompt=PROMPTS[i % len(PROMPTS)], seed=i) for i in range(requests)]
    alone: list[Result] = []
    together: dict[int, Result] = {}

    def serially() -> None:
        alone[:] = [event for r in asked for event in engine.run(r) if isinstance(event, Result)]

    def at_once() -> None:
        events = run_batch(engine, [(r, CancelToken()) for r in asked])
        together.update((i, event) for i, event in events if isinstance(event, Result))

    list(engine.run(replace(first, steps=2)))
    times = [(*_took(serially), *_took(at_once)) for _ in range(repeats)]
    serial, batched = (statistics.median(t[i] for t in times) for i in (0, 2))
    figures = {
        "serial_seconds": serial,
        "batched_seconds": batched,
        "batched_over_serial_throughput": statistics.median(t[0] / t[2] for t in times),
        "batched_over_serial_by_processor_time": statistics.median(t[1] / t[3] for t in times),
        "batched_largest_difference_mm": 1000
        * max(
            float(np.abs(together[i].duets[0].positions - alone[i].duets[0].positions).max()) for i in range(requests)
        ),
    }
    return figures


def _took(job: Callable[[], None]) -> tuple[float, float]:
    """Seconds, and seconds of processor time, that a job takes."""
    began, before = time.perf_counter(), time.process_time()
    job()
    return time.perf_counter() - began, time.process_time() - before
