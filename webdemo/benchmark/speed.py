"""Speed on this machine: ``python -m webdemo benchmark`` prints one line a figure.

The times depend on the machine and what else it does.
"""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from itertools import count
from typing import Any

import numpy as np

from models.compiled import CORES
from motion import FPS, SMPL22, Clip, Duet
from webdemo.inference.engine import Engine
from webdemo.inference.methods import by_class, methods
from webdemo.inference.requests import GenerateRequest, ReactRequest
from webdemo.inference.requests.predict import PredictRequest

from . import PROMPTS

REQUEST_GOAL, UNDAMPED_GOAL = 2.0, 1.5
"""Seconds of a request of 10 s of motion and 50 steps on two cores, with damping and without."""
FRAME_GOAL_MS = 4.0
"""Milliseconds of a frame of ReGenNet online."""


def run_speed(*, seconds: float, steps: int, repeats: int) -> dict[str, Any]:
    """Times the shipped methods.

    Args:
        seconds: length of the motion; 10 is 300 frames.
        steps: DDIM steps.
        repeats: of each run; medians are reported.

    Returns:
        the figures by name.
    """
    engine = Engine()
    (load,) = timed(engine.warm_up, 1)
    request = GenerateRequest(prompt=PROMPTS[0], seconds=seconds, steps=steps, split=False)
    pipeline: Any = engine.pipeline(request.model)
    return {
        "threads": CORES,
        "compiled": pipeline.compiled,
        "frames": round(seconds * FPS),
        "steps": steps,
        "load_seconds": load,
        **measure_requests(engine, request, repeats),
        **measure_classes(engine, replace(request, damping=0.0), repeats),
        **measure_prediction(engine, repeats),
        **measure_reaction(engine, seconds),
    }


def timed(job: Callable[[], Any], repeats: int) -> list[float]:
    """Seconds of each run."""
    times = []
    for _ in range(repeats):
        began = time.perf_counter()
        job()
        times.append(time.perf_counter() - began)
    return times


def measure_requests(engine: Any, request: GenerateRequest, repeats: int) -> dict[str, float]:
    """Seconds of a request with its stages, and of the same without damping and with four samples."""
    whole, stages = [], []
    for _ in range(repeats):
        began = time.perf_counter()
        *_, result = engine.run(request)
        whole.append(time.perf_counter() - began)
        stages.append(result.timings)
    bare = replace(request, damping=0.0)
    undamped = timed(lambda: list(engine.run(bare)), repeats)
    (four,) = timed(lambda: list(engine.run(replace(bare, samples=4))), 1)
    return {
        "request_seconds": statistics.median(whole),
        "request_seconds_goal": REQUEST_GOAL,
        **{f"{name}_seconds": statistics.median(s.get(name, 0.0) for s in stages) for name in stages[0]},
        "undamped_request_seconds": statistics.median(undamped),
        "undamped_request_seconds_goal": UNDAMPED_GOAL,
        "four_samples_over_one": four / statistics.median(undamped),
    }


def measure_classes(engine: Any, request: GenerateRequest, repeats: int) -> dict[str, float]:
    """Seconds of a class, and over those of a sentence of the same length and steps, run in turn."""
    classed = replace(request, prompt="shake hands", model=by_class().name)
    jobs = [partial(lambda asked: list(engine.run(asked)), asked) for asked in (classed, request)]
    jobs[0]()  # the first run prepares what later ones use
    pairs = [[timed(job, 1)[0] for job in jobs] for _ in range(repeats)]
    return {
        "class_request_seconds": statistics.median(own for own, _ in pairs),
        "class_over_sentence": statistics.median(own / other for own, other in pairs),
    }


def measure_prediction(engine: Any, repeats: int) -> dict[str, float]:
    """Milliseconds of two people's next 25 frames by each predictor."""
    sway = 0.05 * np.sin(np.arange(30) / 5)[:, None, None] * SMPL22.rest_positions()
    past, seeds = Duet.from_positions(np.stack([SMPL22.rest_positions() + sway] * 2), fps=FPS), count()

    def predict(model: str) -> None:
        list(engine.run(PredictRequest(motion=past, seconds=25 / FPS, seed=next(seeds), model=model)))

    figures = {}
    for each in (m for m in methods("predict") if m.weights):
        predict(each.name)
        figures[f"predict_ms_{each.name}"] = 1000 * statistics.median(timed(partial(predict, each.name), repeats))
    return figures


def measure_reaction(engine: Any, seconds: float) -> dict[str, float]:
    """Milliseconds from an actor's frame to that of ReGenNet online, bones and feet included."""
    still = Clip(np.repeat(SMPL22.standing()[None], round(seconds * FPS), axis=0), FPS, SMPL22)
    asked = ReactRequest(actor=still, model="regennet", mode="online", steps=5)
    list(engine.run(asked))  # the first run loads what later ones use
    *_, result = engine.run(asked)
    return {
        "reaction_frame_ms": 1000 * result.timings["delay of a frame, mean"],
        "reaction_frame_ms_longest": 1000 * result.timings["delay of a frame, longest"],
        "reaction_frame_ms_goal": FRAME_GOAL_MS,
    }
