"""Bodies on the floor instead of in it."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from acts.staging.poses import kneeling, lying, upright
from motion import SMPL22
from motion.ground import _turned_up, above_floor

Array = NDArray[np.floating]
HERE = np.zeros(2)
TRUNK = [SMPL22.index(name) for name in ("pelvis", "spine2", "neck", "head", "left_shoulder", "right_hip")]
LIMBS = [SMPL22.index(f"{side}_{part}") for side in ("left", "right") for part in ("elbow", "wrist", "knee")]


def lengths(positions: Array) -> Array:
    parents, children = zip(*SMPL22.bones, strict=True)
    return np.linalg.norm(positions[:, children] - positions[:, parents], axis=-1)


def falling(deep: float) -> Array:
    """(40, 22, 3) a person who lies and sinks by so many metres and comes back."""
    sunk = deep * np.sin(np.linspace(0, np.pi, 40)) ** 2
    return lying(HERE, 0.3)[None] - sunk[:, None, None] * [0.0, 1.0, 0.0]


@pytest.mark.parametrize("deep", [0.1, 0.4])
def test_a_body_that_sinks_into_the_floor_is_raised_without_a_jolt(deep: float) -> None:
    sunk = falling(deep)
    raised = above_floor(sunk)
    assert raised[:, TRUNK, 1].min() > 0.02 > sunk[:, TRUNK, 1].min()
    assert raised[:, LIMBS, 1].min() > 0.0
    np.testing.assert_allclose(lengths(raised), lengths(sunk), atol=1e-9)
    assert np.abs(np.diff(raised[:, 0, 1], n=2)).max() < np.abs(np.diff(sunk[:, 0, 1], n=2)).max() + 0.02


@pytest.mark.parametrize("side", ["left", "right"])
def test_only_an_arm_in_the_floor_is_turned(side: str) -> None:
    pose = lying(HERE, 0.0)
    shoulder, elbow, wrist = (SMPL22.index(f"{side}_{part}") for part in ("shoulder", "elbow", "wrist"))
    down = np.array([0.3, -0.9, 0.1]) / np.linalg.norm([0.3, -0.9, 0.1])
    pose[elbow] = pose[shoulder] + SMPL22.bone_lengths[elbow] * down
    pose[wrist] = pose[elbow] + SMPL22.bone_lengths[wrist] * down
    raised = above_floor(np.stack([pose] * 5))
    assert raised[:, [elbow, wrist], 1].min() > 0.02
    np.testing.assert_allclose(lengths(raised), lengths(np.stack([pose] * 5)), atol=1e-9)
    others = [joint for joint in range(22) if joint not in (elbow, wrist)]
    np.testing.assert_array_equal(raised[:, others], np.stack([pose] * 5)[:, others])


@pytest.mark.parametrize("pose", [upright(HERE, 1.0), kneeling(HERE, 0.0), lying(HERE, 2.0)])
def test_who_is_above_the_floor_stays(pose: Array) -> None:
    still = np.stack([pose] * 3)
    np.testing.assert_allclose(above_floor(still), still, atol=1e-9)


def test_an_elbow_is_turned_no_higher_than_onto_the_floor() -> None:
    root, end = np.array([[0.0, 0.05, 0.0]]), np.array([[0.4, 0.05, 0.0]])
    found = _turned_up(root, np.array([[0.2, -0.05, 0.08]]), end)
    assert found[0, 1] == pytest.approx(0.03, abs=1e-3) and found[0, 2] > 0.08
