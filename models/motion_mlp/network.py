"""A network that continues a motion by smooth velocities from the last seen pose.

In the spirit of siMLPe (Guo et al., *Back to MLP: a simple baseline for human motion prediction*, WACV 2023):
cosine transforms in time and full layers, no recursion inside and no graph. Past and future are a few
low-frequency coefficients: of the past's offsets from the last pose, and of the future's *velocities*. A
prediction is their running sum from the last pose, so it begins there and moves smoothly, whatever the
weights. A linear map, which is fitted in closed form, goes before; residual blocks correct it.
"""

from __future__ import annotations

from dataclasses import dataclass

import torch
from scipy.fft import dct
from torch import Tensor, nn


@dataclass(frozen=True)
class MotionMLPConfig:
    """Sizes of a :class:`MotionMLP`.

    Attributes:
        joints, past, future: of a window.
        past_coefficients, future_coefficients: kept of each coordinate, lowest frequencies first.
        width, blocks: of the residual part.
        dropout: in its blocks, in training.
    """

    joints: int = 22
    past: int = 30
    future: int = 30
    past_coefficients: int = 12
    future_coefficients: int = 12
    width: int = 512
    blocks: int = 2
    dropout: float = 0.1

    @property
    def inputs(self) -> int:
        """Numbers that the network takes."""
        return 3 * self.joints * (self.past_coefficients + 1)

    @property
    def outputs(self) -> int:
        """Numbers that the network gives."""
        return 3 * self.joints * self.future_coefficients


class Residual(nn.Module):
    """Norm, two layers, and what came in on top."""

    def __init__(self, width: int, dropout: float) -> None:
        super().__init__()
        self.layers = nn.Sequential(
            nn.LayerNorm(width), nn.Linear(width, width), nn.GELU(), nn.Dropout(dropout), nn.Linear(width, width)
        )

    def forward(self, x: Tensor) -> Tensor:
        """(B, width) → the same shape."""
        return x + self.layers(x)


class MotionMLP(nn.Module):
    """Past positions → future positions.

    ``mean`` and ``std`` (inputs,) normalise the features of :meth:`features` and ``scale`` (outputs,) the
    coefficients; they are measured on the training data and travel with the weights.
    """

    sizes = MotionMLPConfig
    mean: Tensor
    std: Tensor
    scale: Tensor
    analysis: Tensor
    synthesis: Tensor

    def __init__(self, config: MotionMLPConfig) -> None:
        super().__init__()
        self.config = config
        self.linear = nn.Linear(config.inputs, config.outputs)
        self.embed = nn.Linear(config.inputs, config.width)
        self.blocks = nn.Sequential(*(Residual(config.width, config.dropout) for _ in range(config.blocks)))
        self.norm = nn.LayerNorm(config.width)
        self.out = nn.Linear(config.width, config.outputs)
        for layer in (self.linear, self.out):
            nn.init.zeros_(layer.weight)
            nn.init.zeros_(layer.bias)
        self.register_buffer("mean", torch.zeros(config.inputs))
        self.register_buffer("std", torch.ones(config.inputs))
        self.register_buffer("scale", torch.ones(config.outputs))
        analysis, velocities = (
            torch.from_numpy(dct(torch.eye(size).double().numpy(), norm="ortho", axis=0))[:count]
            for size, count in ((config.past, config.past_coefficients), (config.future, config.future_coefficients))
        )
        # Offsets are the running sum of velocities.
        synthesis = velocities.T.cumsum(dim=0)
        self.register_buffer("analysis", analysis.float(), persistent=False)
        self.register_buffer("synthesis", synthesis.float(), persistent=False)

    def features(self, past: Tensor) -> Tensor:
        """(B, past, J, 3) metres → (B, inputs): coefficients of the offsets and the last pose."""
        last = past[:, -1:]
        coefficients = self.analysis @ (past - last).flatten(2)
        return torch.cat([coefficients.flatten(1), last.flatten(1)], dim=1)

    def coefficients(self, future: Tensor, last: Tensor) -> Tensor:
        """The coefficients (B, outputs) nearest to a future (B, future, J, 3) after a pose (B, J, 3)."""
        inverse = torch.linalg.pinv(self.synthesis.double()).float()
        return (inverse @ (future - last[:, None]).flatten(2)).flatten(1)

    def decode(self, coefficients: Tensor, last: Tensor) -> Tensor:
        """Coefficients (B, outputs) → (B, future, J, 3) after a pose (B, J, 3)."""
        by_frequency = coefficients.unflatten(1, (self.config.future_coefficients, -1))
        return last[:, None] + (self.synthesis @ by_frequency).unflatten(2, last.shape[1:])

    def forward(self, past: Tensor) -> Tensor:
        """(B, past, J, 3) metres → (B, future, J, 3)."""
        x = (self.features(past) - self.mean) / self.std
        corrected = self.linear(x) + self.out(self.norm(self.blocks(self.embed(x))))
        return self.decode(corrected * self.scale, past[:, -1])

    @torch.no_grad()
    def fit_linear(self, windows: Tensor, *, ridge: float = 0.01) -> None:
        """Measures the normalisers and solves for the linear part in closed form.

        Args:
            windows: (N, past + future, J, 3) metres of training data.
            ridge: weight of the penalty, as a share of N.
        """
        past, future = windows.split([self.config.past, self.config.future], dim=1)
        x, y = self.features(past), self.coefficients(future, past[:, -1])
        self.mean.copy_(x.mean(0))
        self.std.copy_(x.std(0).clamp_min(1e-3))
        self.scale.copy_(y.std(0).clamp_min(1e-4))
        x, y = ((x - self.mean) / self.std).double(), (y / self.scale).double()
        gram = x.T @ x + ridge * len(x) * torch.eye(x.shape[1], dtype=torch.float64, device=x.device)
        self.linear.weight.copy_(torch.linalg.solve(gram, x.T @ (y - y.mean(0))).T)
        self.linear.bias.copy_(y.mean(0))
