"""The time that each part of a request takes, the share of the machine's arithmetic, and the cost of a busy core."""

from __future__ import annotations

import contextlib
import statistics
import subprocess
import sys
import time
from collections import defaultdict
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

from webdemo.view.payload import player_payload

REQUEST_GOAL = 2.0
UNDAMPED_GOAL = 1.5
BUSY_GOAL = 4.0
SHARE_GOAL = 0.55
GEMM = 1024
"""Rows and columns of the matrices whose product says what the machine can do."""


def gemm_gflops(repeats: int = 20) -> float:
    """10⁹ operations a second of a product of float32 matrices by PyTorch with all threads; the best of ``repeats``."""
    import torch

    from models.threads import CORES

    before = torch.get_num_threads()
    torch.set_num_threads(CORES)
    a, b = torch.randn(2, GEMM, GEMM)
    best = float("inf")
    for _ in range(repeats):
        began = time.perf_counter()
        a @ b
        best = min(best, time.perf_counter() - began)
    torch.set_num_threads(before)
    return 2 * GEMM**3 / best / 1e9


class TimedPasses:
    """The passes of a request that runs alone (:class:`webdemo.inference.pipelines.two_person.Passes`), timed:
    ``seconds`` has ``network``, ``guidance`` and ``damping``."""

    def __init__(self, denoiser: Any) -> None:
        self.denoiser = denoiser
        self.seconds: defaultdict[str, float] = defaultdict(float)

    def guided(self, *inputs: Any, **options: Any) -> Any:
        """As the denoiser's own."""
        inside = 0.0

        def begin(*_: Any) -> None:
            nonlocal inside
            inside -= time.perf_counter()

        def end(*_: Any) -> None:
            nonlocal inside
            inside += time.perf_counter()

        hooks = (self.denoiser.register_forward_pre_hook(begin), self.denoiser.register_forward_hook(end))
        began = time.perf_counter()
        out = self.denoiser.guided(*inputs, **options)
        whole = time.perf_counter() - began
        for hook in hooks:
            hook.remove()
        self.seconds["network"] += inside
        self.seconds["guidance"] += whole - inside
        return out

    def correct(self, damping: Any, x0: Any, timestep: int) -> Any:
        """As the damping's own."""
        began = time.perf_counter()
        out = damping(x0, timestep)
        self.seconds["damping"] += time.perf_counter() - began
        return out


class CountedPasses:
    """Passes of PyTorch's own run of a network; ``operations`` are the floating-point operations of the last."""

    def __init__(self, plain: Any) -> None:
        self.plain, self.operations = plain, 0

    def guided(self, *inputs: Any, **options: Any) -> Any:
        """As the denoiser's own."""
        from torch.utils.flop_counter import FlopCounterMode

        with FlopCounterMode(display=False) as counter:
            out = self.plain.guided(*inputs, **options)
        self.operations = counter.get_total_flops()
        return out

    def correct(self, damping: Any, x0: Any, timestep: int) -> Any:
        """Nothing."""
        return x0


def measure_parts(engine: Any, request: Any, plain: Any, repeats: int) -> dict[str, float]:
    """Milliseconds of a request's parts, and the network's share of the machine's arithmetic.

    Args:
        engine: has the model.
        request: of the default model.
        plain: its denoiser, run by PyTorch.
        repeats: medians of so many runs.

    Returns:
        ``part_ms_*``; ``gemm_gflops`` of a large product in this same run, ``network_gflops``, and their ratio
        ``network_share_of_gemm``.
    """
    denoiser = engine.pipeline(request.model).model.denoiser
    counted = CountedPasses(plain)
    list(engine.run(replace(request, steps=1), passes=counted))
    runs: list[dict[str, float]] = []
    for _ in range(repeats):
        passes = TimedPasses(denoiser)
        *_, result = engine.run(request, passes=passes)
        began = time.perf_counter()
        player_payload(result.duets)
        stages, payload = result.timings, time.perf_counter() - began
        rest = stages["sample"] - sum(passes.seconds.values())
        runs.append(
            {
                "text": stages["text"],
                **passes.seconds,
                "scheduler": rest,
                "finish": stages["finish"],
                "payload": payload,
            }
        )
    parts = {name: statistics.median(run[name] for run in runs) for name in runs[0]}
    gemm, speed = gemm_gflops(), counted.operations * request.steps / parts["network"] / 1e9
    return {f"part_ms_{name}": 1000 * seconds for name, seconds in parts.items()} | {
        "gemm_gflops": gemm,
        "network_gflops": speed,
        "network_share_of_gemm": speed / gemm,
        "network_share_of_gemm_goal": SHARE_GOAL,
    }


def measure_busy(run: Callable[[], Any], alone: float, repeats: int) -> dict[str, float]:
    """Seconds of a request beside one busy core, and over those alone.

    Args:
        run: the request.
        alone: its seconds on the machine as it is.
        repeats: the median of so many.
    """
    times = []
    with busy_core():
        for _ in range(repeats):
            began = time.perf_counter()
            run()
            times.append(time.perf_counter() - began)
    seconds = statistics.median(times)
    return {"busy_request_seconds": seconds, "busy_request_seconds_goal": BUSY_GOAL, "busy_over_alone": seconds / alone}


@contextlib.contextmanager
def busy_core() -> Iterator[None]:
    """A process that takes all of a core."""
    process = subprocess.Popen([sys.executable, "-c", "while True: pass"])
    try:
        yield
    finally:
        process.kill()
        process.wait()
