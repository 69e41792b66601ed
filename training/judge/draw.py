"""Duets of many sentences at once: several of one length share a network pass."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
import torch

from models.compact import CompactInterGen
from models.diffusion import TRAIN_TIMESTEPS, make_scheduler, sample_steps
from webdemo.inference.cleanup import clean_person
from webdemo.inference.damping import Damping
from webdemo.inference.generator import sample_noise
from webdemo.motion import Duet, InputError

from .rules import Task

BATCH = 12
LENGTH_STEP = 30


@dataclass(frozen=True, kw_only=True)
class Sampling:
    """How the duets are drawn; the names are those of :class:`webdemo.inference.GenerateRequest`."""

    seed: int = 0
    steps: int = 25
    guidance: float = 4.3
    damping: float = 0.7


def batches(tasks: Sequence[Task], *, size: int = BATCH, seed: int = 0) -> list[list[int]]:
    """Which tasks share a pass: of one length (to the next whole second), in an order drawn by ``seed``.

    The order is mixed so that a run that is stopped early has seen all lengths.
    """
    by_length: dict[int, list[int]] = defaultdict(list)
    for i, task in enumerate(tasks):
        by_length[_frames(task)].append(i)
    groups = [group[k : k + size] for group in by_length.values() for k in range(0, len(group), size)]
    return [groups[i] for i in np.random.default_rng(seed).permutation(len(groups))]


def _frames(task: Task) -> int:
    """The length that is asked for: the scene's, to the next whole second and at most ten."""
    return int(np.clip(LENGTH_STEP * round(task.frames / LENGTH_STEP), LENGTH_STEP, 300))


class Generator(Protocol):
    """What is needed of :class:`webdemo.inference.generator.DuetGenerator`."""

    model: CompactInterGen

    def condition(self, prompt: str) -> tuple[torch.Tensor, torch.Tensor]:
        """The condition vector (1, C) and the sentence vector of a prompt."""
        ...


def draw(generator: Generator, tasks: Sequence[Task], sampling: Sampling) -> Iterator[tuple[int, Duet]]:
    """(index of the task, its duet) batch by batch.

    Each duet is the one that the Engine gives for that sentence with the seed ``sampling.seed`` + index,
    DDIM and the clean-up; only the network passes are shared. Raises InputError where a motion is not finite.
    """
    model = generator.model
    for group in batches(tasks, seed=sampling.seed):
        frames = _frames(tasks[group[0]])
        shape = (model.layout.num_tokens(frames), 2 * model.layout.token_features)
        noise = torch.cat([sample_noise(sampling.seed + i, 1, shape) for i in group])
        condition = torch.cat([generator.condition(tasks[i].caption)[0] for i in group])
        scheduler = make_scheduler("ddim", sampling.steps, spacing="top")
        damping = Damping(
            model,
            sampling.damping,
            frames=frames,
            timesteps=TRAIN_TIMESTEPS,
            final_timestep=int(scheduler.timesteps[-1]),
            touches=model.touches(condition),
        )

        def predict(x: torch.Tensor, t: torch.Tensor, condition: torch.Tensor = condition) -> torch.Tensor:
            return model.denoiser.guided(x, t, condition, scale=sampling.guidance)

        sample = noise
        for step in sample_steps(predict, noise, scheduler, correct=damping):
            sample = step.sample
        with torch.no_grad():
            positions = model.positions(sample)[0][:, :, :frames].numpy()
        if not np.isfinite(positions).all():
            raise InputError("The motion ran away to infinity: lower the guidance scale or take more steps.")
        for i, pair in zip(group, positions, strict=True):
            clean = np.stack([clean_person(person) for person in pair])
            yield i, Duet.from_positions(clean, fps=30.0, roles=("actor", "reactor"))
