"""The one sampling loop: every diffusion network here, whole motions and streams alike, runs through it.

The words ``x0``, ``xt`` and ``t`` are those of :mod:`models.diffusion.schedule`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import torch
from torch import Tensor

if TYPE_CHECKING:
    from models.diffusion.schedule import Scheduler


@dataclass(frozen=True)
class SamplingStep:
    """Result of one step of `sample_steps`: `step` of `total` done, x_{t−1} and the predicted x0."""

    step: int
    total: int
    timestep: int
    sample: Tensor
    predicted: Tensor


def sample_steps(
    predict: Callable[[Tensor, Tensor], Tensor],
    noise: Tensor,
    scheduler: Scheduler,
    *,
    eta: float = 0.0,
    generator: torch.Generator | None = None,
    correct: Callable[[Tensor, int], Tensor] | None = None,
) -> Iterator[SamplingStep]:
    """Denoise `noise` (B, …) a step at a time, so that the caller can report progress or stop between.

    `predict(xt, t)` is the network, t being (B,) int64. `correct(x0, timestep)` may change the predicted
    clean sample before the scheduler uses it (constraints, damping). `eta` is DDIM's η; `generator` must be
    given where the sampler draws noise (η > 0, ddpm) if the result is to be repeated.
    The last step's `sample` is the result. Runs without gradients.
    """
    from diffusers import DDIMScheduler  # already loaded: the scheduler is one of its objects

    x, total = noise, len(scheduler.timesteps)
    options = {"eta": eta} if isinstance(scheduler, DDIMScheduler) else {}
    for i, timestep in enumerate(scheduler.timesteps):
        with torch.no_grad():
            predicted = predict(x, timestep.expand(x.shape[0]))
        if correct is not None:
            predicted = correct(predicted, int(timestep))
        with torch.no_grad():
            x = scheduler.step(predicted, timestep, x, generator=generator, **options).prev_sample
        yield SamplingStep(i + 1, total, int(timestep), x, predicted)


def denoise(predict: Callable[[Tensor, Tensor], Tensor], noise: Tensor, scheduler: Scheduler, **options: Any) -> Tensor:
    """The end of :func:`sample_steps`, with its arguments: `noise` (B, …) denoised."""
    sample = noise
    for step in sample_steps(predict, noise, scheduler, **options):
        sample = step.sample
    return sample


def sample_noise(seed: int, samples: int, shape: tuple[int, ...]) -> Tensor:
    """(samples, *shape) noise; a sample's noise depends only on the seed and its index."""
    rows = []
    for sample in range(samples):
        state = int(np.random.SeedSequence([seed, sample]).generate_state(1, np.uint64)[0])
        rows.append(torch.randn(shape, generator=torch.Generator().manual_seed(state)))
    return torch.stack(rows)
