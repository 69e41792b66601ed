"""Speed on this machine, as figures and as ratios to a plain run of the same network.

``python -m webdemo benchmark`` prints one line a figure. Absolute times depend on the machine and what else it does;
the ratios are of runs that alternate within one call and hold anywhere.
"""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from itertools import count
from typing import Any, cast

import numpy as np
import torch
from torch import Tensor

from models.diffusion import denoise, guide, make_scheduler
from models.diffusion.sampling import sample_noise
from models.intergen.compact import load_folder
from models.intergen.network import Block, InterGenDenoiser
from models.intergen.words import WordBlock, WordDenoiser
from models.layers import sinusoids
from models.threads import CORES
from motion import FPS, SMPL22, Clip, Duet
from webdemo.inference.engine import Engine
from webdemo.inference.engine.batch import run_batch
from webdemo.inference.methods import methods
from webdemo.inference.requests import GenerateRequest, ReactRequest
from webdemo.inference.requests.predict import PredictRequest
from webdemo.inference.run import CancelToken, Result

from . import PROMPTS

REQUEST_GOAL, UNDAMPED_GOAL = 2.0, 1.5
"""Seconds of a request of 10 s of motion and 50 steps on two cores, with damping and without."""
FRAME_GOAL_MS = 4.0
"""Milliseconds of a frame of ReGenNet online."""
SHARED_GOAL = 1.8
"""Throughput of eight requests that share passes, over that of the same in turn."""


def run_speed(*, seconds: float, steps: int, repeats: int) -> dict[str, Any]:
    """Times the shipped methods, and the default one beside the plain run of its network.

    Args:
        seconds: length of the motion; 10 is 300 frames.
        steps: DDIM steps.
        repeats: pairs of runs; medians are reported.

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
        **measure_sharing(engine, replace(request, seconds=min(seconds, 4.0)), repeats),
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
    """Seconds of a request with its stages, of the same without damping and with four samples, and of the plain run."""
    by_torch = load_folder(engine.weights / request.model)[0].denoiser
    plain = PlainSampler(by_torch, engine.pipeline(request.model), request)
    whole, stages, plainly = [], [], []
    for _ in range(repeats):
        began = time.perf_counter()
        *_, result = engine.run(request)
        whole.append(time.perf_counter() - began)
        stages.append(result.timings)
        plainly += timed(plain.run, 1)
    bare = replace(request, damping=0.0)
    undamped = timed(lambda: list(engine.run(bare)), repeats)
    (four,) = timed(lambda: list(engine.run(replace(bare, samples=4))), 1)
    return {
        "request_seconds": statistics.median(whole),
        "request_seconds_goal": REQUEST_GOAL,
        **{f"{name}_seconds": statistics.median(s.get(name, 0.0) for s in stages) for name in stages[0]},
        "undamped_request_seconds": statistics.median(undamped),
        "undamped_request_seconds_goal": UNDAMPED_GOAL,
        "plain_sample_seconds": statistics.median(plainly),
        "plain_over_request": statistics.median(p / w for p, w in zip(plainly, whole, strict=True)),
        "plain_over_undamped": statistics.median(plainly) / statistics.median(undamped),
        "four_samples_over_one": four / statistics.median(undamped),
    }


def measure_classes(engine: Any, request: GenerateRequest, repeats: int) -> dict[str, float]:
    """Seconds of a class, and over those of a sentence of the same length and steps, run in turn."""
    by_class = next(found.name for found in methods("generate") if "class" in found.takes)
    classed = replace(request, prompt="shake hands", model=by_class)
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
    for found in (m for m in methods("predict") if m.weights):
        predict(found.name)
        figures[f"predict_ms_{found.name}"] = 1000 * statistics.median(timed(partial(predict, found.name), repeats))
    return figures


def measure_reaction(engine: Any, seconds: float) -> dict[str, float]:
    """Milliseconds from an actor's frame to that of ReGenNet online, bones and feet included."""
    rest = SMPL22.rest_positions()
    still = Clip(np.repeat(rest[None] - [0, rest[:, 1].min(), 0], round(seconds * FPS), axis=0), FPS, SMPL22)
    asked = ReactRequest(actor=still, model="regennet", mode="online", steps=5)
    list(engine.live(asked))  # the first run loads what later ones use
    times = [frame.seconds for frame in engine.live(asked)]
    return {
        "reaction_frame_ms": 1000 * statistics.mean(times),
        "reaction_frame_ms_longest": 1000 * max(times[4:]),
        "reaction_frame_ms_goal": FRAME_GOAL_MS,
    }


