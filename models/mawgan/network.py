"""PredictiveMA-WGAN: future motion as a point of a hypersphere, predicted from that of the past.

Chopin's thesis, chapter 2: the past becomes a square-root velocity function (:mod:`models.mawgan.srvf`), its tangent
vector at the mean of the training data passes through an upsampling convolutional network over the image of
coordinates × frames. The output is mapped back to the sphere and integrated from the last pose.

Choices that the thesis leaves open: The points of the past's curve are the given frames. The future's curve
begins with the last given pose, so it has one more point; past and future each have their own mean. The first
feature map is the smallest one that covers the image after five doublings; the result is cropped.

A point on the sphere encodes neither the starting point nor the length of its curve. The curve starts at the
last given pose. Its length per frame is that of the past; with ``length`` the network predicts how it changes.
For this it uses the component of its output along the mean, which is not a tangent direction and would go
unused: it is the logarithm of the ratio of lengths.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil
from typing import Any, cast

import numpy as np
import torch
from scipy.fft import dct
from torch import Tensor, nn

from models.mawgan.srvf import exp_map, inner, log_map, norm, to_curve, to_srvf, to_tangent

_DOUBLINGS = 5
_STILL = 1e-6
_LAST = (1, 3, 8)
"""Numbers of last steps of the past; the mean length of each is an input of the network."""
_SHORT = 1e-2
"""Metres that all joints together must move before a past differs from one without movement."""
_LONGER = 2.0
"""Bound of the logarithm of the ratio of the future's curve length per frame to the past's."""


@dataclass(frozen=True)
class MAWGANConfig:
    """Sizes of predictor and critic; the defaults are the thesis' (section 2.4.1), for 17 joints.

    Attributes:
        joints, past, future: of a window.
        fc: outputs of the predictor's first layer.
        channels: of its first four upsampling blocks; the fifth has one.
        critic: channels of the critic's convolutions.
        critic_fc: outputs of its first full layer.
        critic_stride: of the critic's convolutions: 2 as in the release, 1 as in the thesis. It enters the loss
            alone; shipped weights hold no critic.
        linear: adds a linear map from past to future, which the convolutions correct. The thesis has none. It
            shortens training: adjacent rows of the image are unrelated joints, which convolutions learn slowly.
        length: whether the length of the future's curve is predicted; otherwise it equals the past's.
        pose: further inputs: the last given pose, the logarithm of the past's length, and the logarithms of
            the speed of its last frames relative to its mean speed. The thesis' network sees only changes of
            pose, so it cannot know that raised arms cannot be raised further.
        coefficients: number of temporal cosine coefficients of each coordinate that the linear map reads and
            writes, lowest frequencies first; 0: all frames.
        shortcut: feeds the first layer's outputs to the linear map as well, which makes it a two-layer
            network. In the thesis they reach the future through the convolutions only.
        dropout: of the first layer's outputs, in training.
    """

    joints: int = 17
    past: int = 25
    future: int = 25
    fc: int = 36_864
    channels: tuple[int, ...] = (512, 256, 128, 64)
    critic: tuple[int, ...] = (64, 32, 16)
    critic_fc: int = 1024
    critic_stride: int = 2
    linear: bool = False
    length: bool = False
    pose: bool = False
    coefficients: int = 0
    shortcut: bool = False
    dropout: float = 0.0

    @classmethod
    def from_dict(cls, values: dict[str, Any]) -> MAWGANConfig:
        """The config that ``config.json`` holds as a dictionary."""
        return cls(**values | {key: tuple(values[key]) for key in ("channels", "critic")})

    @property
    def image(self) -> tuple[int, int]:
        """Coordinates and points of a future curve."""
        return 3 * self.joints, self.future + 1

    @property
    def beside(self) -> int:
        """Number of inputs in addition to the past's tangent vector."""
        return 3 * self.joints + 1 + len(_LAST) if self.pose else 0

    @property
    def grid(self) -> tuple[int, int]:
        """Size of the first feature map."""
        high, wide = (ceil(size / 2**_DOUBLINGS) for size in self.image)
        return high, wide


