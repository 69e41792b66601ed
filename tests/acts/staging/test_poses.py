"""Poses of planned bodies: on the floor, with their own bones, where they should be."""

from __future__ import annotations

import numpy as np
import pytest

from acts.staging.poses import FILE, LOWER, bending, posed, upright
from motion import SMPL22
from motion.kinematics import bone_lengths
from motion.metrics.sentences.joints import Motion
from motion.metrics.sentences.poses import kneels, lies, low, sits
from motion.metrics.sentences.poses import upright as is_upright
from motion.transforms import heading

PLACE = np.array([1.0, -2.0])
TOES = [SMPL22.index("left_foot"), SMPL22.index("right_foot")]


def bent(place: np.ndarray, angle: float) -> np.ndarray:
    return bending(place, angle, 0.9)


@pytest.mark.parametrize("pose", [bent(PLACE, 0.7), *(posed(name, PLACE, 0.7) for name in FILE["postures"])])
def test_poses_are_of_this_body_and_on_the_floor(pose: np.ndarray) -> None:
    np.testing.assert_allclose(bone_lengths(pose), SMPL22.bone_lengths[1:], atol=1e-9)
    assert 0.0 <= pose[:, 1].min() < 0.1
    assert abs(float(heading(pose[None])[0]) - 0.7) < 0.05


@pytest.mark.parametrize(
    ("name", "rule"), [("stands", is_upright), ("sits", sits), ("kneels", kneels), ("lies", lies), ("crouches", low)]
)
def test_poses_are_what_they_are_called(name, rule) -> None:
    duet = np.stack([np.tile(upright(PLACE, 0.0), (40, 1, 1)), np.tile(upright(PLACE + 1, 0.0), (40, 1, 1))])
    duet[0, 20:] = posed(name, PLACE, 0.0)  # a body's height is seen while it stands
    assert rule(Motion(duet), 0)[25:].all()


def test_feet_stay_where_they_stood() -> None:
    stays = [name for name, angles in FILE["postures"].items() if "ahead" not in angles]
    feet = [pose[TOES].mean(axis=0)[[0, 2]] for pose in (bent(PLACE, 0.7), *(posed(n, PLACE, 0.7) for n in stays))]
    assert np.ptp(feet, axis=0).max() < 1e-6


def test_who_sits_on_the_ground_is_at_its_level() -> None:
    pose = posed("sits on the ground", PLACE, 0.7)
    assert pose[0, 1] < 0.25 < 0.6 < pose[SMPL22.index("head"), 1]


def test_who_bends_down_keeps_straight_legs_and_lowers_the_head_forward() -> None:
    straight, leant = upright(np.zeros(2), 0.0), bent(np.zeros(2), 0.0)
    head = SMPL22.index("head")
    assert leant[head, 1] < straight[head, 1] - 0.2 and leant[head, 2] > straight[head, 2] + 0.4
    assert np.array_equal(leant[list(LOWER)][:3], straight[list(LOWER)][:3])
    assert np.array_equal(leant[TOES], straight[TOES])


def test_who_bends_down_has_the_hands_near_the_floor() -> None:
    pose = posed("bends down", PLACE, 0.7)
    assert pose[[SMPL22.index(f"{side}_wrist") for side in ("left", "right")], 1].max() < 0.4
    assert 0.75 < pose[0, 1] < 0.9 and pose[SMPL22.index("head"), 1] > 0.6
