"""Errors in weights and checkpoints, each one sentence for the user."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TypeVar

import torch
from torch import Tensor, nn

from motion.errors import InputError

Network = TypeVar("Network", bound=nn.Module)


class WeightsError(InputError):
    """A weights file or dict is missing, altered, or belongs to another network."""


class Released(dict[str, Tensor]):
    """The released tensors of a network by name: float32 on the CPU, integers stay integers.

    Args:
        weights: tensors or numpy arrays by name.
        network: its name, for messages.
    """

    def __init__(self, weights: Mapping[str, object], network: str) -> None:
        tensors = {name: torch.as_tensor(value) for name, value in weights.items()}
        super().__init__({name: v.float() if v.is_floating_point() else v for name, v in tensors.items()})
        self.network = network

    def shape(self, name: str) -> tuple[int, ...]:
        """The shape of a named tensor; WeightsError if it is absent."""
        if name not in self:
            raise WeightsError(f"These are not {self.network} weights: {name} is missing. Choose another file.")
        return tuple(self[name].shape)

    def layers(self, prefix: str) -> int:
        """Number of layers `prefix`0., `prefix`1., … among the names."""
        return count_layers(self, prefix)

    def loaded(self, module: Network) -> Network:
        """The module with every tensor, none missing, left over or misshapen, in eval mode.

        Raises WeightsError that names the first offender.
        """
        expected = module.state_dict()
        for name, value in expected.items():
            if self.shape(name) != tuple(value.shape):
                raise WeightsError(
                    f"These are not {self.network} weights of one size: {name} is {self.shape(name)}, "
                    f"and {tuple(value.shape)} was expected. Choose another file."
                )
        if unknown := next((name for name in self if name not in expected), None):
            raise WeightsError(f"These are not {self.network} weights: {unknown} is unknown. Choose another file.")
        module.load_state_dict(dict(self))
        return module.eval()


def count_layers(weights: Mapping[str, Tensor], prefix: str) -> int:
    """Number of layers `prefix`0., `prefix`1., … among the names."""
    return len({name[len(prefix) :].split(".")[0] for name in weights if name.startswith(prefix)})
