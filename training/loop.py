"""The loop of a training run, the same for every network: time, checkpoints, log."""

from __future__ import annotations

import json
import math
import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any


def warm_cosine(peak: float, step: int, *, warmup: int, steps: int) -> float:
    """The learning rate at ``step`` of ``steps``: a linear warm-up, then a cosine to 2 % of the peak."""
    warm = min(1.0, (step + 1) / warmup)
    return peak * warm * (0.51 + 0.49 * math.cos(math.pi * min(1.0, step / steps)))


class Loop(ABC):
    """A run that counts its steps and can be stopped and saved between any two.

    Attributes:
        settings: whose ``steps`` end the run.
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
