"""The common part of trainers on prepared scenes: draws that are the same everywhere, noise, and InterGen's losses.

Everything random is drawn from the seed and the step number, so a run that stops (``--minutes``, Ctrl+C) and
is started again with the same command goes on exactly as if it had never stopped.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import torch
from torch import Tensor

from models.diffusion import NoiseSchedule
from models.intergen.losses import InterGenLoss, simple_loss
from models.known import Held
from models.motion_tokens import FEATURES, TokenLayout
from training.core.loop import Loop, drawn_ahead, moved
from training.trainers.intergen_data import Batch, Data, seeded


def draw_timesteps(size: int, timesteps: int, noisiest: float, generator: torch.Generator) -> Tensor:
    """(size,) timesteps: a share ``noisiest`` from the last tenth, the others from all.

    A motion's tokens say much the same, so its outline shines through all but the strongest noise: at
    t = 0.95 T a network without words already sees which gesture a scene holds. What the words decide is
    learned above, which is 5 % of uniform draws.
    """
    t = torch.randint(timesteps, (size,), generator=generator)
    late = timesteps - 1 - torch.randint(max(timesteps // 10, 1), (size,), generator=generator)
    return torch.where(torch.rand(size, generator=generator) < noisiest, late, t)


def feature_weights(root_weight: float, layout: TokenLayout) -> Tensor:
    """Factors of a token's numbers in the loss: the three of 70 that say where a person stands count more."""
    weights = torch.ones(FEATURES)
    weights[:3] = root_weight**0.5
    return weights.repeat(layout.knots_per_token)


@dataclass
class Drawn:
    """All that a step draws on the CPU: a batch, timesteps (B,), what is given, and drafts, where they are read."""

    batch: Batch
    t: Tensor
    hold: Held | None = None
    draft: Tensor | None = None


class SceneTrainer(Loop):
    """A run on batches of scenes.

    Attributes:
        data: what batches are drawn from.
        workers: processes that draw batches ahead; 0 draws each when it is needed.
    """

    device: str
    data: Data
    schedule: NoiseSchedule
    workers = 0
    _ahead: Iterator[Any] | None = None

    @abstractmethod
    def terms(self, drawn: Drawn, noise: Tensor) -> dict[str, Tensor]:
        """Every loss term of what was drawn, weighted."""

    def draw(self, step: int) -> Drawn:
        """All that a step draws, on the CPU; the same for the same seed and step."""
        batch, generator = self.data.batch(step), seeded(self.settings.seed, 3, step)
        return Drawn(batch, draw_timesteps(len(batch.x0), self.schedule.timesteps, self.settings.noisiest, generator))

    def next_draw(self) -> Any:
        """The draw of this step, on the device."""
        if self.workers and self._ahead is None:
            steps = range(self.step, self.settings.steps)
            self._ahead = drawn_ahead(self.draw, steps, self.workers, self.device)
        drawn = moved(self.draw(self.step), self.device) if self._ahead is None else next(self._ahead)
        return replace(drawn, batch=self.data.on_device(drawn.batch))

    def normal(self, like: Tensor, use: int = 5) -> Tensor:
        """Standard normal numbers of a tensor's shape for a use of this step, drawn on the device."""
        seed = seeded(self.settings.seed, use, self.step).initial_seed()
        generator = torch.Generator(self.device).manual_seed(seed)
        return torch.randn(like.shape, generator=generator, device=self.device)

    def train_step(self) -> dict[str, float]:
        """One optimiser step; returns the loss terms."""
        drawn = self.next_draw()
        torch.manual_seed(seeded(self.settings.seed, 4, self.step).initial_seed())  # dropout
        self.model.train()
        return self.step_on(self.terms(drawn, self.normal(drawn.batch.x0)))


class DuetTrainer(SceneTrainer):
    """A run that makes both people, with InterGen's losses: eq. 8 with more weight on where people stand, the
    regularisers of eq. 11–14 on positions at 30 fps, and their damping of eq. 15."""

    model: Any
    ema: Any

    def begin(self, settings: Any, out: Path, data: Data, device: str, workers: int = 0) -> None:
        """Prepares data, noise schedule and losses."""
        self.settings, self.out, self.data, self.device, self.workers = settings, out, data, device, workers
        self.schedule = NoiseSchedule(device=device)
        self.loss = InterGenLoss(
            settings.weights, t_bar=round(settings.t_bar * self.schedule.timesteps), near_by="truth"
        )
        self.feature_weights = feature_weights(settings.root_weight, data.scenes.layout).to(device)

    def simple(self, made: Tensor, wanted: Tensor, batch: Batch) -> Tensor:
        """Eq. 8 on clean motions (B, tokens, 2F), with more weight on where people stand."""
        weighted = [x.view(*x.shape[:2], 2, -1) * self.feature_weights for x in (made, wanted)]
        return simple_loss(*weighted, batch.mask)

    def motion_terms(self, made: Tensor, wanted: Tensor, t: Tensor, batch: Batch) -> dict[str, Tensor]:
        """The losses of clean motions (B, tokens, 2F) against those that are wanted, weighted and damped."""
        terms = {"simple": self.simple(made, wanted, batch)}
        # Motions above the threshold have no part in the regularisers; one keeps the terms there, at zero.
        chosen = (t <= self.loss.t_bar).nonzero()[:, 0] if (t <= self.loss.t_bar).any() else t.argmin()[None]
        positions = [self.model.positions(x[chosen])[0].transpose(1, 2) for x in (made, wanted)]
        return terms | self.loss.regularizers(*positions, t[chosen], batch.frame_mask[chosen])