class Generator(nn.Module):
    """Tangent vectors of the past (B, past, D) and more → raw vectors of the future (B, future + 1, D)."""

    analysis: Tensor
    synthesis: Tensor

    def __init__(self, config: MAWGANConfig) -> None:
        super().__init__()
        self.config = config
        high, wide = config.grid
        first = config.fc // (high * wide)
        self.fc = nn.Linear(config.past * 3 * config.joints + config.beside, first * high * wide)
        layers: list[nn.Module] = []
        for i, (inputs, outputs) in enumerate(zip((first, *config.channels), (*config.channels, 1), strict=True)):
            layers += [nn.Upsample(scale_factor=2.0), nn.Conv2d(inputs, outputs, 3, padding=1)]
            if i < _DOUBLINGS - 1:
                layers.append(nn.ReLU())
        self.up = nn.Sequential(*layers)
        self.dropout = nn.Dropout(config.dropout)
        coordinates, points = config.image
        for name, size in (("analysis", config.past), ("synthesis", points)):
            cosines = torch.from_numpy(dct(np.eye(size), norm="ortho", axis=0)).float()
            kept = cosines[: config.coefficients] if config.coefficients else torch.eye(size)
            self.register_buffer(name, kept if name == "analysis" else kept.T, persistent=False)
        inputs = self.analysis.shape[0] * coordinates + config.beside
        inputs += config.shortcut * self.fc.out_features
        outputs = self.synthesis.shape[1] * coordinates
        self.linear = nn.Linear(inputs, outputs) if config.linear else None
        if self.linear is not None:
            nn.init.zeros_(self.linear.weight)
            nn.init.zeros_(self.linear.bias)

    def forward(self, s: Tensor, beside: Tensor) -> Tensor:
        """``beside`` is (B, :attr:`MAWGANConfig.beside`)."""
        coordinates, points = self.config.image
        x = self.dropout(torch.relu(self.fc(torch.cat([s.flatten(1), beside], 1))))
        image = self.up(x.unflatten(1, (-1, *self.config.grid)))
        made = image[:, 0, :coordinates, :points].transpose(1, 2)
        if self.linear is None:
            return made
        given = [self.coefficients(s, beside)] + [x] * self.config.shortcut
        return made + self.synthesis @ self.linear(torch.cat(given, 1)).unflatten(1, (-1, coordinates))

    def coefficients(self, s: Tensor, beside: Tensor) -> Tensor:
        """The linear map's own inputs (B, inputs)."""
        return torch.cat([(self.analysis @ s).flatten(1), beside], 1)

    @torch.no_grad()
    def fit_linear(self, s: Tensor, beside: Tensor, made: Tensor, *, ridge: float) -> None:
        """Solves for the linear map in closed form; the convolutions begin with corrections of 0.

        Args:
            s, beside: (N, …) inputs as in :meth:`forward`.
            made: (N, future + 1, D) what should come out.
            ridge: weight of the penalty, for inputs of variance 1, as a share of N.
        """
        assert self.linear is not None
        x = self.coefficients(s, beside).double()
        y = (torch.linalg.pinv(self.synthesis) @ made).flatten(1).double()
        mean, deviation = x.mean(0), x.std(0).clamp_min(1e-3)
        x = (x - mean) / deviation
        gram = x.T @ x + ridge * len(x) * torch.eye(x.shape[1], dtype=x.dtype, device=x.device)
        weight = torch.linalg.solve(gram, x.T @ (y - y.mean(0))).T / deviation
        last = cast(nn.Conv2d, self.up[-1])
        nn.init.zeros_(last.weight)
        assert last.bias is not None
        nn.init.zeros_(last.bias)
        self.linear.weight.zero_()
        self.linear.weight[:, : x.shape[1]] = weight
        self.linear.bias.copy_(y.mean(0) - weight @ mean)


class Critic(nn.Module):
    """Tangent vectors of a future (B, future + 1, D) → a score (B,).

    It sees the future only, as in eq. 2.5; the released critic sees the past as well.
    """

    def __init__(self, config: MAWGANConfig) -> None:
        super().__init__()
        layers: list[nn.Module] = []
        high, wide = config.image
        for inputs, outputs in zip((1, *config.critic), config.critic, strict=False):
            stride = config.critic_stride
            convolution = nn.Conv2d(inputs, outputs, 3, stride=stride, padding=1)
            layers += [convolution, nn.BatchNorm2d(outputs), nn.ReLU()]
            high, wide = ceil(high / stride), ceil(wide / stride)
        self.down = nn.Sequential(*layers, nn.Flatten())
        self.score = nn.Sequential(
            nn.Linear(config.critic[-1] * high * wide, config.critic_fc),
            nn.BatchNorm1d(config.critic_fc),
            nn.LeakyReLU(0.2),
            nn.Linear(config.critic_fc, 1),
        )

    def forward(self, s: Tensor) -> Tensor:
        """Points of the sphere s (B, N, 3·J) → scores (B,)."""
        return self.score(self.down(s.transpose(1, 2)[:, None]))[:, 0]


