"""Trains PredictiveMA-WGAN: ``python -m training.trainers.mawgan --data CORPUS --out RUN``.

Chopin's thesis, Algorithm 2 and section 2.5.2: Adam at 1e-4, batches of 64, β = (1, 1, 10, 10), gradient
penalty 10. Where the thesis and its release differ, the release is the default: four critic steps a predictor
step (Algorithm 2: ``--critic-steps 1``) and a critic of stride 2 (section 2.4.1: ``--critic-stride 1``).
``--fc`` and ``--width`` make the network smaller than the thesis' one, which a CPU cannot train. ``--lean`` is
what a CPU trains in an hour: ``LEAN`` below says what it changes.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import torch
from torch import Tensor, nn

from models.mawgan.losses import (
    MAWGANLossWeights,
    bone_loss,
    critic_loss,
    position_loss,
    reconstruction_loss,
    skeleton_loss,
)
from models.mawgan.network import Critic, MAWGANConfig, PredictiveMAWGAN, to_curves, to_positions
from models.mawgan.srvf import exp_map, karcher_mean, log_map, to_srvf
from models.weights_io import common
from motion import SMPL22, InputError
from training.core.shell import at_least
from training.trainers.prediction import PredictionTrainer, train


@dataclass(frozen=True)
class Settings(MAWGANLossWeights):
    """The settings of a run, with the weights of its losses; a checkpoint of others is refused.

    width: channels of the predictor's first block (thesis: 512), halved in each further block; the critic's first
        has an eighth of it, halved likewise.
    linear, length: as in :class:`~models.mawgan.network.MAWGANConfig`.
    final_rate: share of the learning rate at which its cosine schedule ends; 1 keeps it constant, as in the thesis.
    """

    past: int = 30
    future: int = 30
    fc: int = 36_864
    width: int = 512
    critic_fc: int = 1024
    critic_stride: int = 2
    critic_steps: int = 4
    batch: int = 64
    steps: int = 20_000
    learning_rate: float = 1e-4
    final_rate: float = 1.0
    ema: float = 0.99
    linear: bool = False
    length: bool = False
    seed: int = 0

    def __post_init__(self) -> None:
        if self.width % 8 or self.width < 32:
            raise InputError(f"width is {self.width}: give a multiple of 8, 32 or more.")
        at_least(self, past=2, future=2, fc=2, batch=2, critic_steps=1, critic_stride=1)

    def network(self, joints: int) -> MAWGANConfig:
        """The sizes of predictor and critic."""
        channels, critic = tuple(self.width >> i for i in range(4)), tuple(self.width // 8 >> i for i in range(3))
        return MAWGANConfig(joints, **common(self, MAWGANConfig), channels=channels, critic=critic)


LEAN = {
    "fc": 1024,
    "width": 32,
    "critic_fc": 128,
    "critic_steps": 1,
    "learning_rate": 1e-3,
    "final_rate": 0.02,
    "ema": 0.995,
    "position": 100.0,
    "linear": True,
    "length": True,
    "steps": 1500,
}
"""Settings of a run that a share of one CPU core finishes in an hour."""


class Trainer(PredictionTrainer):
    """Trains predictor and critic against each other."""

    kind = "mawgan"
    settings: Settings
    model: PredictiveMAWGAN
    ema: PredictiveMAWGAN

    def network(self) -> nn.Module:
        """The predictor as a run begins, with the means of the training data; makes the critic, too."""
        s = self.settings
        config = s.network(SMPL22.num_joints)
        model, self.critic = PredictiveMAWGAN(config).to(self.device), Critic(config).to(self.device)
        self.critic_optimizer = self.optimizer_of(self.critic)
        if not self.checkpoint.exists():
            past, future = self.curves(self.windows.batch(512, (s.seed, 0, 1)).to(self.device))
            model.past_mean.copy_(karcher_mean(moving(past)))
            model.future_mean.copy_(karcher_mean(moving(future)))
        return model

    def optimizer_of(self, model: nn.Module) -> torch.optim.Optimizer:
        """Adam, as in section 2.5.2."""
        rate = self.settings.learning_rate
        return torch.optim.AdamW(model.parameters(), lr=rate, betas=(0.5, 0.9), weight_decay=0.0, fused=True)

    def parts(self) -> dict[str, nn.Module | torch.optim.Optimizer]:
        """The contents of a checkpoint, by name."""
        return super().parts() | {"critic": self.critic, "critic_optimizer": self.critic_optimizer}

    def curves(self, windows: Tensor) -> tuple[Tensor, Tensor]:
        """Past (B, past, D), and the future with the last pose before it (B, future + 1, D)."""
        s, curves = self.settings, to_curves(windows)
        return curves[:, : s.past], curves[:, s.past - 1 : s.past + s.future]

    def pairs(self, windows: Tensor) -> tuple[Tensor, Tensor, Tensor]:
        """(B,) which windows (B, past + future, J, 3) move; the past curves and the real futures' tangent
        vectors of those."""
        past, future = self.curves(windows)
        moves = (to_srvf(past)[1] > _STILL) & (to_srvf(future)[1] > _STILL)
        real = log_map(self.model.future_mean, to_srvf(future[moves])[0])
        return moves, past[moves], real

    def seen(self, s: Tensor) -> Tensor:
        """Tangent vectors as the critic sees them: taken to the sphere and back (eq. 2.5, 2.7)."""
        mean = self.model.future_mean
        return log_map(mean, exp_map(mean, s))

    def rate(self) -> float:
        """The learning rate of this step: a cosine down to the share ``final_rate``."""
        s = self.settings
        share = s.final_rate + (1 - s.final_rate) * 0.5 * (1 + math.cos(math.pi * min(1, self.step / s.steps)))
        return s.learning_rate * share

    def critic_steps(self, real: Tensor, made: Tensor) -> Iterator[float]:
        """Trains the critic; yields its losses.

        Args:
            real, made: (B, future + 1, D) tangent vectors of the predictor's own batch, which the last critic
                step shares with it; the steps before it draw theirs.
        """
        for i in reversed(range(self.settings.critic_steps)):
            if i:
                _, past, own = self.pairs(self.batch(i))
                with torch.no_grad():
                    pair = own, self.seen(self.model.generate(past)[0])
            else:
                pair = real, made
            rng = np.random.default_rng((self.settings.seed, self.step, 100 + i))
            share = torch.from_numpy(rng.random(len(pair[0]), dtype=np.float32)).to(real)
            loss = critic_loss(self.critic, *pair, share, penalty=self.settings.gradient_penalty)
            self.critic_optimizer.zero_grad(set_to_none=True)
            loss.backward()
            self.critic_optimizer.step()
            yield loss.item()

    def train_step(self) -> dict[str, float]:
        """Takes one optimizer step; returns each loss by name."""
        weights = self.settings
        for group in self.critic_optimizer.param_groups:
            group["lr"] = self.rate()
        windows = self.batch()
        moves, past, real = self.pairs(windows)
        truth = windows[moves, self.settings.past :]
        s, longer = self.model.generate(past)
        made = self.seen(s)
        critic = list(self.critic_steps(real, made.detach())) if weights.adversarial else [0.0]
        positions = to_positions(self.model.decode(s, longer, past))
        terms = {
            "reconstruction": weights.reconstruction * reconstruction_loss(made, real),
            "skeleton": weights.skeleton * skeleton_loss(positions, truth),
            "bone": weights.bone * bone_loss(positions, truth, list(SMPL22.bones)),
            "position": weights.position * position_loss(positions, truth),
        }
        if weights.adversarial:
            terms["adversarial"] = -weights.adversarial * self.critic(made).mean()
        error = (positions - truth).norm(dim=-1).mean().item()
        return self.step_on(terms, clip=10.0) | {"critic": sum(critic) / len(critic), "mm": 1000 * error}


_STILL = 1e-3
"""Metres: a window in which all joints together move less counts as still."""


def moving(curves: Tensor) -> Tensor:
    """SRVFs of the curves that move."""
    q, length = to_srvf(curves)
    return q[length > _STILL]


def main(argv: list[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    return train(argv, __doc__, Settings, Trainer, lean=LEAN)


if __name__ == "__main__":
    raise SystemExit(main())
