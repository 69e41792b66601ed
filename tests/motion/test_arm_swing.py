"""Arms of people who walk swing against their legs, as wide as recorded people's, and all other arms stay."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from acts.staging.poses import about
from motion import SMPL22
from motion.kinematics import forward_kinematics
from motion.skeleton import ARMS
from motion.swings import swinging
from motion.transforms import heading_matrix
from motion.vectors import unit

Array = NDArray[np.floating]
FPS, FRAMES, STRIDES = 30.0, 180, 0.9
FREE = np.ones(FRAMES)
STEP = np.sin(2 * np.pi * STRIDES * np.arange(FRAMES) / FPS)
MIDDLE = slice(40, 140)
_BONES = tuple(list(ends) for ends in zip(*SMPL22.bones, strict=True))


def walker(speed: float = 1.1, swing: float = 0.0, angle: float = 0.4) -> Array:
    """(T, 22, 3) a person who walks along a heading, with hanging arms that swing by so many radians."""
    turns = np.tile(np.eye(3), (FRAMES, 22, 1, 1))
    turns[:, 0] = heading_matrix(angle)
    for (side, sign), arm in zip((("left", 1.0), ("right", -1.0)), (-STEP, STEP), strict=True):
        turns[:, SMPL22.index(f"{side}_hip")] = about(0, -0.35 * sign * STEP)
        turns[:, SMPL22.index(f"{side}_shoulder")] = about(0, -swing * arm) @ about(2, -sign * 1.4)
        turns[:, SMPL22.index(f"{side}_elbow")] = heading_matrix(-sign * 0.4)
    poses = forward_kinematics(turns, np.zeros((FRAMES, 3)))
    poses[..., 1] -= poses[..., 1].min()
    way = np.array([np.sin(angle), 0.0, np.cos(angle)])
    return np.asarray(poses + speed * np.arange(FRAMES)[:, None, None] / FPS * way)


def ahead(person: Array, side: int, angle: float = 0.4) -> Array:
    """(T,) radians by which a hand is ahead of its shoulder."""
    arm = person[:, ARMS[side][2]] - person[:, ARMS[side][0]]
    return np.asarray(np.arctan2(arm[:, 0] * np.sin(angle) + arm[:, 2] * np.cos(angle), -arm[:, 1]))


def test_an_arm_goes_forward_with_the_other_sides_foot() -> None:
    person = walker()
    found = swinging(person, FPS, FREE)
    for side, step in ((0, -STEP), (1, STEP)):
        swing = (ahead(found, side) - ahead(person, side))[MIDDLE]
        assert np.corrcoef(swing, step[MIDDLE])[0, 1] > 0.85
        assert 0.7 * np.radians(45 * 0.58) < np.ptp(swing) / 2 < 1.4 * np.radians(45 * 0.58)
    late = [np.corrcoef(ahead(found, 1)[MIDDLE], np.roll(STEP, -by)[MIDDLE])[0, 1] for by in (0, 2)]
    assert late[1] > late[0], "the arm is there a little before the foot"


def test_only_elbows_and_wrists_move_on_their_bones_and_no_elbow_bends_back() -> None:
    person = walker()
    found = swinging(person, FPS, FREE)
    others = [joint for joint in range(22) if joint not in {j for arm in ARMS for j in arm[1:]}]
    np.testing.assert_array_equal(found[:, others], person[:, others])
    lengths = [np.linalg.norm(p[:, _BONES[1]] - p[:, _BONES[0]], axis=-1) for p in (found, person)]
    np.testing.assert_allclose(*lengths, atol=1e-9)
    for shoulder, elbow, wrist in ARMS:
        upper, lower = found[:, elbow] - found[:, shoulder], found[:, wrist] - found[:, elbow]
        reach = np.linalg.norm(upper + lower, axis=-1) / (
            np.linalg.norm(upper, axis=-1) + np.linalg.norm(lower, axis=-1)
        )
        assert reach.max() < 0.9985, "bent by six degrees at least"


def test_an_arm_that_swings_wide_enough_stays() -> None:
    person = walker(swing=0.7)
    assert np.abs(swinging(person, FPS, FREE) - person)[MIDDLE].max() < 0.01
    narrow = walker(swing=0.1)
    assert np.abs(swinging(narrow, FPS, FREE) - narrow)[MIDDLE].max() > 0.05


def test_arms_that_are_raised_or_may_not_be_changed_stay() -> None:
    person = walker()
    np.testing.assert_array_equal(swinging(person, FPS, 0 * FREE), person)
    left, right = (list(arm[1:]) for arm in ARMS)
    person[:, left] = person[:, [ARMS[0][0]]] + np.array([[0.2, 0.1, 0.1], [0.3, 0.3, 0.1]])
    found = swinging(person, FPS, FREE)
    np.testing.assert_allclose(found[:, left], person[:, left], atol=1e-9)
    assert np.abs(found[:, right] - person[:, right]).max() > 0.05


def bent(person: Array, side: int) -> float:
    """Degrees by which an elbow is bent on the mean."""
    shoulder, elbow, wrist = (person[MIDDLE, joint] for joint in ARMS[side])
    upper, lower = unit(elbow - shoulder), unit(wrist - elbow)
    return float(np.degrees(np.arccos(np.sum(upper * lower, axis=-1)).mean()))


@pytest.mark.parametrize(("speed", "lowers"), [(1.1, True), (2.4, False)])
def test_arms_carried_out_and_bent_hang_in_a_walk_and_not_in_a_run(speed: float, lowers: bool) -> None:
    person = walker(speed, angle=0.0)
    shoulder, elbow, wrist = ARMS[0]
    person[:, elbow] = person[:, shoulder] + 0.26 * unit(np.array([0.7, -0.7, 0.1]))
    person[:, wrist] = person[:, elbow] + 0.25 * unit(np.array([0.2, 0.1, 1.0]))
    found = swinging(person, FPS, FREE)
    out = np.degrees(np.arctan2(*np.moveaxis((found[:, elbow] - found[:, shoulder])[MIDDLE, :2] * [1, -1], -1, 0)))
    if lowers:
        assert out.mean() < 35 and bent(found, 0) < 60 < 75 < bent(person, 0)
    else:
        assert out.mean() > 40 and bent(found, 0) > 75
    assert np.linalg.norm(found[:, wrist] - found[:, elbow], axis=-1) == pytest.approx(0.25)