class PredictiveMAWGAN(nn.Module):
    """The predictor with its two means on the sphere; the critic is needed in training only.

    ``past_mean`` (past, D) and ``future_mean`` (future + 1, D) are Karcher means of training curves.
    """

    past_mean: Tensor
    future_mean: Tensor
    beside_mean: Tensor

    def __init__(self, config: MAWGANConfig) -> None:
        super().__init__()
        self.config = config
        self.generator = Generator(config)
        coordinates, points = config.image
        for name, count in (("past_mean", config.past), ("future_mean", points)):
            mean = torch.ones(count, coordinates)
            self.register_buffer(name, mean / norm(mean))
        if config.pose:
            self.register_buffer("beside_mean", torch.zeros(config.beside))

    def inputs(self, past: Tensor) -> tuple[Tensor, Tensor]:
        """The generator's inputs for past curves (B, past, D): tangent vectors and the additional inputs."""
        q, length = to_srvf(past)
        s = log_map(self.past_mean, q)
        if not self.config.pose:
            return s, s.new_zeros(len(s), 0)
        size = length.clamp_min(_SHORT)[:, None]
        lengths = past.diff(dim=1).norm(dim=-1)
        ends = [(lengths[:, -n:].mean(1, keepdim=True) * past.shape[1] / size + 0.1).log() for n in _LAST]
        return s, torch.cat([past[:, -1], size.log(), *ends], 1) - self.beside_mean

    def generate(self, past: Tensor) -> tuple[Tensor, Tensor]:
        """Runs the generator on past curves.

        Args:
            past: (B, past, D).

        Returns:
            Tangent vectors at ``future_mean`` (B, future + 1, D), and the logarithm (B,) of the ratio
            of the future's curve length per frame to the past's.
        """
        made = self.generator(*self.inputs(past))
        along = inner(self.future_mean, made).clamp(-_LONGER, _LONGER)
        return to_tangent(self.future_mean, made), along if self.config.length else torch.zeros_like(along)

    def wanted(self, past: Tensor, future: Tensor) -> Tensor:
        """The generator's targets (B, future + 1, D): outputs that decode to the true futures.

        Args:
            past: (B, past, D).
            future: (B, future + 1, D), the last given pose and the frames after it.
        """
        (_, before), (q, after) = to_srvf(past), to_srvf(future)
        steps = (self.config.future + 1) / self.config.past
        longer = (after / (before * steps)).log().clamp(-_LONGER, _LONGER)
        return log_map(self.future_mean, q) + longer[:, None, None] * self.future_mean

    def decode(self, s: Tensor, longer: Tensor, past: Tensor) -> Tensor:
        """Turns the outputs of :meth:`generate` into curves (B, future, D) that continue the past (B, past, D)."""
        _, length = to_srvf(past)
        # Time runs from 0 to 1 over the points of each curve, and the two have different numbers of points.
        steps = (self.config.future + 1) / self.config.past
        curve = to_curve(exp_map(self.future_mean, s), length * steps * longer.exp(), past[:, -1])
        return torch.where((length > _STILL)[:, None, None], curve, past[:, -1:])[:, 1:]

    def forward(self, past: Tensor) -> Tensor:
        """(B, past, J, 3) metres → (B, future, J, 3); a past that does not move stays as it is."""
        curve = to_curves(past)
        future = self.decode(*self.generate(curve), curve)
        return to_positions(without_flicker(curve[:, -1:], future))


def without_flicker(start: Tensor, future: Tensor) -> Tensor:
    """Removes flicker between even and odd frames, which the velocities do not determine.

    Central differences cannot see this flicker, so a prediction may contain any amount of it. Each frame becomes
    the mean of itself and its neighbours with weights (1, 2, 1) / 4; the last one is extrapolated.

    Args:
        start: (B, 1, D) the last given pose.
        future: (B, T, D), T at least 2.

    Returns:
        (B, T, D).
    """
    whole = torch.cat([start, future], dim=1)
    calm = torch.cat([start, (whole[:, :-2] + 2 * whole[:, 1:-1] + whole[:, 2:]) / 4], dim=1)
    return torch.cat([calm[:, 1:], 2 * calm[:, -1:] - calm[:, -2:-1]], dim=1)


def to_curves(positions: Tensor) -> Tensor:
    """(B, T, J, 3) → (B, T, 3J), coordinate-major: all x, then all y, then all z."""
    return positions.transpose(2, 3).flatten(2)


def to_positions(curves: Tensor) -> Tensor:
    """Inverse of :func:`to_curves`."""
    return curves.unflatten(2, (3, -1)).transpose(2, 3)
