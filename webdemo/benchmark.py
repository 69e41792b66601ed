"""Speed on this machine, as figures and as ratios to a plain run of the same network.

``python -m webdemo benchmark`` prints one line a figure. Absolute times depend on the machine and what else
it does; the ratios are of runs that alternate within one call and hold anywhere.
"""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable
from functools import partial
from typing import Any

GOAL_SECONDS = 4.0


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
    """
    import torch

    from webdemo.benchmark_interformer import measure_interformer
    from webdemo.benchmark_reactions import measure_reactions
    from webdemo.inference.engine import Engine
    from webdemo.inference.requests import GenerateRequest

    engine = Engine()
    (load,) = timed(engine.warm_up, 1)
    request = GenerateRequest(
        prompt="Two people walk up to each other and shake hands.", seconds=seconds, steps=steps
    )
    plain = PlainSampler(engine, request)
    whole, stages, plainly = [], [], []
    for _ in range(repeats):
        began = time.perf_counter()
        *_, result = engine.run(request)
        whole.append(time.perf_counter() - began)
        stages.append(result.timings)
        plainly.extend(timed(plain.run, 1))
    middle = {name: statistics.median(s.get(name, 0.0) for s in stages) for name in stages[0]}
    bare = _replace(request, damping=0.0)
    undamped = timed(lambda: list(engine.run(bare)), repeats)
    four = timed(lambda: list(engine.run(_replace(bare, samples=4))), 1)[0]
    figures: dict[str, Any] = {
        "threads": torch.get_num_threads(),
        "frames": round(seconds * 30),
        "steps": steps,
        "load_seconds": load,
        "request_seconds": statistics.median(whole),
        "request_seconds_all": whole,
        "request_seconds_goal": GOAL_SECONDS,
        "sample_seconds": middle["sample"],
        "finish_seconds": middle["finish"],
        "undamped_request_seconds": statistics.median(undamped),
        "plain_sample_seconds": statistics.median(plainly),
        "plain_over_request": statistics.median(p / w for p, w in zip(plainly, whole, strict=True)),
        "plain_over_undamped": statistics.median(plainly) / statistics.median(undamped),
        "four_samples_over_one": four / statistics.median(undamped),
    }
    figures |= measure_classes(bare, repeats)
    figures |= measure_prediction(max(repeats, 5))
    figures |= measure_reactions(repeats)
    figures |= measure_interformer(max(repeats, 3))
    if browser:
        from webdemo.benchmark_browser import measure_browser

        figures |= measure_browser()
    figures = {k: round(v, 3) if isinstance(v, float) else v for k, v in figures.items()}
    for name, value in figures.items():
        print(f"{name:28} {value}")
    return figures


def measure_classes(request: Any, repeats: int) -> dict[str, float]:
    """Seconds of a class, and over those of a sentence of the same length and steps, run in turn."""
    from webdemo.inference.cancel import CancelToken
    from webdemo.inference.engine import GENERATORS, WEIGHTS
    from webdemo.inference.generator import Clock

    def run(asked: Any, generator: Any) -> None:
        list(generator.run(asked, CancelToken(), Clock.start()))

    classed = _replace(request, prompt="shake hands", model="bigraphdiff")
    jobs = [
        partial(run, asked, GENERATORS[asked.model](WEIGHTS / asked.model)) for asked in (classed, request)
    ]
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

    from webdemo.inference.agent import Eye
    from webdemo.inference.engine import WEIGHTS
    from webdemo.inference.predict import MotionPredictor
    from webdemo.motion import SMPL22

    sway = 0.05 * np.sin(np.arange(150) / 5)[:, None, None] * SMPL22.rest_positions()
    moving = SMPL22.rest_positions() + sway
    past = np.stack([moving[:30]] * 2)
    figures = {}
    for name, label in (("motion-mlp", "predict"), ("mawgan", "mawgan")):
        predictor = MotionPredictor(WEIGHTS / name)
        predictor.predict(past, 25)
        short, long = (timed(partial(predictor.predict, past, n), repeats) for n in (25, 120))
        figures[f"{label}_25_frames_ms"] = 1000 * statistics.median(short)
        figures[f"{label}_four_seconds"] = statistics.median(long)
    eye = Eye(WEIGHTS / "agent", MotionPredictor(WEIGHTS / "motion-mlp"))
    eye.looks(moving)
    figures["agent_looks_ms"] = 1000 * statistics.median(timed(partial(eye.looks, moving), repeats))
    return figures


def _replace(request: Any, **changes: Any) -> Any:
    from dataclasses import replace

    return replace(request, **changes)


class PlainSampler:
    """The same network, sampled without batching or caching, in float32.

    Each person and each guidance half is a pass of its own through ``torch.nn.MultiheadAttention``, and the
    prompt is encoded anew at every step: how the papers' equations read, and what the ratios are against.
    """

    def __init__(self, engine: Any, request: Any) -> None:
        self.generator, self.request = engine._generator(request.model), request

    def run(self) -> Any:
        """Samples one motion; returns it in network space."""
        import torch

        from models.diffusion import make_scheduler
        from webdemo.inference.generator import sample_noise

        request, model = self.request, self.generator.model
        tokens = model.layout.num_tokens(round(request.seconds * 30))
        x = sample_noise(request.seed, 1, (tokens, 2 * model.layout.token_features))
        scheduler = make_scheduler("ddim", request.steps, spacing="top")
        with torch.no_grad():
            for t in scheduler.timesteps:
                condition, _ = self.generator.condition(request.prompt)
                conditional = self.forward(x, t.expand(1), condition)
                unconditional = self.forward(x, t.expand(1), torch.zeros_like(condition))
                s = request.guidance
                x = scheduler.step(s * conditional + (1 - s) * unconditional, t, x).prev_sample
        return x

    def forward(self, x: Any, t: Any, condition: Any) -> Any:
        """InterGen's denoiser, one person at a time: (1, T, 2F) → (1, T, 2F)."""
        import torch

        from models.layers import sinusoids

        net = self.generator.model.denoiser
        embs = net.embed(t, condition).expand(2, 1, -1)[:, None]
        states = [
            net.motion_embed(person) + sinusoids(x.shape[1], net.config.latent_dim) + net.role_embedding[i]
            for i, person in enumerate(x.chunk(2, dim=-1))
        ]
        for block in net.blocks:
            before, after = states, []
            for i, (h, emb) in enumerate(zip(before, embs, strict=True)):
                query = block.sa_block.norm(h[None], emb)[0]
                h = h + _attention(block.sa_block.attention, query, query)
                query = block.ca_block.norm(h[None], emb)[0]
                other = block.ca_block.xf_norm(before[1 - i][None], emb)[0]
                h = h + _attention(block.ca_block.attention, query, other)
                after.append(h + block.ffn(h[None], emb)[0])
            states = after
        return torch.cat([net.out(h[None])[0] for h in states], dim=-1)


def _attention(module: Any, query: Any, source: Any) -> Any:
    """The module's weights in PyTorch's own multi-head attention."""
    import torch

    return torch.nn.MultiheadAttention.forward(module, query, source, source, need_weights=False)[0]