def measure_sharing(engine: Any, request: GenerateRequest, repeats: int) -> dict[str, float]:
    """Throughput of eight requests that share passes over that of the same in turn, and how far the motions differ."""
    asked = [replace(request, prompt=PROMPTS[i % len(PROMPTS)], seed=i) for i in range(8)]
    alone: list[Result] = []
    together: dict[int, Result] = {}

    def in_turn() -> None:
        alone[:] = [event for r in asked for event in engine.run(r) if isinstance(event, Result)]

    def at_once() -> None:
        events = run_batch(engine, [(r, CancelToken()) for r in asked])
        together.update((i, event) for i, event in events if isinstance(event, Result))

    pairs = [(timed(in_turn, 1)[0], timed(at_once, 1)[0]) for _ in range(repeats)]
    apart = [
        np.abs(np.asarray(together[i].duets[0].positions) - result.duets[0].positions).max()
        for i, result in enumerate(alone)
    ]
    return {
        "shared_over_serial_throughput": statistics.median(serial / shared for serial, shared in pairs),
        "shared_over_serial_throughput_goal": SHARED_GOAL,
        "shared_largest_difference_mm": 1000 * float(max(apart)),
    }


class PlainSampler:
    """The same network, sampled without batching or caching, in float32.

    Each person and each guidance half is a pass of its own through ``torch.nn.MultiheadAttention``, and the
    prompt is encoded anew at every step: how the papers' equations read, and what the ratios are against.
    """

    def __init__(self, denoiser: InterGenDenoiser, pipeline: Any, request: Any) -> None:
        self.denoiser, self.pipeline, self.request = denoiser, pipeline, request

    def run(self) -> Tensor:
        """Samples one motion; returns it in network space."""
        request, model = self.request, self.pipeline.model
        tokens = model.layout.num_tokens(round(request.seconds * 30))
        noise = sample_noise(request.seed, 1, (tokens, 2 * model.layout.token_features))

        def predict(x: Tensor, t: Tensor) -> Tensor:
            condition, _ = self.pipeline.condition(request.prompt)
            nothing = torch.zeros_like(condition)
            return guide(self.forward(x, t, condition), self.forward(x, t, nothing), request.guidance)

        return denoise(predict, noise, make_scheduler("ddim", request.steps, spacing="top"))

    def forward(self, x: Tensor, t: Tensor, condition: Tensor) -> Tensor:
        """InterGen's denoiser, with or without words, one person at a time: (1, T, 2F) → (1, T, 2F)."""
        net = self.denoiser
        words = net.text_of_each(condition) if isinstance(net, WordDenoiser) else None
        embs = net.embed(t, condition).expand(2, 1, -1)[:, None]
        roles = net.role_embedding if net.config.role_embedding else (0.0, 0.0)
        states = [
            net.motion_embed(person) + sinusoids(x.shape[1], net.config.latent_dim) + role
            for person, role in zip(x.chunk(2, dim=-1), roles, strict=True)
        ]
        for block in cast(list[Block], net.blocks):
            before, after = states, []
            for i, (h, emb) in enumerate(zip(before, embs, strict=True)):
                query = block.sa_block.norm(h[None], emb)[0]
                h = h + _attention(block.sa_block.attention, query, query)
                if words is not None:
                    text, real = (rows[i : i + 1] for rows in words)
                    h = h + cast(WordBlock, block).words(h[None], text, real)[0]
                query = block.ca_block.norm(h[None], emb)[0]
                other = block.ca_block.xf_norm(before[1 - i][None], emb)[0]
                h = h + _attention(block.ca_block.attention, query, other)
                after.append(h + block.ffn(h[None], emb)[0])
            states = after
        return torch.cat([net.out(h[None])[0] for h in states], dim=-1)


def _attention(module: torch.nn.MultiheadAttention, query: Tensor, source: Tensor) -> Tensor:
    """The module's weights in PyTorch's own multi-head attention."""
    return torch.nn.MultiheadAttention.forward(module, query, source, source, need_weights=False)[0]
