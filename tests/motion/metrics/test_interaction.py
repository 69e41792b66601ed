"""Distances, facing and contacts of motions whose values are known."""

from __future__ import annotations

import json

import numpy as np
import pytest

from motion import SKELETONS, SMPL22, Duet
from motion.metrics import (
    MEASURES,
    compare,
    contact_events,
    facing_angle,
    hand_distance,
    hand_to_body,
    pelvis_distance,
    readouts,
    summary,
)
from motion.transforms import turn

from .scenes import FPS, duet, face_to_face, put_wrist


def test_pelvis_distance_is_over_the_floor() -> None:
    scene = face_to_face(2.0)
    scene[1, :, :, 1] += 5
    np.testing.assert_allclose(pelvis_distance(duet(scene)), 2.0, atol=1e-5)


def test_hand_distance_is_that_of_the_nearest_pair() -> None:
    scene = face_to_face(2.0)
    put_wrist(scene, 0, "right_wrist", np.array([0, 1.0, 0.9]), slice(None))
    put_wrist(scene, 1, "left_wrist", np.array([0, 1.0, 1.2]), slice(None))
    np.testing.assert_allclose(hand_distance(duet(scene)), 0.3, atol=1e-5)


def test_hand_to_body_is_measured_for_each_person() -> None:
    scene = face_to_face(2.0)
    chest = 0.5 * (scene[1, 0, SMPL22.index("spine2")] + scene[1, 0, SMPL22.index("spine3")])
    put_wrist(scene, 0, "right_wrist", chest - np.array([0, 0, 0.25]), slice(None))
    from_a, from_b = hand_to_body(duet(scene))
    np.testing.assert_allclose(from_a, 0.25, atol=0.01)
    assert (from_b > 1).all()


@pytest.mark.parametrize("degrees", [0, 60, 90, 180])
def test_facing_is_the_angle_by_which_a_person_has_turned(degrees: float) -> None:
    scene = face_to_face(2.0)
    scene[0] = turn(scene[0], np.radians(degrees))
    angles = facing_angle(duet(scene))
    np.testing.assert_allclose(angles[0], degrees, atol=0.1)
    np.testing.assert_allclose(angles[1], 0, atol=0.1)


def test_facing_of_people_in_one_place_is_a_number() -> None:
    assert np.isfinite(facing_angle(duet(face_to_face(0.0)))).all()


def test_nobody_touches_at_two_metres() -> None:
    assert contact_events(duet(face_to_face(2.0))) == []


def test_hands_that_meet_are_one_contact_with_its_frames() -> None:
    scene = face_to_face(2.0)
    for person, gap in ((0, -0.04), (1, 0.04)):
        put_wrist(scene, person, "right_wrist", np.array([0, 1.0, 1.0 + gap]), slice(20, 40))
    (contact,) = contact_events(duet(scene))
    assert (contact.start, contact.stop, contact.kind) == (20, 40, "hands")


def test_hands_that_reach_over_each_other_are_one_contact() -> None:
    """A grasp of two seconds: the wrists are a palm apart, each hand beyond the other's wrist."""
    scene = face_to_face(2.0)
    for person, toward in ((0, 1.0), (1, -1.0)):
        wrist, elbow = (SMPL22.index(f"right_{name}") for name in ("wrist", "elbow"))
        loosening = 0.02 * np.sin(np.linspace(0, 9, 50))[:, None] * np.array([0, 1.0, 0])
        scene[person, 5:55, wrist] = np.array([0, 1.0, 1.0 + 0.04 * toward]) + toward * loosening
        scene[person, 5:55, elbow] = np.array([0, 1.0, 1.0 - 0.25 * toward])
    (contact,) = contact_events(duet(scene))
    assert (contact.start, contact.stop, contact.kind) == (5, 55, "hands")


def test_palms_that_meet_are_a_contact_of_hands_alone() -> None:
    scene = face_to_face(2.0)
    for person, toward in ((0, 1.0), (1, -1.0)):
        wrist, elbow = (SMPL22.index(f"right_{name}") for name in ("wrist", "elbow"))
        scene[person, 20:40, wrist] = np.array([0, 1.3, 1.0 - 0.09 * toward])
        scene[person, 20:40, elbow] = np.array([0, 1.3, 1.0 - 0.34 * toward])
    assert [(c.start, c.stop, c.kind) for c in contact_events(duet(scene))] == [(20, 40, "hands")]


