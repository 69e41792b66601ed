"""Trains the default predictor: ``python -m training.trainers.motion_mlp --windows corpus --data DIR --out RUN``.

Loss: mean distance of joints (what MPJPE measures), the same of their velocities, and how far mean speeds and
accelerations lie from the truth's (:func:`liveliness`). Without the last a network that is unsure slows down
(thesis, section 2.5.4), because half a step is never far off.
"""

from __future__ import annotations

import argparse
from dataclasses import asdict, dataclass
from pathlib import Path

import torch
from torch import Tensor

from models.motion_mlp import MotionMLP, MotionMLPConfig
from models.predictors import load_predictor, save_predictor
from motion import InputError
from training.core.loop import adamw
from training.core.shell import add_options, add_run_options, chosen, exit_code
from training.trainers.prediction.rollout import ADVANCE, check_own_pasts
from training.trainers.prediction.trainer import PredictionTrainer
from training.trainers.prediction.windows import open_windows


@dataclass(frozen=True)
class Settings:
    """The settings of a run; a checkpoint of others is refused.

    ``init`` names the folder of a trained predictor that the run begins with. ``own_pasts`` is how often the
    network may have been applied to what it gave in the pasts that it sees (of the corpus): 0 to so many
    times, drawn for each step. After so many applications distances and velocities are hardly to be known;
    they count the less, by a further share for each. ``groups`` is how many parts of the batch, from slow
    pasts to fast ones, have mean speeds of their own.
    """

    windows: str = "corpus"
    init: str = ""
    own_pasts: int = 0
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
    acceleration_weight: float = 0.0
    groups: int = 1
    bone_weight: float = 0.5
    noise: float = 0.002
    seed: int = 0

    def __post_init__(self) -> None:
        for name in ("past", "future", "width", "blocks", "batch", "warmup", "groups"):
            if getattr(self, name) < 1:
                raise InputError(f"{name} is {getattr(self, name)}: give 1 or more.")
        if self.batch % self.groups:
            raise InputError(f"groups is {self.groups}: give a divisor of the batch, {self.batch}.")
        check_own_pasts(self.own_pasts, self.windows, self.future)

    @property
    def ahead(self) -> int:
        """Frames of a window behind its past."""
        return self.future + ADVANCE * self.own_pasts


_BIN = 5
"""Frames that one mean speed is of."""


def lengths(vectors: Tensor) -> Tensor:
    """(…, 3) → (…), with a gradient at 0."""
    return (vectors.square().sum(-1) + 1e-10).sqrt()


def liveliness(made: Tensor, real: Tensor, groups: int = 1) -> tuple[Tensor, Tensor]:
    """Difference of mean speeds from the true ones, and excess of mean accelerations over the true ones.

    Means are over a group of windows, for each joint and, of speeds, :data:`_BIN` frames; of the differences
    it is the root of the mean square. It is met by the mean of what may follow, not by its median, in which
    people stand still; without the accelerations it would be met by trembling.

    Args:
        made, real: (B, T, J, 3) velocities per frame, the first one of the past; B a multiple of ``groups``.
        groups: how many equal parts of the batch have means of their own.

    Returns:
        two numbers in the unit of the velocities.
    """
    speeds, accelerations = (
        [lengths(v).unflatten(0, (groups, -1)).mean(1) for v in pair]
        for pair in ((made[:, 1:], real[:, 1:]), (made.diff(dim=1), real.diff(dim=1)))
    )
    few = torch.cat([x.mean(1) for x in (speeds[0] - speeds[1]).split(_BIN, dim=1)])
    above = torch.relu(accelerations[0] - accelerations[1])
    speed, acceleration = ((x.square().mean() + 1e-10).sqrt() for x in (few, above))
    return speed, acceleration


