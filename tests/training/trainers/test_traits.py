"""Traits: energy and tempo of a motion, beside what is usual for its acts."""

from __future__ import annotations

import math

import pytest
import torch
from torch import Tensor

from motion import SMPL22
from training.trainers.traits import MOST, beside_usual, measured

WRISTS = [SMPL22.joint_names.index(name) for name in ("left_wrist", "right_wrist")]


def waving(size: float, rate: float) -> Tensor:
    """Hands that swing ``size`` metres ``rate`` times a second, for three seconds."""
    positions = torch.zeros(90, 22, 3)
    positions[:, WRISTS, 0] = size * torch.sin(2 * math.pi * rate * torch.arange(90) / 30)[:, None]
    return positions


def test_larger_movements_have_more_energy_and_faster_ones_more_tempo() -> None:
    usual, large, fast = measured(torch.stack([waving(0.2, 1), waving(0.4, 1), waving(0.2, 2)]))
    assert large[0] - usual[0] == pytest.approx(math.log(2), abs=0.01)
    assert large[1] - usual[1] == pytest.approx(0, abs=0.01)
    assert fast[0] - usual[0] == pytest.approx(0, abs=0.05)
    assert fast[1] - usual[1] == pytest.approx(math.log(2), abs=0.05)


def test_a_motion_that_stands_still_has_finite_traits() -> None:
    assert measured(torch.zeros(30, 22, 3)).isfinite().all()


def test_what_the_acts_explain_is_taken_away() -> None:
    draw = torch.Generator().manual_seed(0)
    done = torch.eye(2).repeat(200, 1)
    values = 3.0 * done[:, :1] + torch.randn(400, 2, generator=draw)
    found = beside_usual(values, done)
    first, second = found[done[:, 0] == 1, 0], found[done[:, 1] == 1, 0]
    assert first.mean() - second.mean() == pytest.approx(0, abs=0.1)
    assert found.std(0).tolist() == pytest.approx([1, 1], abs=0.1)
    assert found.abs().max() <= MOST
