"""Classifier-free guidance (Ho & Salimans 2022), as every network here uses it."""

from __future__ import annotations

from collections.abc import Callable
from typing import cast

import torch
from torch import Tensor
from torch.nn.functional import pad


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


class Guided:
    """A denoiser of two people that its condition guides."""

    @property
    def takes_scale(self) -> bool:
        """True for a network that takes the scale as an input and so needs a single pass."""
        return False

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
    ) -> Tensor:
        """:func:`classifier_free` of this network, in which no condition is no plan either.

        Shapes are as in its ``forward``; ``known`` and ``plan`` may have one row.
        """
        network = cast(Callable[..., Tensor], self)
        more = () if known is None else (known.expand(len(x), -1, -1),)
        told = {} if plan is None else {"plan": plan.expand(len(x), -1, -1)}
        if self.takes_scale:
            scales = torch.full((len(x),), scale, device=x.device)
            return network(x, t, cond, mask, *more, guidance=scales, **told)

        def predict(x: Tensor, t: Tensor, mask: Tensor | None, *rest: Tensor) -> Tensor:
            *known, cond = rest
            padded = {name: pad(value, (0, 0, 0, 0, 0, len(x) - len(value))) for name, value in told.items()}
            return network(x, t, cond, mask, *known, **padded)

        return classifier_free(predict, x, t, mask, *more, cond=cond, scale=scale)
