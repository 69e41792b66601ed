"""Classifier-free guidance (Ho & Salimans 2022), as every network here uses it."""

from __future__ import annotations

from collections.abc import Callable

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
