"""Duets of many sentences at once: several of one length share a network pass."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, Protocol

import numpy as np
import torch

from models.diffusion import denoise, make_scheduler
from models.intergen.compact import CompactInterGen
from models.intergen.words import join_conditions
from motion import Duet, InputError
from webdemo.inference.cleanup import clean_person
from webdemo.inference.damping import Damping
from webdemo.inference.noise import sample_noise

from .rules import Task

BATCH = 12
LENGTH_STEP = 30


@dataclass(frozen=True, kw_only=True)
class Sampling:
    """Sampling settings; the names are those of :class:`webdemo.inference.GenerateRequest`."""

    seed: int = 0
    steps: int = 25
    guidance: float = 4.3
    damping: float = 0.7


def batches(tasks: Sequence[Task], *, size: int = BATCH, seed: int = 0) -> list[list[int]]:
    """Groups tasks that share a pass: equal length (to the next whole second), in an order drawn by ``seed``.

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
    """The part used of :class:`webdemo.inference.pipelines.two_person.TwoPersonPipeline`."""

    model: CompactInterGen

    def condition(self, prompt: str) -> tuple[torch.Tensor, torch.Tensor]:
        """The condition (1, …) and the sentence vector of a prompt."""
        ...


def draw(
    generator: Generator, tasks: Sequence[Task], sampling: Sampling, seeds: Sequence[int] | None = None
) -> Iterator[tuple[int, Duet]]:
    """(index of the task, its duet) batch by batch.

    Each duet is the one that the Engine gives for that sentence with its seed of ``seeds``, which are
    ``sampling.seed`` + index by default, DDIM and the clean-up; only the network passes are shared.
    Raises InputError if a motion is not finite.
    """
    model = generator.model
    seeds = [sampling.seed + i for i in range(len(tasks))] if seeds is None else seeds
    for group in batches(tasks, seed=sampling.seed):
        frames = _frames(tasks[group[0]])
        shape = (model.layout.num_tokens(frames), 2 * model.layout.token_features)
        noise = torch.cat([sample_noise(seeds[i], 1, shape) for i in group])
        condition = join_conditions([generator.condition(tasks[i].caption)[0] for i in group])
        touches = model.touches(condition)
        scheduler = make_scheduler("ddim", sampling.steps, spacing="top")
        damping = Damping(
            model,
            sampling.damping,
            frames=frames,
            timesteps=scheduler.timesteps.tolist(),
            touches=touches,
        )
        predict = partial(_guided, model.denoiser, condition, sampling.guidance)
        sample = denoise(predict, noise, scheduler, correct=damping)
        with torch.no_grad():
            positions = model.positions(sample)[0][:, :, :frames].numpy()
        if not np.isfinite(positions).all():
            raise InputError("The motion diverged: lower the guidance scale or take more steps.")
        for i, pair in zip(group, positions, strict=True):
            clean = np.stack([clean_person(person) for person in pair])
            yield i, Duet.from_positions(clean, fps=30.0, roles=("actor", "reactor"))


def _guided(
    denoiser: Any, condition: torch.Tensor, scale: float, x: torch.Tensor, t: torch.Tensor
) -> torch.Tensor:
    return denoiser.guided(x, t, condition, scale=scale)
