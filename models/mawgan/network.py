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

import torch
from torch import Tensor, nn

from models.mawgan.srvf import exp_map, inner, log_map, norm, to_curve, to_srvf, to_tangent

_DOUBLINGS = 5
_STILL = 1e-6
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

    @property
    def image(self) -> tuple[int, int]:
        """Coordinates and points of a future curve."""
        return 3 * self.joints, self.future + 1

    @property
    def grid(self) -> tuple[int, int]:
        """Size of the first feature map."""
        high, wide = (ceil(size / 2**_DOUBLINGS) for size in self.image)
        return high, wide


class Generator(nn.Module):
    """Tangent vectors of the past (B, past, D) → raw vectors of the future (B, future + 1, D)."""

    def __init__(self, config: MAWGANConfig) -> None:
        super().__init__()
        self.config = config
        high, wide = config.grid
        first = config.fc // (high * wide)
        coordinates, points = config.image
        self.fc = nn.Linear(config.past * coordinates, first * high * wide)
        layers: list[nn.Module] = []
        for i, (inputs, outputs) in enumerate(zip((first, *config.channels), (*config.channels, 1), strict=True)):
            layers += [nn.Upsample(scale_factor=2.0), nn.Conv2d(inputs, outputs, 3, padding=1)]
            if i < _DOUBLINGS - 1:
                layers.append(nn.ReLU())
        self.up = nn.Sequential(*layers)
        self.linear = nn.Linear(config.past * coordinates, points * coordinates) if config.linear else None
        if self.linear is not None:
            nn.init.zeros_(self.linear.weight)
            nn.init.zeros_(self.linear.bias)

    def forward(self, s: Tensor) -> Tensor:
        """See the class."""
        coordinates, points = self.config.image
        x = torch.relu(self.fc(s.flatten(1)))
        image = self.up(x.unflatten(1, (-1, *self.config.grid)))
        made = image[:, 0, :coordinates, :points].transpose(1, 2)
        return made if self.linear is None else made + self.linear(s.flatten(1)).unflatten(1, (-1, coordinates))


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

    sizes = MAWGANConfig
    past_mean: Tensor
    future_mean: Tensor

    def __init__(self, config: MAWGANConfig) -> None:
        super().__init__()
        self.config = config
        self.generator = Generator(config)
        coordinates, points = config.image
        for name, count in (("past_mean", config.past), ("future_mean", points)):
            mean = torch.ones(count, coordinates)
            self.register_buffer(name, mean / norm(mean))

    def generate(self, past: Tensor) -> tuple[Tensor, Tensor]:
        """Runs the generator on past curves.

        Args:
            past: (B, past, D).

        Returns:
            Tangent vectors at ``future_mean`` (B, future + 1, D), and the logarithm (B,) of the ratio
            of the future's curve length per frame to the past's.
        """
        made = self.generator(log_map(self.past_mean, to_srvf(past)[0]))
        along = inner(self.future_mean, made).clamp(-_LONGER, _LONGER)
        return to_tangent(self.future_mean, made), along if self.config.length else torch.zeros_like(along)

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
