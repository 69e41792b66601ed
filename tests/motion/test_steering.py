"""A partner's own attention: turning, looking and walking with feet that step, and giving it all back."""

from __future__ import annotations

import numpy as np
import pytest

from motion import SMPL22
from motion.steering import REST_FROM, TURN_FROM, TURN_UNTIL, Goal, Steering
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


def bones(poses: np.ndarray) -> np.ndarray:
    parents, children = (list(ends) for ends in zip(*SMPL22.bones, strict=True))
    return np.linalg.norm(poses[:, children] - poses[:, parents], axis=-1)


def test_without_a_goal_nothing_changes() -> None:
    assert all(pose is STANDING for pose in (Steering()(STANDING, None), Steering()(STANDING, None)))


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
    np.testing.assert_allclose(bones(made), np.broadcast_to(bones(STANDING[None]), bones(made).shape), atol=1e-6)
    np.testing.assert_allclose(made[:, 0] - STANDING[0], 0, atol=0.04)  # a wide stand is a lower one


def test_to_somebody_nearly_ahead_only_the_head_turns() -> None:
    degrees = np.degrees(TURN_FROM) - 5
    made = steered(Goal(at(degrees)), 60)
    others = [joint for joint in range(22) if joint != SMPL22.index("head")]
    np.testing.assert_allclose(made[:, others] - STANDING[others], 0, atol=1e-12)
    head = made[:, SMPL22.index("head")] - made[:, SMPL22.index("neck")]
    before = STANDING[SMPL22.index("head")] - STANDING[SMPL22.index("neck")]
    np.testing.assert_allclose(head[-1], heading_matrix(np.radians(degrees)) @ before, atol=1e-6)
    assert np.linalg.norm(np.diff(made, axis=0), axis=-1).max() < 0.05
    np.testing.assert_allclose(steered(Goal(at(degrees), look=False), 60)[-1], STANDING, atol=1e-12)


@pytest.mark.parametrize("degrees", [90, -130, 170])
def test_no_head_turns_farther_than_a_neck_does(degrees: float) -> None:
    made = steered(Goal(at(degrees)), 90)
    neck, head = SMPL22.index("neck"), SMPL22.index("head")
    before = (STANDING[head] - STANDING[neck])[[0, 2]]
    turned = []
    for pose, body in zip(made, heading(made), strict=True):
        now = (heading_matrix(-float(body)) @ (pose[head] - pose[neck]))[[0, 2]]
        turned.append(np.degrees(np.arctan2(now[0], now[1]) - np.arctan2(before[0], before[1])))
    off = np.abs((np.array(turned) + 180) % 360 - 180)
    assert 20 < off.max() < 70, "it looks ahead of its body, and not over its back"


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


def test_it_goes_on_from_what_is_shown_with_another_pose_of_the_network() -> None:
    steering = Steering()
    shown = steered(Goal(at(100)), 60, steering)[-1]
    other = STANDING @ heading_matrix(0.4).T + [0.3, 0, -0.2]
    steering.takes_over(other, shown)
    following = steering(other, None)
    assert np.linalg.norm((following - shown)[0]) < 0.03
    assert abs(heading(following[None])[0] - heading(shown[None])[0]) < np.radians(6)
