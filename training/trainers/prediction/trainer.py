"""The common base of predictor trainers: seeds, checkpoints, windows, averaged weights."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import Tensor

from training.core.loop import Loop
from training.trainers.prediction.rollout import with_own_past
from training.trainers.prediction.windows import Windows


class PredictionTrainer(Loop):
    """One training run, which resumes from its checkpoint.

    Everything random is drawn from the seed and the step number, so a run that stops and is started again
    with the same command goes on exactly as if it had never stopped.

    Args:
        windows: of the training data.
        settings: a dataclass with ``past``, ``future``, ``own_pasts``, ``steps``, ``batch``, ``seed`` and
            ``ema``; a checkpoint of other settings is refused.
        out: folder of the checkpoint ``last.safetensors``.
        device: "cpu" or "cuda".
    """

    def __init__(self, windows: Windows, settings: Any, out: Path, *, device: str = "cpu") -> None:
        self.windows, self.settings, self.out, self.device = windows, settings, out, device
        torch.manual_seed(settings.seed)
        self.build()
        self.restore(asdict(settings))

    @abstractmethod
    def build(self) -> None:
        """Makes networks and optimisers; runs once, under the run's seed."""

    def batch(self, part: int = 0) -> Tensor:
        """The windows (B, T, J, 3) of this step."""
        return self.windows.batch(self.settings.batch, (self.settings.seed, self.step, part)).to(self.device)

    def window(self) -> tuple[Tensor, Tensor, int]:
        """The windows (B, past + future, J, 3) of this step, in the order of the speed of their pasts.

        Returns:
            what is asked for, what was recorded, and how often the averaged network was applied to make the
            pasts of the former: 0 to ``own_pasts`` times, drawn for each step; where 0, both are the same.
        """
        s, windows = self.settings, self.batch()
        windows = windows[windows[:, : s.past].diff(dim=1).norm(dim=-1).mean((1, 2)).argsort()]
        if passes := int(np.random.default_rng((s.seed, self.step, 2)).integers(s.own_pasts + 1)):
            return *with_own_past(self.ema, windows, s.past, s.future, passes), passes
        windows = windows[:, : s.past + s.future]
        return windows, windows, 0
