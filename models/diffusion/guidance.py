"""Classifier-free guidance (Ho & Salimans 2022), as every network here uses it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import cast

import torch
from torch import Tensor


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
        return weighted(sum_of, made)


def weighted(sum_of: Sequence[Term], predictions: Sequence[Tensor]) -> Tensor:
    """The guided sum of its terms' predictions."""
    parts = (term.weight * made for term, made in zip(sum_of, predictions, strict=True))
    return sum(parts, start=torch.zeros(())) if len(sum_of) > 1 else predictions[0]
