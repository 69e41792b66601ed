"""What the trainings of all predictors share: seeds, checkpoints, minutes, a log."""

from __future__ import annotations

import json
import time
from abc import ABC, abstractmethod
from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path
from typing import Any

import torch
from torch import Tensor, nn

from training import checkpoint
from training.prediction.windows import Windows


class PredictionTrainer(ABC):
    """One training run, which goes on from wherever its checkpoint stands.

    Everything random is drawn from the seed and the step number, so a run that stops and is started again
    with the same command goes on exactly as if it had never stopped.

    Args:
        windows: of the training data.
        settings: a dataclass with ``steps``, ``batch``, ``seed`` and ``ema``; a checkpoint of other settings
            is refused.
        out: folder of the checkpoint ``last.safetensors``.
        device: "cpu" or "cuda".
    """

    model: nn.Module
    ema: nn.Module

    def __init__(self, windows: Windows, settings: Any, out: Path, *, device: str = "cpu") -> None:
        self.windows, self.settings, self.out, self.device = windows, settings, out, device
        torch.manual_seed(settings.seed)
        self.build()
        self.settings_json = json.dumps(asdict(settings), sort_keys=True)
        out.mkdir(parents=True, exist_ok=True)
        self.step = checkpoint.restore(self.checkpoint, self.parts(), self.settings_json)

    @property
    def checkpoint(self) -> Path:
        return self.out / "last.safetensors"

    @abstractmethod
    def build(self) -> None:
        """Makes networks and optimisers; runs once, under the run's seed."""

    @abstractmethod
    def parts(self) -> dict[str, nn.Module | torch.optim.Optimizer]:
        """What a checkpoint holds; ``ema`` is the network that is kept in the end."""

    @abstractmethod
    def train_step(self) -> dict[str, float]:
        """One optimiser step; returns the loss terms and counts :attr:`step` up."""

    def batch(self, part: int = 0) -> Tensor:
        """The windows (B, T, J, 3) of this step."""
        return self.windows.batch(self.settings.batch, (self.settings.seed, self.step, part)).to(self.device)

    def average(self) -> None:
        """Moves the averaged network towards the current one."""
        decay = min(self.settings.ema, (self.step + 1) / (self.step + 10))
        with torch.no_grad():
            torch._foreach_lerp_(list(self.ema.parameters()), list(self.model.parameters()), 1 - decay)

    def save(self) -> None:
        checkpoint.save(self.checkpoint, self.parts(), self.step, self.settings_json)

    def run(self, *, minutes: float, save_every: float = 2.0) -> Iterator[dict[str, float]]:
        """Trains until the steps or the minutes are over; yields each step's terms; saves as it goes."""
        began = saved = time.monotonic()
        while self.step < self.settings.steps and time.monotonic() - began < minutes * 60:
            yield self.train_step()
            if time.monotonic() - saved > save_every * 60:
                self.save()
                saved = time.monotonic()
        self.save()

    def run_logged(self, *, minutes: float, every: int = 50) -> None:
        """:meth:`run`, with the mean of every so many steps printed and kept in ``log.jsonl``."""
        terms: list[dict[str, float]] = []
        began, first = time.monotonic(), self.step
        with open(self.out / "log.jsonl", "a") as file:
            for one in self.run(minutes=minutes):
                terms.append(one)
                if self.step % every and self.step < self.settings.steps:
                    continue
                pace = (time.monotonic() - began) / (self.step - first)
                mean = {name: round(sum(t[name] for t in terms) / len(terms), 5) for name in one}
                line = json.dumps({"step": self.step, "pace": round(pace, 3)} | mean)
                print(line, file=file, flush=True)
                print(line, flush=True)
                terms = []
