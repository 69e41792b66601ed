"""Foot skate, jerk, bone drift and penetration of motions whose values are known."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from motion import SMPL22
from motion.looks import SIZES
from motion.metrics.bodies import CAPSULES, segment_segment_distance
from motion.metrics.quality import bone_drift, foot_skate, jerk, limb_depth, naturalness, penetration
from motion.transforms import turn

from .scenes import FPS, duet, face_to_face


def test_still_people_have_no_skate_no_jerk_and_no_drift() -> None:
    still = duet(face_to_face())
    assert foot_skate(still) == 0
    assert jerk(still) == pytest.approx(0, abs=1e-6)
    assert bone_drift(still) == pytest.approx(0, abs=1e-6)


def test_sliding_people_skate_at_the_speed_they_slide() -> None:
    scene = face_to_face()
    scene[0, :, :, 0] += 0.30 / FPS * np.arange(60)[:, None]
    scene[1, :, :, 0] += 0.70 / FPS * np.arange(60)[:, None]
    assert foot_skate(duet(scene)) == pytest.approx(50, rel=1e-3), "30 and 70 cm/s on average"


def test_jerk_of_a_cubic_path_is_its_third_derivative() -> None:
    scene = face_to_face()
    scene[..., 2] += 0.1 * (np.arange(60)[None, :, None] / FPS) ** 3
    assert jerk(duet(scene)) == pytest.approx(0.6, rel=0.05), "d³/dt³ 0.1 t³ = 0.6 m/s³"


def test_bone_drift_is_the_spread_of_lengths_in_percent() -> None:
    scene = face_to_face()
    swing = np.where(np.arange(60) % 2, 1.1, 0.9)[:, None, None]
    scene *= swing  # every bone 10 % longer and shorter in turn
    assert bone_drift(duet(scene)) == pytest.approx(10, rel=1e-3)


def test_penetration_is_zero_apart_and_the_radii_when_spines_meet() -> None:
    assert penetration(duet(face_to_face(2.0))).max() == 0
    inside = penetration(duet(np.stack([np.tile(SMPL22.standing(), (10, 1, 1))] * 2)))
    assert inside == pytest.approx(24, abs=1e-3), "two spines of 12 cm radius in one place"


def test_a_child_is_as_thin_as_it_is_short() -> None:
    """Two who are children beside each other overlap as much in proportion as two adults."""
    scene = face_to_face(0.1)
    adults = duet(scene)
    children = replace(duet(SIZES["boy"] * scene), looks=("boy", "girl"))
    assert penetration(children).max() == pytest.approx(SIZES["boy"] * penetration(adults).max(), rel=1e-3)


def test_penetration_agrees_with_all_pairs() -> None:
    rng = np.random.default_rng(0)
    scene = face_to_face(0.2, frames=8) + rng.normal(0, 0.05, (2, 8, 22, 3))
    body = CAPSULES
    expected = np.zeros(8)
    for i in range(len(body.starts)):
        for j in range(len(body.starts)):
            gap = segment_segment_distance(
                scene[0][:, body.starts[i]],
                scene[0][:, body.ends[i]],
                scene[1][:, body.starts[j]],
                scene[1][:, body.ends[j]],
            )
            expected = np.maximum(expected, body.radii[i] + body.radii[j] - gap)
    assert (expected > 0).any()
    np.testing.assert_allclose(penetration(duet(scene)), 100 * expected, atol=1e-3)


REST = SMPL22.rest_positions() + np.array([0, 0.98, 0])


def stands(frames: int = 60) -> np.ndarray:
    return np.repeat(REST[None], frames, axis=0)


@pytest.mark.parametrize("angle", [0.0, 1.0])
def test_arms_that_do_the_same_mirror_each_other(angle: float) -> None:
    both, one = stands(), stands()
    wave = 0.2 * np.sin(np.arange(60) / 4)
    left, right = SMPL22.index("left_wrist"), SMPL22.index("right_wrist")
    for motion, sides in ((both, (left, right)), (one, (left,))):
        motion[:, sides, 1] += wave[:, None]
    assert naturalness(turn(both, angle), FPS).mirror_gap == pytest.approx(0, abs=0.5)
    assert naturalness(turn(one, angle), FPS).mirror_gap == pytest.approx(100 * np.abs(wave).mean(), abs=0.5)


def test_a_forearm_in_the_other_trunk_is_deep_and_a_hand_that_is_held_is_not() -> None:
    one, other = stands(4), turn(stands(4), np.pi) + np.array([0, 0, 0.6])
    assert limb_depth(one, other).max() == 0.0
    spine = other[:, SMPL22.index("spine3")]
    one[2:, SMPL22.index("left_wrist")] = spine[2:]
    one[2:, SMPL22.index("left_elbow")] = spine[2:] - np.array([0, 0, 0.26])
    assert (limb_depth(one, other) > 0.02).tolist() == [False, False, True, True]
    assert naturalness(one, FPS, other).deep == 0.5
    assert np.isnan(naturalness(one, FPS).deep)
