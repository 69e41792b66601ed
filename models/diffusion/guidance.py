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
    predict: Callable[..., Tensor],
    *inputs: Tensor | None,
    cond: Tensor,
    scale: float,
    nothing: Tensor | None = None,
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
    """One prediction of a guided sum: its weight, and whether the network reads words and plan for it."""

    weight: float
    words: bool
    plan: bool


def terms(scale: float, plan_scale: float | None = None) -> list[Term]:
    """The sum of predictions in which words have one scale and the plan another.

    D(nothing) + plan_scale · (D(plan) − D(nothing)) + scale · (D(words, plan) − D(plan)), as in Liu et al. 2022
    ("Compositional Visual Generation"); with one scale for both it is :func:`guide`. Terms without weight are left out.
    """
    if plan_scale is None or plan_scale == scale:
        found = [Term(scale, True, True), Term(1 - scale, False, False)]
    else:
        found = [
            Term(scale, True, True), Term(plan_scale - scale, False, True), Term(1 - plan_scale, False, False)
        ]  # fmt: skip
    return [term for term in found if term.weight]


class Guided:
    """A denoiser of two people that its condition guides."""

    @property
    def takes_scale(self) -> bool:
        """True for a network that takes the scale as an input and so needs a single pass."""
        return False

    def untold(self, plan: Tensor) -> Tensor:
        """A plan (B, tokens, 2·P) without what it says of acts."""
        return torch.zeros_like(plan)

    def guided(
        self,
        x: Tensor,
        t: Tensor,
        cond: Tensor,
        mask: Tensor | None = None,
        known: Tensor | None = None,
        plan: Tensor | None = None,
        *,
        scale: float = 3.5,
        plan_scale: float | None = None,
    ) -> Tensor:
        """The sum of :func:`terms` of this network's predictions, made in one batch.

        Shapes are as in its ``forward``; ``known`` and ``plan`` may have one row. Without a plan there is no scale of
        its own, and a network that takes the scale has one for both.
        """
        network = cast(Callable[..., Tensor], self)
        seen = {"known": known, "plan": plan}
        told = {name: value.expand(len(x), -1, -1) for name, value in seen.items() if value is not None}
        if self.takes_scale:
            scales = torch.full((len(x),), scale, device=x.device)
            return network(x, t, cond, mask, guidance=scales, **told)
        sum_of = terms(scale, None if plan is None else plan_scale)
        many = len(sum_of)
        rows = {name: value.repeat(many, 1, 1) for name, value in told.items()}
        if plan is not None:
            plans = [told["plan"] if term.plan else self.untold(told["plan"]) for term in sum_of]
            rows["plan"] = torch.cat(plans)
        words = torch.cat([cond if term.words else torch.zeros_like(cond) for term in sum_of])
        masks = None if mask is None else mask.repeat(many, 1, 1)
        made = network(x.repeat(many, 1, 1), t.repeat(many), words, masks, **rows).chunk(many)
        return weighted(sum_of, made)


def weighted(sum_of: Sequence[Term], predictions: Sequence[Tensor]) -> Tensor:
    """The guided sum of its terms' predictions."""
    parts = (term.weight * made for term, made in zip(sum_of, predictions, strict=True))
    return sum(parts, start=torch.zeros(())) if len(sum_of) > 1 else predictions[0]
