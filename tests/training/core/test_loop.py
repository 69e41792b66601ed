"""The training loop: learning rate, averages, and a run that stops and resumes."""

import json
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest
import torch
from torch import nn

from training.core.loop import Loop

ROOT = Path(__file__).resolve().parents[3]


class Line(Loop):
    """Fits a line to two points; every step is the same function of the weights."""

    def __init__(self, out: Path, steps: int) -> None:
        self.settings = SimpleNamespace(steps=steps, learning_rate=0.1, warmup=2, weight_decay=0.0, ema=0.9)
        self.out = out
        torch.manual_seed(0)
        self.model, self.ema = nn.Linear(1, 1), nn.Linear(1, 1).requires_grad_(False)
        self.ema.load_state_dict(self.model.state_dict())
        self.optimizer = self.optimizer_of(self.model)
        self.restore({"steps": 20})

    def train_step(self) -> dict[str, float]:
        x = torch.tensor([[0.0], [1.0]])
        loss = (self.model(x) - 3 * x - 1).square().mean()
        return self.step_on({"loss": loss})


def test_learning_rate_warms_up_and_falls_to_two_percent(tmp_path: Path) -> None:
    run, rates = Line(tmp_path, 100), []
    for run.step in range(101):
        rates.append(run.rate())
    assert rates[0] == pytest.approx(0.05) and max(rates) == pytest.approx(0.1, abs=0.001)
    assert rates[100] == pytest.approx(0.002) and rates[20:] == sorted(rates[20:], reverse=True)


def test_a_run_that_stops_resumes_as_if_it_had_not(tmp_path: Path) -> None:
    whole = Line(tmp_path / "whole", 20)
    losses = [step["loss"] for step in whole.run(minutes=1)]
    assert len(losses) == 20 and losses[-1] < losses[0] / 2
    first = Line(tmp_path / "parts", 20)
    begun = [first.train_step()["loss"] for _ in range(8)]
    first.save()
    second = Line(tmp_path / "parts", 20)
    assert second.step == 8
    assert begun + [step["loss"] for step in second.run(minutes=1)] == losses
    assert torch.equal(second.ema.weight, whole.ema.weight)
    assert not torch.equal(second.ema.weight, second.model.weight)


def test_log_has_means_over_its_steps(tmp_path: Path) -> None:
    run = Line(tmp_path, 20)
    run.run_logged(minutes=1, every=10)
    lines = [json.loads(line) for line in (tmp_path / "log.jsonl").read_text().splitlines()]
    assert [line["step"] for line in lines] == [10, 20]
    assert lines[0]["loss"] > lines[1]["loss"]


ENDED = """
import os, signal, sys
from pathlib import Path
from tests.training.core.test_loop import Line

for number in (signal.SIGINT, signal.SIGTERM):
    before = signal.getsignal(number)
    run = Line(Path(sys.argv[1]) / number.name, 20)
    for _ in run.run(minutes=1):
        if run.step == 7:
            os.kill(os.getpid(), number)
    print(run.step, signal.getsignal(number) is before)
"""
"""Runs that send themselves a signal at step 7, in a process of their own: no worker of the tests ends with it."""


def test_a_run_that_is_asked_to_end_saves_its_last_step(tmp_path: Path) -> None:
    command = [sys.executable, "-c", ENDED, str(tmp_path)]
    ended = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=200)
    assert (ended.returncode, ended.stdout) == (0, "7 True\n7 True\n"), ended.stderr
    assert [Line(tmp_path / name, 20).step for name in ("SIGINT", "SIGTERM")] == [7, 7]
