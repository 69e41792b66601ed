"""A partner's own attention: turning, looking and walking with feet that step, and giving it all back."""

from __future__ import annotations

import numpy as np
import pytest

from motion import SMPL22
from motion.kinematics import bone_lengths
from motion.steering import REST_FROM, TURN_UNTIL, Goal, Steering
from motion.transforms import heading, heading_matrix
from tests.inference.people import waver

STANDING = waver(1.0).positions[0] @ heading_matrix(-np.radians(50)).T
STANDING = STANDING - STANDING[0] * [1, 0, 1]
"""Somebody at the origin who faces +Z."""
ANKLES = [SMPL22.index("left_ankle"), SMPL22.index("right_ankle")]


def steered(goal: Goal | None, frames: int, steering: Steering | None = None) -> np.ndarray:
    steering = steering or Steering()
    return np.stack([steering(STANDING, goal) for _ in range(frames)])


def at(degrees: float, metres: float = 3.0) -> np.ndarray:
    return metres * np.array([np.sin(np.radians(degrees)), 0.0, np.cos(np.radians(degrees))])


@pytest.mark.parametrize("side", [-1, 1])
@pytest.mark.parametrize("degrees", [60, 120, 175])
def test_it_turns_to_somebody_in_steps(degrees: float, side: int) -> None:
    made = steered(Goal(at(side * degrees)), 90)
    off = np.degrees(np.abs(heading(made) - np.radians(side * degrees)))
    assert off[-1] <= np.degrees(TURN_UNTIL) + 1
    assert np.abs(np.diff(heading(made))).max() < np.radians(5), "it does not snap round"
    moved = np.linalg.norm(np.diff(made[:, ANKLES], axis=0), axis=-1)
    assert (moved.min(axis=1) < 0.2 * REST_FROM).all(), "one foot stands, but for what is left in the end"
    assert moved.max() > 0.01
    np.testing.assert_allclose(bone_lengths(made) - bone_lengths(STANDING), 0, atol=1e-6)
    np.testing.assert_allclose(made[:, 0] - STANDING[0], 0, atol=0.04)  # a wide stand is a lower one


def test_it_walks_off_with_its_back_to_somebody() -> None:
    made = steered(Goal(at(0), away=True, walk=True), 150)
    assert abs(heading(made)[-1]) > np.radians(170)
    assert made[-1, 0, 2] < -1.5, "two metres and a half in five seconds, less the turn"
    assert np.diff(made[:, 0, 2]).max() < 1e-9, "never towards them"
    ankles = made[60:, ANKLES]
    moved = np.linalg.norm(np.diff(ankles, axis=0), axis=-1)
    assert (moved.min(axis=1) < 1e-6).all(), "one foot stands while the body goes on"
    assert moved.max() < 0.2
    before = (ankles[..., 2] < made[60:, :1, 2] - 0.03).any(axis=1).mean()
    behind = (ankles[..., 2] > made[60:, :1, 2] + 0.03).any(axis=1).mean()
    assert before > 0.25 and behind > 0.25, "feet are before the body and behind it in turn"


def test_turn_and_place_are_given_back_in_steps_without_a_jump() -> None:
    steering = Steering()
    before = steered(Goal(at(90), walk=True), 90, steering)
    after = steered(None, 150, steering)
    whole = np.concatenate([before[-1:], after])
    assert np.linalg.norm(np.diff(whole, axis=0), axis=-1).max() < 0.2
    assert steering.idle
    assert after[-1] is not STANDING and np.array_equal(after[-1], STANDING)
