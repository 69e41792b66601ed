"""Toes of feet that swing."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from motion import SMPL22
from motion.swings import lift_swinging_feet

Array = NDArray[np.floating]
FPS = 30.0
ANKLE, TOE = SMPL22.index("right_ankle"), SMPL22.index("right_foot")


def step(length: float = 0.9, frames: int = 14, *, before: int = 10, hips: float = 0.0) -> Array:
    """(T, 22, 3) a person who stands facing +Z and takes one flat step with the right foot."""
    total = frames + 2 * before
    pose = np.zeros((22, 3))
    for parent, joint in SMPL22.bones:
        pose[joint] = pose[parent] + SMPL22.offsets[joint]
    pose[:, 1] -= pose[[10, 11], 1].min() - 0.02
    poses = np.repeat(pose[None], total, axis=0)
    share = np.clip((np.arange(total) - before) / frames, 0, 1)
    away = length * share**2 * (3 - 2 * share)
    poses[:, [ANKLE, TOE], 2] += away[:, None]
    poses[:, :, 2] += hips * np.arange(total)[:, None] / FPS
    return poses


def test_a_toe_passes_over_the_floor_and_is_up_before_the_foot_comes_down() -> None:
    poses = step()
    lifted = lift_swinging_feet(poses, FPS)[:, TOE, 1] - poses[:, TOE, 1]
    assert lifted[12:22].min() > 0.01
    assert 0.03 < lifted.max() < 0.08
    assert lifted[:7].max() < 1e-3 and lifted[-7:].max() < 1e-3


def test_only_toes_of_swinging_feet_move_and_bones_keep_their_length() -> None:
    poses = step()
    lifted = lift_swinging_feet(poses, FPS)
    others = [joint for joint in range(22) if joint != TOE]
    np.testing.assert_array_equal(lifted[:, others], poses[:, others])
    before, after = (np.linalg.norm(p[:, TOE] - p[:, ANKLE], axis=-1) for p in (poses, lifted))
    np.testing.assert_allclose(after, before, atol=1e-9)


def test_longer_steps_raise_the_toe_higher() -> None:
    short, long = ((lift_swinging_feet(step(length), FPS) - step(length))[:, TOE, 1].max() for length in (0.4, 1.0))
    assert long > 1.8 * short > 0.01


@pytest.mark.parametrize("forwards", [True, False])
def test_who_steps_backwards_does_not_come_down_on_the_heel(forwards: bool) -> None:
    poses = step(0.9 if forwards else -0.9)
    lifted = (lift_swinging_feet(poses, FPS) - poses)[:, TOE, 1]
    rises_again = lifted[21:23].mean() > lifted[17:20].mean()
    assert rises_again == forwards


@pytest.mark.parametrize(
    "still",
    [
        pytest.param(step(0.0), id="stands"),
        pytest.param(step(0.0, hips=1.0), id="glides with the body"),
        pytest.param(step(0.1), id="shifts a foot"),
        pytest.param(step() - [0, 0.5, 0], id="is not upright"),
        pytest.param(step(0.9, 50), id="drags it slowly"),
        pytest.param(step()[:2], id="two frames"),
    ],
)
def test_other_feet_stay(still: Array) -> None:
    np.testing.assert_array_equal(lift_swinging_feet(still, FPS), still)


def test_a_toe_that_is_high_enough_stays() -> None:
    poses = step()
    poses[10:24, [ANKLE, TOE], 1] += 0.2
    change = np.abs(lift_swinging_feet(poses, FPS) - poses)
    assert change[11:23].max() < 0.02
