"""Two people from one sentence or a class, or one for a given other."""

from __future__ import annotations

import time
from abc import ABC, abstractmethod
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Generic, TypeVar

import numpy as np
import torch
from torch import Tensor

from models.compact import CaptionBank, CompactInterGen, Touch, WeightsFolder
from models.compact_bigraphdiff import CompactBiGraphDiff, load_folder
from models.diffusion import TRAIN_TIMESTEPS, make_scheduler, sample_steps
from models.text import MiniLM
from webdemo.metrics import compare
from webdemo.motion import Duet, InputError

from .cancel import CancelToken
from .cleanup import clean_person
from .damping import Damping
from .requests import GenerateRequest, Progress, ReactRequest, Result
from .scenes import Finish, Scene, scene_of


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


Network = TypeVar("Network", CompactInterGen, CompactBiGraphDiff)


@dataclass(frozen=True)
class Told:
    """What a network is told of a request.

    Attributes:
        condition: (1, C) its vector; zeros tell nothing.
        guidance: scale of classifier-free guidance.
        touch: which joints should come together.
        notes: sentences the user should read.
    """

    condition: Tensor
    guidance: float
    touch: Touch = ()
    notes: tuple[str, ...] = ()


class TwoPersonGenerator(ABC, Generic[Network]):
    """Denoises two people by the network of a weights folder; a subclass says what it is told.

    Args:
        source: the folder.
        model: its network.
    """

    def __init__(self, source: WeightsFolder, model: Network) -> None:
        self.name, self.digest, self.meta = source.folder.name, source.digest, source.meta
        self.model = model

    @abstractmethod
    def told(self, request: GenerateRequest | ReactRequest) -> Told:
        """What the network is told of a request."""

    def damp(self, damping: Damping, x0: Tensor, timestep: int) -> Tensor:
        """A prediction corrected by its damping; requests that share passes do this together, too."""
        return damping(x0, timestep)

    def run(
        self, request: GenerateRequest | ReactRequest, cancel: CancelToken, clock: Clock
    ) -> Iterator[Progress | Result]:
        """Progress events, then one :class:`Result` without a manifest; raises Cancelled within one step."""
        now = time.perf_counter()
        yield clock.progress("text")
        told = self.told(request)
        condition = told.condition.expand(request.samples, -1)
        scene = scene_of(request, self.model)
        now = clock.lap("text", now)

        layout, given = self.model.layout, scene.given
        noise = sample_noise(
            request.seed, request.samples, (layout.num_tokens(scene.frames), 2 * layout.token_features)
        )
        scheduler = make_scheduler(request.sampler, request.steps, spacing="top")
        damping = Damping(
            self.model,
            request.damping,
            frames=scene.frames,
            timesteps=TRAIN_TIMESTEPS,
            final_timestep=int(scheduler.timesteps[-1]),
            frozen=None if given is None else given.mask,
            touches=(told.touch,) * request.samples,
        )
        uncorrected = noise

        # What is given is clean at every timestep, as in training (InterGen, section 5.4).
        def correct(x0: Tensor, timestep: int) -> Tensor:
            nonlocal uncorrected
            uncorrected = x0 if given is None else given.hold(x0)
            return self.damp(damping, uncorrected, timestep)

        def predict(x: Tensor, t: Tensor) -> Tensor:
            x = x if given is None else given.hold(x)
            return self.model.denoiser.guided(x, t, condition, scale=told.guidance)

        cancel.raise_if_cancelled()
        sample = noise
        for step in sample_steps(predict, noise, scheduler, correct=correct):
            sample = step.sample
            yield clock.progress("sample", step.step, step.total)
            cancel.raise_if_cancelled()
        now = clock.lap("sample", now)

        yield clock.progress("finish")
        before = self._duets(uncorrected, scene, _as_is)
        duets = self._duets(sample, scene, clean_person if request.cleanup else _as_is)
        readouts = tuple(compare(raw, duet) for raw, duet in zip(before, duets, strict=True))
        clock.lap("finish", now)
        yield Result(
            duets=duets,
            manifest={},
            readouts=readouts,
            timings={**clock.stages, "total": round(clock.elapsed, 4)},
            notes=told.notes,
        )

    def _duets(self, x: Tensor, scene: Scene, finish: Finish) -> tuple[Duet, ...]:
        with torch.no_grad():
            positions = self.model.positions(x)[0][:, :, : scene.frames].numpy()
        if not np.isfinite(positions).all():
            raise InputError("The motion ran away to infinity: lower the guidance scale or take more steps.")
        return tuple(scene.duet(pair, finish) for pair in positions)


class DuetGenerator(TwoPersonGenerator[CompactInterGen]):
    """The compact InterGen with its text encoder, loaded from a weights folder.

    Raises WeightsError or TextEncoderError (both InputError) where files are missing or altered.
    """

    def __init__(self, folder: Path) -> None:
        source = WeightsFolder(folder)
        super().__init__(source, source.model())
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

    def told(self, request: GenerateRequest | ReactRequest) -> Told:
        """The words' vector, and what they want to touch; nothing where there are no words."""
        if not request.prompt.strip():  # without an intent both halves of the guidance are the same
            return Told(torch.zeros(1, self.model.config.cond_dim), 1.0)
        condition, vector = self.condition(request.prompt)
        (touch,) = self.model.touches(condition)
        return Told(condition, request.guidance, touch, self.notes(vector))


class ClassGenerator(TwoPersonGenerator[CompactBiGraphDiff]):
    """The compact BiGraphDiff, for which a request's prompt is the name of a class.

    Raises WeightsError (an InputError) where files are missing or altered.
    """

    def __init__(self, folder: Path) -> None:
        model, source = load_folder(folder)
        super().__init__(source, model)

    def told(self, request: GenerateRequest | ReactRequest) -> Told:
        """The class' vector and touch; raises InputError for a class that is not known."""
        labels = self.model.config.labels
        known = {label.casefold(): label for label in labels}
        label = known.get(" ".join(request.prompt.split()).casefold())
        if label is None:
            raise InputError(
                f"There is no class {request.prompt.strip()!r:.60}: choose one of: {'; '.join(labels)}."
            )
        with torch.no_grad():
            condition = self.model.condition([label])
        return Told(condition, request.guidance, self.model.touches(label))


def _as_is(person: np.ndarray) -> np.ndarray:
    return person
