"""The training loop that all networks share: time limit, checkpoints, log."""

from __future__ import annotations

import json
import math
import signal
import threading
import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import torch
from torch import Tensor, nn

from . import checkpoint
from .checkpoint import Parts


@contextmanager
def asked_to_end() -> Iterator[list[int]]:
    """A list that gets SIGINT or SIGTERM in place of what they do; outside the main thread it stays empty."""
    asked: list[int] = []
    if threading.current_thread() is not threading.main_thread():
        yield asked
        return
    signals = (signal.SIGINT, signal.SIGTERM)
    before = {number: signal.signal(number, lambda number, _: asked.append(number)) for number in signals}
    try:
        yield asked
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def warm_cosine(peak: float, step: int, *, warmup: int, steps: int) -> float:
    """The learning rate at ``step`` of ``steps``: a linear warm-up, then a cosine to 2 % of the peak."""
    warm = min(1.0, (step + 1) / warmup)
    return peak * warm * (0.51 + 0.49 * math.cos(math.pi * min(1.0, step / steps)))


def adamw(parameters: Iterable[nn.Parameter], settings: Any) -> torch.optim.AdamW:
    """The optimiser of most trainers, at the learning rate and weight decay of a run's settings."""
    return torch.optim.AdamW(parameters, lr=settings.learning_rate, weight_decay=settings.weight_decay, fused=True)


class Loop(ABC):
    """A run that counts its steps and can be stopped and saved after any of them.

    Attributes:
        settings: ``steps`` is the length of the run. :meth:`step_on` reads ``learning_rate``, ``warmup`` and ``ema``.
        out: folder of the checkpoint and of ``log.jsonl``.
        step: steps done so far.
        settings_json: the settings that a checkpoint must agree with.
        model, ema, optimizer: the network, its average, which is exported, and what trains it.
    """

    settings: Any
    out: Path
    step: int
    settings_json: str
    model: nn.Module
    ema: nn.Module
    optimizer: torch.optim.Optimizer

    @property
    def checkpoint(self) -> Path:
        """Path of the run's checkpoint."""
        return self.out / "last.safetensors"

    def parts(self) -> Parts:
        """The contents of a checkpoint, by name."""
        return {"model": self.model, "ema": self.ema, "optimizer": self.optimizer}

    def restore(self, settings: dict[str, Any]) -> None:
        """Resumes from the checkpoint, or begins at step 0 if there is none.

        Raises:
            InputError: if the checkpoint is damaged or was written under other settings.
        """
        self.settings_json = json.dumps(settings, sort_keys=True)
        self.out.mkdir(parents=True, exist_ok=True)
        self.step = checkpoint.restore(self.checkpoint, self.parts(), self.settings_json)

    def save(self) -> None:
        """Writes the checkpoint."""
        checkpoint.save(self.checkpoint, self.parts(), self.step, self.settings_json)

    @abstractmethod
    def train_step(self) -> dict[str, float]:
        """Takes one optimiser step and counts it; returns the loss terms."""

    def step_on(self, terms: dict[str, Tensor], *, clip: float = 1.0) -> dict[str, float]:
        """Takes an optimiser step that lowers the sum of the loss terms, and counts it; the terms and their sum.

        The learning rate is that of :func:`warm_cosine`, and the joint norm of all gradients is clipped to ``clip``.
        """
        s, values = self.settings, torch.stack(list(terms.values()))
        total = values.sum()
        for group in self.optimizer.param_groups:
            group["lr"] = warm_cosine(s.learning_rate, self.step, warmup=s.warmup, steps=s.steps)
        self.optimizer.zero_grad(set_to_none=True)
        total.backward()
        nn.utils.clip_grad_norm_([p for p in self.model.parameters() if p.requires_grad], clip)
        self.optimizer.step()
        self.step += 1
        self.average()
        numbers = torch.cat([values, total[None]]).tolist()  # a GPU is waited for once
        return dict(zip([*terms, "total"], numbers, strict=True))

    @torch.no_grad()
    def average(self) -> None:
        """Updates the moving average of weights and norms; its decay grows to ``settings.ema`` over the first steps."""
        decay = min(self.settings.ema, (self.step + 1) / (self.step + 10))
        kept, current = (
            [value for value in network.state_dict().values() if value.is_floating_point()]
            for network in (self.ema, self.model)
        )
        torch._foreach_lerp_(kept, current, 1 - decay)

    def run(self, *, minutes: float, save_every: float = 5.0) -> Iterator[dict[str, float]]:
        """Trains until the steps or the minutes are over, or somebody asks the process to end (Ctrl+C, SIGTERM).

        Yields each step's loss terms; saves regularly, and after the last step.
        """
        began = saved = time.monotonic()
        with asked_to_end() as asked:
            while self.step < self.settings.steps and time.monotonic() - began < minutes * 60 and not asked:
                yield self.train_step()
                if time.monotonic() - saved > save_every * 60:
                    self.save()
                    saved = time.monotonic()
        self.save()

    def run_logged(self, *, minutes: float, every: int = 50, after: Callable[[], None] | None = None) -> None:
        """:meth:`run`, with means over every ``every`` steps printed and appended to ``log.jsonl``.

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
