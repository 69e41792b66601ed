"""Toes of feet that swing."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from acts.staging.poses import posed, upright
from motion import SMPL22
from motion.kinematics import bone_lengths
from motion.limbs import bent_towards, solve_two_bones
from motion.swings import above_floor, lift_swinging_feet

Array = NDArray[np.floating]
FPS = 30.0
ANKLE, TOE = SMPL22.index("right_ankle"), SMPL22.index("right_foot")


def step(length: float = 0.9, frames: int = 14, *, before: int = 10, hips: float = 0.0) -> Array:
    """(T, 22, 3) a person who stands facing +Z and takes one flat step with the right foot."""
    total = frames + 2 * before
    pose = SMPL22.rest_positions()
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


HERE = np.zeros(2)
TRUNK = [SMPL22.index(name) for name in ("pelvis", "spine2", "neck", "head", "left_shoulder", "right_hip")]
LIMBS = [SMPL22.index(f"{side}_{part}") for side in ("left", "right") for part in ("elbow", "wrist", "knee")]


def falling(deep: float) -> Array:
    """(40, 22, 3) a person who lies and sinks by so many metres and comes back."""
    sunk = deep * np.sin(np.linspace(0, np.pi, 40)) ** 2
    return posed("lies", HERE, 0.3)[None] - sunk[:, None, None] * [0.0, 1.0, 0.0]


@pytest.mark.parametrize("deep", [0.1, 0.4])
def test_a_body_that_sinks_into_the_floor_is_raised_without_a_jolt(deep: float) -> None:
    sunk = falling(deep)
    raised = above_floor(sunk)
    assert raised[:, TRUNK, 1].min() > 0.02 > sunk[:, TRUNK, 1].min()
    assert raised[:, LIMBS, 1].min() > 0.0
    np.testing.assert_allclose(bone_lengths(raised), bone_lengths(sunk), atol=1e-9)
    assert np.abs(np.diff(raised[:, 0, 1], n=2)).max() < np.abs(np.diff(sunk[:, 0, 1], n=2)).max() + 0.02


@pytest.mark.parametrize("side", ["left", "right"])
def test_only_an_arm_in_the_floor_is_turned(side: str) -> None:
    pose = posed("lies", HERE, 0.0)
    shoulder, elbow, wrist = (SMPL22.index(f"{side}_{part}") for part in ("shoulder", "elbow", "wrist"))
    down = np.array([0.3, -0.9, 0.1]) / np.linalg.norm([0.3, -0.9, 0.1])
    pose[elbow] = pose[shoulder] + SMPL22.bone_lengths[elbow] * down
    pose[wrist] = pose[elbow] + SMPL22.bone_lengths[wrist] * down
    raised = above_floor(np.stack([pose] * 5))
    assert raised[:, [elbow, wrist], 1].min() > 0.02
    np.testing.assert_allclose(bone_lengths(raised), bone_lengths(np.stack([pose] * 5)), atol=1e-9)
    others = [joint for joint in range(22) if joint not in (elbow, wrist)]
    np.testing.assert_array_equal(raised[:, others], np.stack([pose] * 5)[:, others])


def test_an_elbow_in_the_floor_is_turned_up_to_the_floor_and_no_farther() -> None:
    pose = np.stack([posed("lies", HERE, 0.0)] * 3)
    shoulder, elbow, wrist = (SMPL22.index(f"left_{part}") for part in ("shoulder", "elbow", "wrist"))
    arm = (pose[:, shoulder], pose[:, elbow], pose[:, wrist])
    pose[:, elbow], pose[:, wrist] = solve_two_bones(*arm, arm[0] + [0.3, 0.0, 0.0], np.array([0.0, -1.0, 0.0]))
    raised = above_floor(pose)
    assert pose[0, elbow, 1] < 0 < raised[0, elbow, 1] < 0.06
    np.testing.assert_allclose(raised[:, wrist], pose[:, wrist], atol=1e-9)


def test_an_elbow_that_went_through_the_floor_goes_over_its_arm() -> None:
    pose = np.stack([posed("lies", HERE, 0.0)] * 60)
    shoulder, elbow, wrist = (SMPL22.index(f"left_{part}") for part in ("shoulder", "elbow", "wrist"))
    arm = (pose[:, shoulder], pose[:, elbow], pose[:, wrist])
    turns = np.linspace(0.4 * np.pi, 1.6 * np.pi, 60)
    pole = np.stack([np.zeros(60), np.cos(turns), np.sin(turns)], axis=-1)
    pose[:, elbow], pose[:, wrist] = bent_towards(*arm, arm[0] + [0.3, 0.0, 0.0], pole)
    raised = above_floor(pose)
    assert pose[:, elbow, 1].min() < 0 < raised[:, elbow, 1].min()
    assert np.linalg.norm(np.diff(raised[:, elbow], axis=0), axis=-1).max() < 0.15
    assert raised[:, elbow, 1].max() > pose[0, elbow, 1], "over the top"


@pytest.mark.parametrize("pose", [upright(HERE, 1.0), posed("kneels", HERE, 0.0), posed("lies", HERE, 2.0)])
def test_who_is_above_the_floor_stays(pose: Array) -> None:
    still = np.stack([pose] * 3)
    np.testing.assert_allclose(above_floor(still), still, atol=1e-9)
