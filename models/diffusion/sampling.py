"""The one sampling loop, and guidance: every diffusion network here, whole motions and streams alike, runs through it.

The words ``x0``, ``xt`` and ``t`` are those of :mod:`models.diffusion.schedule`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, cast

import numpy as np
import torch
from torch import Tensor

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


def guide(conditional: Tensor, unconditional: Tensor, scale: float) -> Tensor:
    """scale · D(x, cond) + (1 − scale) · D(x, nothing), from both predictions."""
    return scale * conditional + (1 - scale) * unconditional


def classifier_free(
    predict: Callable[..., Tensor], *inputs: Tensor | None, cond: Tensor, scale: float, nothing: Tensor | None = None
) -> Tensor:
    """:func:`guide` on both predictions of a network, made in one batch.

    At scale 1 the unconditional half has no weight and is not run.

    Args:
        predict: D, called with all of `inputs` and then the condition.
        inputs: (B, …) tensors that both halves see, or None.
        cond: (B, …).
        scale: s of the papers.
        nothing: (B, …) what stands for no condition; zeros by default.

    Returns:
        (B, …) as `predict` gives.
    """
    if scale == 1:
        return predict(*inputs, cond)
    nothing = torch.zeros_like(cond) if nothing is None else nothing
    twice = (None if value is None else torch.cat([value, value]) for value in inputs)
    conditional, unconditional = predict(*twice, torch.cat([cond, nothing])).chunk(2)
    return guide(conditional, unconditional, scale)


@dataclass(frozen=True)
class Term:
    """One prediction of a guided sum: its weight, and whether the network reads the words for it."""

    weight: float
    words: bool


def terms(scale: float) -> list[Term]:
    """The sum of predictions in :func:`guide`, without those that have no weight."""
    return [term for term in (Term(scale, True), Term(1 - scale, False)) if term.weight]


class Guided:
    """A denoiser of two people that its condition guides."""

    def guided(
        self,
        x: Tensor,
        t: Tensor,
        cond: Tensor,
        mask: Tensor | None = None,
        known: Tensor | None = None,
        *,
        scale: float = 3.5,
    ) -> Tensor:
        """The sum of :func:`terms` of this network's predictions, made in one batch.

        Shapes are as in its ``forward``; ``known`` may have one row.
        """
        network = cast(Callable[..., Tensor], self)
        sum_of = terms(scale)
        many = len(sum_of)
        seen = {} if known is None else {"known": known.expand(len(x), -1, -1).repeat(many, 1, 1)}
        words = torch.cat([cond if term.words else torch.zeros_like(cond) for term in sum_of])
        masks = None if mask is None else mask.repeat(many, 1, 1)
        made = network(x.repeat(many, 1, 1), t.repeat(many), words, masks, **seen).chunk(many)
        settled = self.settled(known)
        guided = weighted(sum_of, made)
        return guided if settled is None else torch.where(settled, made[0], guided)

    def settled(self, known: Tensor | None) -> Tensor | None:
        """True at the numbers (B, tokens, features) that guidance leaves as the words alone would have them."""
        return None


def weighted(sum_of: Sequence[Term], predictions: Sequence[Tensor]) -> Tensor:
    """The guided sum of its terms' predictions."""
    parts = (term.weight * made for term, made in zip(sum_of, predictions, strict=True))
    return sum(parts, start=torch.zeros(())) if len(sum_of) > 1 else predictions[0]
