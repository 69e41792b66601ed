"""Two people from one sentence by the compact InterGen."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from torch import Tensor

from models.compact import CaptionBank, CompactInterGen, WeightsFolder
from models.diffusion import TRAIN_TIMESTEPS, make_scheduler, sample_steps
from models.text import MiniLM
from webdemo.metrics import compare
from webdemo.motion import Duet, InputError

from .cancel import CancelToken
from .cleanup import clean_person
from .damping import Damping
from .requests import GenerateRequest, Progress, Result

FPS = 30.0


def sample_noise(seed: int, samples: int, shape: tuple[int, ...]) -> Tensor:
    """(samples, *shape) noise; a sample's noise depends on the seed and its number alone."""
    rows = []
    for sample in range(samples):
        state = int(np.random.SeedSequence([seed, sample]).generate_state(1, np.uint64)[0])
        rows.append(torch.randn(shape, generator=torch.Generator().manual_seed(state)))
    return torch.stack(rows)


@dataclass
class Clock:
    """Seconds since a run began, and by stage."""

    began: float
    stages: dict[str, float]

    @classmethod
    def start(cls) -> Clock:
        return cls(time.perf_counter(), {})

    @property
    def elapsed(self) -> float:
        return time.perf_counter() - self.began

    def progress(self, stage: str, step: int = 0, total: int = 1) -> Progress:
        return Progress(stage=stage, step=step, total=total, elapsed=self.elapsed)

    def lap(self, stage: str, since: float) -> float:
        """Books the time since ``since`` on a stage; returns now."""
        now = time.perf_counter()
        self.stages[stage] = round(self.stages.get(stage, 0.0) + now - since, 4)
        return now


class TextToDuet:
    """The compact InterGen with its text encoder, loaded from a weights folder.

    Raises WeightsError or TextEncoderError (both InputError) where files are missing or altered.
    """

    def __init__(self, folder: Path) -> None:
        source = WeightsFolder(folder)
        self.name, self.digest, self.meta = folder.name, source.digest, source.meta
        self.model: CompactInterGen = source.model()
        self.bank: CaptionBank = source.captions()
        self.encoder = MiniLM()

    def condition(self, prompt: str) -> tuple[Tensor, Tensor]:
        """The condition vector (1, C) of a prompt and its unit sentence vector (384,)."""
        tokens = self.encoder([prompt])
        with torch.no_grad():
            return self.model.conditioner(tokens.features, tokens.mask), tokens.pooled()[0]

    def notes(self, vector: Tensor) -> tuple[str, ...]:
        """What the user should know of a prompt: that it is far from all that was trained on."""
        near = self.bank.nearest(vector)
        if near[0][0] >= self.bank.far:
            return ()
        return (
            "This sentence is far from anything the model was trained on, so the motion may not match it. "
            f"The nearest thing it knows: “{near[0][1]}”.",
        )

    def run(self, request: GenerateRequest, cancel: CancelToken, clock: Clock) -> Iterator[Progress | Result]:
        """Progress events, then one :class:`Result` without a manifest; raises Cancelled within one step."""
        now = time.perf_counter()
        yield clock.progress("text")
        condition, vector = self.condition(request.prompt)
        now = clock.lap("text", now)

        frames = round(request.seconds * FPS)
        layout = self.model.layout
        tokens = layout.num_tokens(frames)
        noise = sample_noise(request.seed, request.samples, (tokens, 2 * layout.token_features))
        condition = condition.expand(request.samples, -1)
        scheduler = make_scheduler(request.sampler, request.steps)
        damping = Damping(
            self.model,
            request.damping,
            frames=frames,
            timesteps=TRAIN_TIMESTEPS,
            final_timestep=int(scheduler.timesteps[-1]),
        )
        uncorrected = noise

        def correct(x0: Tensor, timestep: int) -> Tensor:
            nonlocal uncorrected
            uncorrected = x0
            return damping(x0, timestep)

        def predict(x: Tensor, t: Tensor) -> Tensor:
            return self.model.denoiser.guided(x, t, condition, scale=request.guidance)

        cancel.raise_if_cancelled()
        sample = noise
        for step in sample_steps(predict, noise, scheduler, correct=correct):
            sample = step.sample
            yield clock.progress("sample", step.step, step.total)
            cancel.raise_if_cancelled()
        now = clock.lap("sample", now)

        yield clock.progress("finish")
        before = self._duets(uncorrected, frames, lambda person: person)
        duets = self._duets(sample, frames, clean_person if request.cleanup else lambda person: person)
        readouts = tuple(compare(raw, duet) for raw, duet in zip(before, duets, strict=True))
        clock.lap("finish", now)
        yield Result(
            duets=duets,
            manifest={},
            readouts=readouts,
            timings={**clock.stages, "total": round(clock.elapsed, 4)},
            notes=self.notes(vector),
        )

    def _duets(self, x: Tensor, frames: int, finish: Callable[[np.ndarray], np.ndarray]) -> tuple[Duet, ...]:
        with torch.no_grad():
            positions = self.model.positions(x)[0][:, :, :frames].numpy()
        if not np.isfinite(positions).all():
            raise InputError("The motion ran away to infinity: lower the guidance scale or take more steps.")
        return tuple(
            Duet.from_positions(
                np.stack([finish(person) for person in pair]), fps=FPS, roles=("actor", "reactor")
            )
            for pair in positions
        )