def test_a_hand_on_the_chest_says_whose() -> None:
    scene = face_to_face(2.0)
    chest = scene[1, 0, SMPL22.index("spine3")]
    put_wrist(scene, 0, "left_wrist", chest + np.array([0, 0.08, -0.14]), slice(10, 30))
    (contact,) = contact_events(duet(scene))
    assert (contact.start, contact.stop) == (10, 30)
    assert contact.label == "hand of A on B"


def test_a_kick_is_a_contact_but_standing_toe_to_toe_is_not() -> None:
    scene = face_to_face(2.0)
    scene[0, 30:40, SMPL22.index("right_foot")] = scene[1, 0, SMPL22.index("spine1")] - np.array([0, 0, 0.15])
    (contact,) = contact_events(duet(scene))
    assert (contact.kind, contact.label) == ("foot", "foot of A on B")
    scene = face_to_face(2.0)
    scene[0, :, SMPL22.index("right_foot")] = scene[1, 0, SMPL22.index("left_foot")]
    assert contact_events(duet(scene)) == []


def test_short_gaps_are_joined_and_single_frames_dropped() -> None:
    scene = face_to_face(2.0)
    for frames in (slice(10, 20), slice(22, 30), slice(50, 51)):
        for person in (0, 1):
            put_wrist(scene, person, "right_wrist", np.array([0, 1.0, 1.0]), frames)
    assert [(c.start, c.stop) for c in contact_events(duet(scene))] == [(10, 30)]


def test_roles_are_named_in_contacts() -> None:
    scene = face_to_face(2.0)
    put_wrist(scene, 0, "left_wrist", scene[1, 0, SMPL22.index("head")], slice(10, 30))
    named = Duet.from_positions(scene, fps=FPS, roles=("actor", "reactor"))
    assert contact_events(named)[0].label == "hand of A on B"


def test_measures_do_not_depend_on_where_the_scene_stands() -> None:
    rng = np.random.default_rng(0)
    scene = face_to_face(0.6) + np.cumsum(rng.normal(0, 0.003, (2, 60, 22, 3)), axis=1)
    moved = turn(scene, 1.1) + np.array([3.0, 0.0, -2.0])
    first, second = summary(duet(scene)), summary(duet(moved))
    assert first["response_delay"] == second["response_delay"]
    for key in first.keys() - {"response_delay"}:
        value = first[key]
        assert second[key] == pytest.approx(value, rel=0.02, abs=0.02), key


def test_readouts_are_json_with_every_measure_and_curves_of_full_length() -> None:
    found = json.loads(json.dumps(readouts(duet(face_to_face(2.0))), allow_nan=False))
    assert list(found["summary"]) == [measure.key for measure in MEASURES]
    assert all(len(curve) == 60 for curve in found["curves"].values())
    assert found["summary"]["distance"] == pytest.approx(2.0, abs=1e-3)


@pytest.mark.parametrize("name", SKELETONS)
def test_every_skeleton_has_readouts(name: str) -> None:
    skeleton = SKELETONS[name]
    scene = np.random.default_rng(0).normal(0, 0.4, (2, 12, skeleton.num_joints, 3)) + 1
    found = readouts(Duet.from_positions(scene, fps=15, skeleton=skeleton))
    known = [value for key, value in found["summary"].items() if key != "response_delay"]
    assert np.isfinite(known).all()


def test_compare_sets_a_motion_beside_what_it_was() -> None:
    scene = face_to_face(2.0)
    sliding = scene.copy()
    sliding[0, :, :, 0] += 0.2 / FPS * np.arange(60)[:, None]
    found = compare(duet(sliding), duet(scene))
    assert found["before"]["foot_skate"] == pytest.approx(10, rel=0.01)
    assert found["after"]["foot_skate"] == 0
    assert compare(None, duet(scene))["before"] is None
