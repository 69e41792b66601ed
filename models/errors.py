"""Errors in weights and checkpoints, each one sentence for the user."""

from __future__ import annotations

from collections.abc import Mapping

import torch
from torch import Tensor, nn

from motion.errors import InputError


class WeightsError(InputError):
    """A weights file or dict is missing, altered, or belongs to another network."""


def as_tensors(weights: Mapping[str, object]) -> dict[str, Tensor]:
    """name → float32 CPU tensor (integers stay integers), from tensors or numpy arrays."""
    tensors = {name: torch.as_tensor(value) for name, value in weights.items()}
    return {name: v.float() if v.is_floating_point() else v for name, v in tensors.items()}


def shape_of(weights: Mapping[str, Tensor], name: str, *, network: str) -> tuple[int, ...]:
    """The shape of a named tensor; WeightsError if it is absent."""
    if name not in weights:
        raise WeightsError(f"These are not {network} weights: {name} is missing. Choose another file.")
    return tuple(weights[name].shape)


def count_layers(weights: Mapping[str, Tensor], prefix: str) -> int:
    """Number of layers `prefix`0., `prefix`1., … among the names."""
    numbers = {name[len(prefix) :].split(".")[0] for name in weights if name.startswith(prefix)}
    return len(numbers)


def load_strictly(module: nn.Module, weights: Mapping[str, Tensor], *, network: str) -> None:
    """Load every tensor by name, allow none missing, left over or misshapen; then eval mode.

    Raises WeightsError that names the first offender.
    """
    expected = module.state_dict()
    for name in expected:
        if shape_of(weights, name, network=network) != tuple(expected[name].shape):
            raise WeightsError(
                f"These are not {network} weights of one size: {name} is {tuple(weights[name].shape)}, "
                f"and {tuple(expected[name].shape)} was expected. Choose another file."
            )
    for name in weights:
        if name not in expected:
            raise WeightsError(f"These are not {network} weights: {name} is unknown. Choose another file.")
    module.load_state_dict(dict(weights))
    module.eval()
