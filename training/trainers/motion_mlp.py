"""Trains the default predictor: ``python -m training.trainers.motion_mlp --data CORPUS --out RUN``.

Loss: mean distance of joints (what MPJPE measures), the same of their velocities, and how far mean speeds lie from the
truth's (:func:`speed_gap`). Without the last a network that is unsure slows down (thesis, section 2.5.4), because half
a step is never far off.
"""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor, nn

from models.intergen.losses import bone_lengths
from models.motion_mlp import MotionMLP, MotionMLPConfig
from models.weights_io import common
from training.core.shell import at_least
from training.trainers.prediction import PredictionTrainer, train


@dataclass(frozen=True)
class Settings:
    """The settings of a run; a checkpoint of others is refused. ``fit`` windows solve the linear part."""

    past: int = 30
    future: int = 30
    past_coefficients: int = 12
    future_coefficients: int = 12
    width: int = 512
    blocks: int = 2
    dropout: float = 0.1
    fit: int = 20_000
    batch: int = 128
    steps: int = 3000
    learning_rate: float = 5e-4
    weight_decay: float = 1e-2
    warmup: int = 100
    ema: float = 0.995
    velocity_weight: float = 2.0
    speed_weight: float = 1.0
    bone_weight: float = 0.5
    noise: float = 0.002
    seed: int = 0

    def __post_init__(self) -> None:
        at_least(self, **dict.fromkeys(("past", "future", "width", "blocks", "batch", "warmup"), 1))


_BIN = 5
"""Frames that one mean speed is of."""


def lengths(vectors: Tensor) -> Tensor:
    """(…, 3) → (…), with a gradient at 0."""
    return (vectors.square().sum(-1) + 1e-10).sqrt()


def speed_gap(made: Tensor, real: Tensor) -> Tensor:
    """Root mean square of the differences of mean speeds from the true ones, in the unit of the velocities.

    Means are over the windows, for each joint and :data:`_BIN` frames. They are met by the mean of what may follow,
    not by its median, in which people stand still.

    Args:
        made, real: (B, T, J, 3) velocities per frame.
    """
    means = lengths(made).mean(0) - lengths(real).mean(0)
    few = torch.stack([part.mean(0) for part in means.split(_BIN)])
    return (few.square().mean() + 1e-10).sqrt()


class Trainer(PredictionTrainer):
    """Trains a :class:`~models.motion_mlp.MotionMLP`."""

    kind = "mlp"
    settings: Settings
    model: MotionMLP
    ema: MotionMLP

    def network(self) -> nn.Module:
        """The network as a run begins, its linear part fitted."""
        s = self.settings
        model = MotionMLP(MotionMLPConfig(**common(s, MotionMLPConfig))).to(self.device)
        if not self.checkpoint.exists():
            model.fit_linear(self.windows.batch(s.fit, (s.seed, 0, 1)).to(self.device))
        return model

    def terms(self, window: Tensor) -> dict[str, Tensor]:
        """Weighted loss terms, in centimetres, of windows (B, past + future, J, 3) in metres."""
        s = self.settings
        past, truth = window.split([s.past, s.future], dim=1)
        noise = torch.randn(past.shape, generator=torch.Generator().manual_seed(self.step)).to(past)
        predicted, before = 100 * self.model(past + s.noise * noise), 100 * past[:, -1:]
        truth = 100 * truth
        made, real = (torch.cat([before, motion], dim=1).diff(dim=1) for motion in (predicted, truth))
        bones = [bone_lengths(x) for x in (predicted, truth)]
        return {
            "position": lengths(predicted - truth).mean(),
            "velocity": s.velocity_weight * lengths(made - real).mean(),
            "speed": s.speed_weight * speed_gap(made, real),
            "bone": s.bone_weight * (bones[0] - bones[1]).abs().mean(),
        }

    def train_step(self) -> dict[str, float]:
        """Takes one optimizer step; returns each loss by name."""
        torch.manual_seed(self.settings.seed + self.step)  # dropout
        return self.step_on(self.terms(self.batch()), clip=5.0)


def main(argv: list[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    return train(argv, __doc__, Settings, Trainer)


if __name__ == "__main__":
    raise SystemExit(main())