class Trainer(PredictionTrainer):
    """Trains a :class:`~models.motion_mlp.MotionMLP`."""

    settings: Settings
    model: MotionMLP
    ema: MotionMLP

    def build(self) -> None:
        """Makes the network, its average and the optimizers."""
        s = self.settings
        config = MotionMLPConfig(
            self.windows.joints,
            s.past,
            s.future,
            s.past_coefficients,
            s.future_coefficients,
            s.width,
            s.blocks,
            s.dropout,
        )
        self.model, self.ema = (MotionMLP(config).to(self.device) for _ in range(2))
        self.ema.eval()
        if s.init:
            self.model.load_state_dict(load_predictor(Path(s.init)).network.state_dict())
        elif not self.checkpoint.exists():
            sample = self.windows.batch(s.fit, (s.seed, 0, 1))[:, : s.past + s.future]
            self.model.fit_linear(sample.to(self.device))
        self.ema.load_state_dict(self.model.state_dict())
        self.ema.requires_grad_(False)
        self.optimizer = adamw(self.model.parameters(), s)
        parents, children = zip(*self.windows.bones, strict=True)
        self.bones = list(parents), list(children)

    def terms(self, window: Tensor, recorded: Tensor, passes: int = 0) -> dict[str, Tensor]:
        """Weighted loss terms, in centimetres.

        Args:
            window: (B, T, J, 3) metres; its past was made in ``passes``, its future is asked for.
            recorded: (B, T, J, 3) the same of recorded motion alone, in the order of the speed of the pasts.
            passes: how often the network was applied before.
        """
        s = self.settings
        past, asked = window.split([s.past, s.future], dim=1)
        noise = torch.randn(past.shape, generator=torch.Generator().manual_seed(self.step)).to(past)
        predicted, before = 100 * self.model(past + s.noise * noise), 100 * past[:, -2:]
        velocities = torch.cat([before, predicted], dim=1).diff(dim=1)
        real = 100 * recorded[:, s.past - 2 :].diff(dim=1)
        parents, children = self.bones
        truth = 100 * recorded[:, s.past :]
        bones = [lengths(x[..., children, :] - x[..., parents, :]) for x in (predicted, truth)]
        known = 1 / (1 + passes)
        speed, acceleration = liveliness(velocities, real, s.groups)
        return {
            "position": known * lengths(predicted - 100 * asked).mean(),
            "velocity": known * s.velocity_weight * lengths(velocities - real)[:, 1:].mean(),
            "speed": s.speed_weight * speed,
            "acceleration": s.acceleration_weight * acceleration,
            "bone": s.bone_weight * (bones[0] - bones[1]).abs().mean(),
        }

    def train_step(self) -> dict[str, float]:
        """Takes one optimizer step; returns each loss by name."""
        torch.manual_seed(self.settings.seed + self.step)  # dropout
        terms = self.terms(*self.window())
        total = torch.stack(list(terms.values())).sum()
        self.optimizer_step(total, self.optimizer, self.model.parameters(), clip=5.0)
        self.ema_update(self.ema.parameters(), self.model.parameters())
        return {name: value.item() for name, value in terms.items()} | {"total": total.item()}

    def export(self, folder: Path) -> None:
        """Writes the averaged network as a predictor's folder."""
        save_predictor(
            folder,
            self.ema,
            kind="mlp",
            fps=self.windows.fps,
            bones=self.windows.bones,
            training={**asdict(self.settings), "steps": self.step, "init": Path(self.settings.init).name},
        )


def add_predictor_options(parser: argparse.ArgumentParser, settings: type) -> None:
    """Options that every training of a predictor takes: data, folders, minutes and each setting."""
    parser.add_argument("--data", type=Path, required=True, help="folder of the data set")
    parser.add_argument("--export", type=Path, help="also write the trained predictor to this folder")
    add_options(parser, "device")
    add_run_options(parser, settings)


def train(trainer: type, settings: type, options: argparse.Namespace) -> None:
    """Runs what :func:`add_predictor_options` understood."""
    asked = chosen(options, settings)
    ahead = getattr(asked, "ahead", asked.future)
    windows = open_windows(asked.windows, options.data, asked.past, ahead)
    run = trainer(windows, asked, options.out, device=options.device)
    run.run_logged(minutes=options.minutes)
    if options.export:
        run.export(options.export)


def main(argv: list[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    parser = argparse.ArgumentParser(description="Train the default predictor.")
    add_predictor_options(parser, Settings)
    options = parser.parse_args(argv)
    return exit_code(lambda: train(Trainer, Settings, options))


if __name__ == "__main__":
    raise SystemExit(main())
