"""Foot skate, jerk, bone drift and penetration of motions whose values are known."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from motion import SKELETONS, SMPL22, Duet
from motion.looks import SIZES
from motion.metrics import bone_drift, foot_skate, jerk, penetration
from motion.metrics.bodies import capsules, point_segment_distance, segment_segment_distance

from .scenes import FPS, duet, face_to_face, standing

SEGMENTS = np.random.default_rng(1).normal(size=(4, 400, 3))


def test_still_people_have_no_skate_no_jerk_and_no_drift() -> None:
    still = duet(face_to_face())
    assert foot_skate(still).speed == 0
    assert foot_skate(still).contact == 1
    assert jerk(still) == pytest.approx(0, abs=1e-6)
    assert bone_drift(still) == pytest.approx(0, abs=1e-6)


def test_sliding_people_skate_at_the_speed_they_slide() -> None:
    scene = face_to_face()
    scene[0, :, :, 0] += 0.30 / FPS * np.arange(60)[:, None]
    scene[1, :, :, 0] += 0.70 / FPS * np.arange(60)[:, None]
    skate = foot_skate(duet(scene))
    assert skate.speed == pytest.approx(50, rel=1e-3), "30 and 70 cm/s on average"
    assert skate.ratio == pytest.approx(0.5), "only one of them is above 50 cm/s"


def test_feet_in_the_air_do_not_skate() -> None:
    scene = face_to_face()
    scene[..., 0] += 1.0 / FPS * np.arange(60)[None, :, None]
    scene[..., 1] += 0.5
    assert foot_skate(duet(scene)) == foot_skate(duet(scene[:, :1]))
    assert foot_skate(duet(scene)).contact == 0


def test_a_swinging_foot_close_to_the_floor_with_its_heel_up_does_not_skate() -> None:
    scene = face_to_face()
    for side in ("left", "right"):
        scene[:, :, SMPL22.index(f"{side}_foot"), 0] += 1.0 / FPS * np.arange(60)
        scene[:, :, SMPL22.index(f"{side}_ankle"), 1] = 0.2
    assert foot_skate(duet(scene)).contact == 0


def test_jerk_of_a_cubic_path_is_its_third_derivative() -> None:
    scene = face_to_face()
    scene[..., 2] += 0.1 * (np.arange(60)[None, :, None] / FPS) ** 3
    assert jerk(duet(scene)) == pytest.approx(0.6, rel=0.05), "d³/dt³ 0.1 t³ = 0.6 m/s³"


def test_jerk_of_three_frames_is_zero() -> None:
    assert jerk(duet(face_to_face(frames=3))) == 0


def test_bone_drift_is_the_spread_of_lengths_in_percent() -> None:
    scene = face_to_face()
    swing = np.where(np.arange(60) % 2, 1.1, 0.9)[:, None, None]
    scene *= swing  # every bone 10 % longer and shorter in turn
    assert bone_drift(duet(scene)) == pytest.approx(10, rel=1e-3)


def test_penetration_is_zero_apart_and_the_radii_when_spines_meet() -> None:
    assert penetration(duet(face_to_face(2.0))).deepest == 0
    inside = penetration(duet(np.stack([np.tile(standing(), (10, 1, 1))] * 2)))
    assert inside.deepest == pytest.approx(24, abs=1e-3), "two spines of 12 cm radius in one place"
    assert inside.mean == pytest.approx(inside.deepest)


def test_penetration_grows_centimetre_by_centimetre() -> None:
    scene = face_to_face(0.15, frames=2)
    scene[1, 1, :, 2] -= 0.02
    depth = penetration(duet(scene)).depth
    assert depth[0] > 0
    assert depth[1] - depth[0] == pytest.approx(2, abs=0.05)


def test_a_child_is_as_thin_as_it_is_short() -> None:
    """Two who are children beside each other overlap as much in proportion as two adults."""
    scene = face_to_face(0.1)
    adults = duet(scene)
    children = replace(duet(SIZES["boy"] * scene), looks=("boy", "girl"))
    assert penetration(children).deepest == pytest.approx(SIZES["boy"] * penetration(adults).deepest, rel=1e-3)


def test_penetration_agrees_with_all_pairs() -> None:
    rng = np.random.default_rng(0)
    scene = face_to_face(0.2, frames=8) + rng.normal(0, 0.05, (2, 8, 22, 3))
    body = capsules(SMPL22)
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
    np.testing.assert_allclose(penetration(duet(scene)).depth, 100 * expected, atol=1e-3)


def test_segment_distance_agrees_with_a_dense_search() -> None:
    steps = np.linspace(0, 1, 201)[:, None]
    for a, b, c, d in zip(*SEGMENTS[:, :40], strict=True):
        first, second = a + steps * (b - a), c + steps * (d - c)
        searched = np.linalg.norm(first[:, None] - second[None], axis=-1).min()
        found = segment_segment_distance(a[None], b[None], c[None], d[None])[0]
        assert found <= searched + 1e-9
        assert found == pytest.approx(searched, abs=0.03)


def test_parallel_and_point_like_segments_are_measured() -> None:
    zero, x, up = np.zeros((1, 3)), np.array([[1.0, 0, 0]]), np.array([[0, 1.0, 0]])
    assert segment_segment_distance(zero, x, up, x + up)[0] == pytest.approx(1)
    assert segment_segment_distance(zero, x, 2 * x, 3 * x)[0] == pytest.approx(1)
    assert segment_segment_distance(zero, zero, up, up)[0] == pytest.approx(1)
    assert point_segment_distance(up, zero, x)[0] == pytest.approx(1)
    assert point_segment_distance(3 * x, zero, x)[0] == pytest.approx(2)


@pytest.mark.parametrize("name", SKELETONS)
def test_every_skeleton_can_be_measured(name: str) -> None:
    skeleton = SKELETONS[name]
    rng = np.random.default_rng(0)
    scene = Duet.from_positions(rng.normal(0, 0.3, (2, 12, skeleton.num_joints, 3)) + 1, fps=15, skeleton=skeleton)
    assert penetration(scene).deepest > 0
    assert bone_drift(scene) > 0
    assert jerk(scene) > 0
    assert 0 <= foot_skate(scene).contact <= 1
