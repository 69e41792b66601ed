"""The one sampling loop, and guidance: every diffusion network here, whole motions and streams alike, runs through it.

The words ``x0``, ``xt`` and ``t`` are those of :mod:`models.diffusion.schedule`.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import torch
from torch import Tensor, nn

if TYPE_CHECKING:
    from models.diffusion.schedule import Scheduler


@dataclass(frozen=True)
class SamplingStep:
    """Result of one step of `sample_steps`: `step` of `total` done, and x_{t−1}."""

    step: int
    total: int
    sample: Tensor


def sample_steps(
    predict: Callable[[Tensor, Tensor], Tensor],
    noise: Tensor,
    scheduler: Scheduler,
    *,
    generator: torch.Generator | None = None,
    correct: Callable[[Tensor, int], Tensor] | None = None,
) -> Iterator[SamplingStep]:
    """Denoise `noise` (B, …) a step at a time, so that the caller can report progress or stop between.

    `predict(xt, t)` is the network, t being (B,) int64. `correct(x0, timestep)` may change the predicted
    clean sample before the scheduler uses it (constraints, damping). `generator` must be given where the sampler
    draws noise (ddpm) if the result is to be repeated.
    The last step's `sample` is the result. Runs without gradients.
    """
    x, total = noise, len(scheduler.timesteps)
    for i, timestep in enumerate(scheduler.timesteps):
        with torch.no_grad():
            predicted = predict(x, timestep.expand(x.shape[0]))
        if correct is not None:
            predicted = correct(predicted, int(timestep))
        with torch.no_grad():
            x = scheduler.step(predicted, timestep, x, generator=generator).prev_sample
        yield SamplingStep(i + 1, total, x)


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


# ---- classifier-free guidance (Ho & Salimans 2022), as every network here uses it ----------------


DRAFTED = 0.5
"""Share of the guidance beyond 1 that acts on drafted numbers: all of it would exaggerate what the draft says."""


def guide(conditional: Tensor, unconditional: Tensor, scale: float) -> Tensor:
    """scale · D(x, cond) + (1 − scale) · D(x, nothing), from both predictions."""
    return scale * conditional + (1 - scale) * unconditional


def classifier_free(
    predict: Callable[..., Tensor],
    *inputs: Tensor | None,
    cond: Tensor,
    scale: float,
    nothing: Tensor | None = None,
    drafted: Tensor | None = None,
) -> Tensor:
    """:func:`guide` on both predictions of a network, made in one batch.

    A half without weight, as the unconditional one at scale 1, is not run.

    Args:
        predict: D, called with all of `inputs` and then the condition.
        inputs: (B, …) tensors that both halves see, or None.
        cond: (B, …).
        scale: s of the papers.
        nothing: (B, …) what stands for no condition; zeros by default.
        drafted: true at the numbers on which guidance acts by :data:`DRAFTED`; none by default.

    Returns:
        (B, …) as `predict` gives.
    """
    nothing = torch.zeros_like(cond) if nothing is None else nothing
    if scale == 1 or (scale == 0 and drafted is None):
        return predict(*inputs, cond if scale else nothing)
    twice = (None if value is None else torch.cat([value, value]) for value in inputs)
    conditional, unconditional = predict(*twice, torch.cat([cond, nothing])).chunk(2)
    guided = guide(conditional, unconditional, scale)
    return guided if drafted is None else torch.where(drafted, torch.lerp(conditional, guided, DRAFTED), guided)


class TwoPersonDenoiser(nn.Module, ABC):
    """A denoiser of two people that its condition guides, and that OpenVINO can run (:mod:`models.compiled`).

    The inputs of its ``forward`` are x (B, T, 2F), t (B,), cond (B, C) and mask (B, T, 2), nonzero where a person's
    token is real.
    """

    @property
    @abstractmethod
    def widths(self) -> tuple[int, int]:
        """2F and C."""

    @property
    def varying(self) -> dict[str, tuple[int, ...]]:
        """For each input of ``forward``, in order: the axes whose sizes differ between calls."""
        return {"x": (0, 1), "t": (0,), "cond": (0,), "mask": (0, 1)}

    def filled(self, x: Tensor, t: Tensor, cond: Tensor, mask: Tensor | None = None) -> tuple[Tensor, ...]:
        """The arguments of ``forward`` in the order of ``varying``; without a mask, all tokens are real."""
        real = torch.ones(*x.shape[:2], 2, dtype=torch.bool) if mask is None else mask != 0
        return x, t, cond, real

    def example(self) -> tuple[Tensor, ...]:
        """All arguments of ``forward``, for a batch of two."""
        features, width = self.widths
        draw = torch.Generator().manual_seed(0)
        x, cond = torch.randn(2, 12, features, generator=draw), torch.randn(2, width, generator=draw)
        mask = torch.ones(2, 12, 2, dtype=torch.bool)
        mask[1, 9:] = False
        return x, torch.tensor([999, 500]), cond, mask

    def guided(self, x: Tensor, t: Tensor, cond: Tensor, *, scale: float = 3.5) -> Tensor:
        """:func:`classifier_free` on the condition; shapes are as in ``forward``."""
        return classifier_free(self, x, t, cond=cond, scale=scale)
