"""The loop of a training run, the same for every network: time, checkpoints, log."""

from __future__ import annotations

import json
import math
import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any

import torch
from torch import Tensor, nn


def warm_cosine(peak: float, step: int, *, warmup: int, steps: int) -> float:
    """The learning rate at ``step`` of ``steps``: a linear warm-up, then a cosine to 2 % of the peak."""
    warm = min(1.0, (step + 1) / warmup)
    return peak * warm * (0.51 + 0.49 * math.cos(math.pi * min(1.0, step / steps)))


class Loop(ABC):
    """A run that counts its steps and can be stopped and saved between any two.

    Attributes:
        settings: whose ``steps`` end the run; :meth:`descend` and :meth:`follow` read ``learning_rate``,
            ``warmup`` and ``ema``.
        out: folder of the checkpoint and of ``log.jsonl``.
        step: steps done so far.
    """

    settings: Any
    out: Path
    step: int

    @abstractmethod
    def train_step(self) -> dict[str, float]:
        """One optimiser step, which counts itself; returns the loss terms."""

    @abstractmethod
    def save(self) -> None:
        """Writes the checkpoint."""

    def descend(
        self,
        loss: Tensor,
        optimizer: torch.optim.Optimizer,
        trained: Iterable[nn.Parameter],
        *,
        clip: float = 1.0,
    ) -> None:
        """One step down a loss at the rate of :func:`warm_cosine`, which counts as one of the run.

        Args:
            trained: parameters whose gradients are clipped to a norm of ``clip`` together.
        """
        s = self.settings
        rate = warm_cosine(s.learning_rate, self.step, warmup=s.warmup, steps=s.steps)
        for group in optimizer.param_groups:
            group["lr"] = rate
        optimizer.zero_grad(set_to_none=True)
        loss.backward()
        nn.utils.clip_grad_norm_(list(trained), clip)
        optimizer.step()
        self.step += 1

    @torch.no_grad()
    def follow(self, averaged: Iterable[Tensor], current: Iterable[Tensor]) -> None:
        """Moves averages of weights towards the current ones, faster at first than ``settings.ema`` says."""
        decay = min(self.settings.ema, (self.step + 1) / (self.step + 10))
        torch._foreach_lerp_(list(averaged), list(current), 1 - decay)

    def run(self, *, minutes: float, save_every: float = 5.0) -> Iterator[dict[str, float]]:
        """Trains until the steps or the minutes are over; yields each step's terms; saves as it goes."""
        began = saved = time.monotonic()
        while self.step < self.settings.steps and time.monotonic() - began < minutes * 60:
            yield self.train_step()
            if time.monotonic() - saved > save_every * 60:
                self.save()
                saved = time.monotonic()
        self.save()

    def run_logged(self, *, minutes: float, every: int = 50, after: Callable[[], None] | None = None) -> None:
        """:meth:`run`, with the mean of every so many steps printed and kept in ``log.jsonl``.

        Args:
            after: called after every step.
        """
        terms: list[dict[str, float]] = []
        began, first = time.monotonic(), self.step
        with open(self.out / "log.jsonl", "a") as file:
            for one in self.run(minutes=minutes):
                terms.append(one)
                if self.step % every == 0 or self.step == self.settings.steps:
                    pace = (time.monotonic() - began) / (self.step - first)
                    mean = {name: round(sum(t[name] for t in terms) / len(terms), 5) for name in one}
                    line = json.dumps({"step": self.step, "pace": round(pace, 3)} | mean)
                    print(line, file=file, flush=True)
                    print(line, flush=True)
                    terms = []
                if after:
                    after()
