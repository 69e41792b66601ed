"""Speed on this machine, as figures and as ratios to a plain run of the same network.

``python -m webdemo benchmark`` prints one line a figure. Absolute times depend on the machine and what else
it does; the ratios are of runs that alternate within one call and hold anywhere.
"""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from itertools import count
from typing import Any


def timed(job: Callable[[], Any], repeats: int) -> list[float]:
    """Seconds of each run."""
    times = []
    for _ in range(repeats):
        began = time.perf_counter()
        job()
        times.append(time.perf_counter() - began)
    return times


def run_benchmark(*, seconds: float, steps: int, repeats: int, browser: bool = False) -> dict[str, Any]:
    """Times loading, text, sampling and finishing of the default model, beside the plain run.

    Args:
        seconds: length of the motion; 10 is 300 frames.
        steps: DDIM steps.
        repeats: pairs of runs; medians are reported.
        browser: also measure the page and the player in a headless Chromium.

    Returns:
        the figures by name, which are also printed.
    """
    from models.intergen.compact import load_folder
    from models.threads import CORES
    from webdemo.benchmark.batching import BATCHED_GOAL, measure_batching
    from webdemo.benchmark.parts import measure_busy, measure_parts
    from webdemo.benchmark.reactions import measure_reactions
    from webdemo.inference.engine import Engine
    from webdemo.inference.requests import GenerateRequest

    engine = Engine()
    (load,) = timed(engine.warm_up, 1)
    request = GenerateRequest(
        prompt="Two people walk up to each other and shake hands.", seconds=seconds, steps=steps, split=False
    )
    pipeline: Any = engine.pipeline(request.model)
    by_torch = load_folder(engine.weights / request.model)[0].denoiser
    figures: dict[str, Any] = {
        "threads": CORES,
        "compiled": pipeline.compiled,
        "frames": round(seconds * 30),
        "steps": steps,
        "load_seconds": load,
    }
    figures |= measure_requests(engine, request, by_torch, repeats)
    figures |= measure_parts(engine, request, by_torch, repeats)
    figures |= measure_busy(lambda: list(engine.run(request)), figures["request_seconds"], repeats)
    figures |= measure_classes(replace(request, damping=0.0), repeats)
    figures |= measure_prediction(max(repeats, 5))
    figures |= measure_reactions(repeats)
    figures |= measure_batching(steps=steps, repeats=repeats)
    figures["batched_over_serial_throughput_goal"] = BATCHED_GOAL
    if browser:
        from webdemo.benchmark.browser import measure_browser

        figures |= measure_browser()
    figures = {k: float(f"{v:.4g}") if isinstance(v, float) else v for k, v in figures.items()}
    for name, value in figures.items():
        print(f"{name:34} {value}")
    return figures


def measure_requests(engine: Any, request: Any, by_torch: Any, repeats: int) -> dict[str, Any]:
    """Seconds of a request, of the same without damping and with four samples, and those of the plain run.

    Args:
        engine: has the model.
        request: of the default model.
        by_torch: its denoiser, run by PyTorch.
        repeats: pairs of runs; medians are reported.
    """
    from webdemo.benchmark.parts import REQUEST_GOAL, UNDAMPED_GOAL
    from webdemo.benchmark.plain import PlainSampler
    from webdemo.inference.run import Result

    plain = PlainSampler(by_torch, engine.pipeline(request.model), request)
    whole, stages, plainly = [], [], []
    for _ in range(repeats):
        began = time.perf_counter()
        *_, result = engine.run(request)
        assert isinstance(result, Result)  # the last event of a run
        whole.append(time.perf_counter() - began)
        stages.append(result.timings)
        plainly.extend(timed(plain.run, 1))
    middle = {name: statistics.median(s.get(name, 0.0) for s in stages) for name in stages[0]}
    bare = replace(request, damping=0.0)
    undamped = timed(lambda: list(engine.run(bare)), repeats)
    (four,) = timed(lambda: list(engine.run(replace(bare, samples=4))), 1)
    return {
        "request_seconds": statistics.median(whole),
        "request_seconds_all": whole,
        "request_seconds_goal": REQUEST_GOAL,
        "sample_seconds": middle["sample"],
        "finish_seconds": middle["finish"],
        "undamped_request_seconds": statistics.median(undamped),
        "undamped_request_seconds_goal": UNDAMPED_GOAL,
        "plain_sample_seconds": statistics.median(plainly),
        "plain_over_request": statistics.median(p / w for p, w in zip(plainly, whole, strict=True)),
        "plain_over_undamped": statistics.median(plainly) / statistics.median(undamped),
        "four_samples_over_one": four / statistics.median(undamped),
    }


def measure_classes(request: Any, repeats: int) -> dict[str, float]:
    """Seconds of a class, and over those of a sentence of the same length and steps, run in turn."""
    from webdemo.inference.engine import Engine
    from webdemo.inference.methods import methods

    engine = Engine()
    by_class = next(found.name for found in methods("generate") if "class" in found.takes)
    classed = replace(request, prompt="shake hands", model=by_class)
    jobs = [partial(lambda asked: list(engine.run(asked)), asked) for asked in (classed, request)]
    for job in jobs:  # the first runs prepare what later ones use
        job()
    pairs = [[timed(job, 1)[0] for job in jobs] for _ in range(repeats)]
    return {
        "class_request_seconds": statistics.median(own for own, _ in pairs),
        "class_over_sentence": statistics.median(own / other for own, other in pairs),
    }


def measure_prediction(repeats: int) -> dict[str, float]:
    """Of each predictor, milliseconds that two people's next 25 frames take, and seconds for four seconds by
    recursion; and milliseconds that the virtual agent takes for all its looks at five seconds of a person."""
    import numpy as np

    from motion import FPS, SMPL22, Duet
    from webdemo.inference import PredictRequest
    from webdemo.inference.engine.engine import Engine
    from webdemo.inference.methods import methods

    sway = 0.05 * np.sin(np.arange(150) / 5)[:, None, None] * SMPL22.rest_positions()
    moving = SMPL22.rest_positions() + sway
    past, seeds = Duet.from_positions(np.stack([moving[:30]] * 2), fps=FPS), count()
    figures = {}
    engine = Engine()

    def predict(model: str, frames: int) -> None:
        asked = PredictRequest(motion=past, seconds=frames / FPS, seed=next(seeds), model=model)
        for _ in engine.run(asked):
            pass

    for i, found in enumerate(m for m in methods("predict") if m.weights):
        label = found.name if i else "predict"
        predict(found.name, 25)
        short, long = (timed(partial(predict, found.name, n), repeats) for n in (25, 120))
        figures[f"{label}_25_frames_ms"] = 1000 * statistics.median(short)
        figures[f"{label}_four_seconds"] = statistics.median(long)
    agent: Any = engine.pipeline("agent")
    eye = agent.eye
    eye.looks(moving)
    figures["agent_looks_ms"] = 1000 * statistics.median(timed(partial(eye.looks, moving), repeats))
    return figures
