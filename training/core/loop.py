"""The training loop that all networks share: time limit, checkpoints, log, precision, and batches drawn ahead."""

from __future__ import annotations

import copy
import json
import math
import signal
import threading
import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from dataclasses import asdict, fields, is_dataclass, replace
from pathlib import Path
from queue import Queue
from typing import Any, TypeVar

import torch
from torch import Tensor, nn
from torch.utils.data import DataLoader, Dataset

from models.compiled import has_bfloat16
from models.weights_io import save_network

from . import checkpoint
from .checkpoint import Parts

SAVE_EVERY = 300.0
"""Seconds between two checkpoints of a run."""


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

    def start(self, model: nn.Module, device: str = "cpu") -> None:
        """Takes a network with its average and its optimiser, as it is or as the run's checkpoint has it."""
        self.model = model.to(device)
        self.ema = copy.deepcopy(self.model).eval().requires_grad_(False)
        self.optimizer = self.optimizer_of(self.model)
        self.restore(asdict(self.settings))

    def optimizer_of(self, model: nn.Module) -> torch.optim.Optimizer:
        """AdamW at the learning rate and weight decay of the run's settings."""
        s, learned = self.settings, [p for p in model.parameters() if p.requires_grad]
        return torch.optim.AdamW(learned, lr=s.learning_rate, weight_decay=s.weight_decay, fused=True)

    def export(self, folder: Path) -> None:
        """Writes the averaged network as it is shipped."""
        save_network(folder, self.ema, trained_steps=self.step)

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

    def rate(self) -> float:
        """The learning rate of this step: a linear warm-up, then a cosine to 2 % of the peak."""
        s = self.settings
        warm = min(1.0, (self.step + 1) / s.warmup)
        return s.learning_rate * warm * (0.51 + 0.49 * math.cos(math.pi * min(1.0, self.step / s.steps)))

    def step_on(self, terms: dict[str, Tensor], *, clip: float = 1.0) -> dict[str, float]:
        """Takes an optimiser step that lowers the sum of the loss terms, and counts it; the terms and their sum.

        The learning rate is that of :meth:`rate`, and the joint norm of all gradients is clipped to ``clip``.
        """
        values = torch.stack(list(terms.values()))
        total = values.sum()
        for group in self.optimizer.param_groups:
            group["lr"] = self.rate()
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

    def run(self, *, minutes: float) -> Iterator[dict[str, float]]:
        """Trains until the steps or the minutes are over, or somebody asks the process to end (Ctrl+C, SIGTERM).

        Yields each step's loss terms; saves regularly, and after the last step.
        """
        began = saved = time.monotonic()
        with asked_to_end() as asked:
            while self.step < self.settings.steps and time.monotonic() - began < minutes * 60 and not asked:
                yield self.train_step()
                if time.monotonic() - saved > SAVE_EVERY:
                    self.save()
                    saved = time.monotonic()
        self.save()

    def run_logged(self, *, minutes: float, every: int = 50) -> None:
        """:meth:`run`, with means over every ``every`` steps printed and appended to ``log.jsonl``."""
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


def fit(
    module: nn.Module, loss: Callable[[int], Tensor], steps: int, *, rate: float, weight_decay: float, every: int = 0
) -> None:
    """Lowers a loss in one go, for small networks: AdamW with a one-cycle learning rate (Smith and Topin 2019).

    Args:
        module: afterwards in eval mode, without gradients.
        loss: of a step.
        rate: the highest learning rate.
        every: steps from one line of progress to the next; 0 prints none.
    """
    optimizer = torch.optim.AdamW(module.parameters(), lr=rate, weight_decay=weight_decay)
    schedule = torch.optim.lr_scheduler.OneCycleLR(optimizer, rate, total_steps=steps, pct_start=0.1)
    began = time.monotonic()
    module.train()
    for step in range(steps):
        value = loss(step)
        optimizer.zero_grad(set_to_none=True)
        value.backward()
        nn.utils.clip_grad_norm_(module.parameters(), 1.0)
        optimizer.step()
        schedule.step()
        if every and (step + 1) % every == 0:
            pace = (time.monotonic() - began) / (step + 1)
            print(json.dumps({"step": step + 1, "pace": round(pace, 3), "loss": round(value.item(), 4)}), flush=True)
    module.eval().requires_grad_(False)


def mixed_precision(device: str) -> AbstractContextManager[object]:
    """Autocast to bfloat16 on a GPU, or on a CPU with AVX-512 BF16 or AMX.

    On another CPU, bfloat16 products are emulated and take three times as long as float32.
    """
    kind = torch.device(device).type
    return nullcontext() if kind == "cpu" and not has_bfloat16() else torch.autocast(kind, torch.bfloat16)


# ---- batches that are drawn ahead ----------------------------------------------------------------


Drawn = TypeVar("Drawn")


class _Steps(Dataset[Drawn]):
    def __init__(self, draw: Callable[[int], Drawn]) -> None:
        self.draw = draw

    def __getitem__(self, step: int) -> Drawn:
        return self.draw(step)


def _one_thread(_: int) -> None:
    torch.set_num_threads(1)


def drawn_ahead(draw: Callable[[int], Drawn], steps: range, workers: int, device: str) -> Iterator[Drawn]:
    """``draw(step)`` of every step on a device, in order.

    Args:
        draw: must use the CPU alone and give the same for the same step.
        workers: processes that draw, each four steps ahead. A thread brings the next two steps to the device.
    """
    # Tensors are passed as files in memory: a process may not open as many descriptors as these need.
    torch.multiprocessing.set_sharing_strategy("file_system")
    loader = DataLoader(
        _Steps(draw),
        sampler=steps,
        batch_size=None,
        num_workers=workers,
        prefetch_factor=4,
        multiprocessing_context="fork",
        worker_init_fn=_one_thread,
    )
    ready: Queue[Drawn | Exception | None] = Queue(maxsize=2)

    def bring() -> None:
        try:
            for drawn in loader:
                ready.put(moved(drawn, device))
            ready.put(None)
        except Exception as error:  # of a worker: raised where the step is taken
            ready.put(error)

    threading.Thread(target=bring, daemon=True).start()
    while (drawn := ready.get()) is not None:
        if isinstance(drawn, Exception):
            raise drawn
        yield drawn


def moved(value: Drawn, device: str) -> Drawn:
    """The same tensor or dataclass with all tensors in it on a device."""
    if isinstance(value, Tensor):
        return value.to(device, non_blocking=True)
    if is_dataclass(value) and not isinstance(value, type):
        return replace(value, **{f.name: moved(getattr(value, f.name), device) for f in fields(value)})
    return value
