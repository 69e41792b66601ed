"""Films of known motion give that motion back."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from motion import Duet, InputError
from motion.cleaning import foot_contacts
from motion.kinematics import bone_lengths
from motion.metrics.quality import foot_skate
from motion.transforms import resample
from motion.video import Landmarks, person_of
from motion.video.landmarks import INDEX
from motion.video.place import focal_length, translation

from .filming import film, stepping


def misplaced(found: np.ndarray, true: np.ndarray) -> float:
    """Mean distance of joints in metres, both about their pelvis."""
    frames = min(len(found), len(true))
    return float(
        np.linalg.norm(found[:frames] - found[:frames, :1] - true[:frames] + true[:frames, :1], axis=-1).mean()
    )


@pytest.mark.parametrize(("tilt", "turned", "distance"), [(0, 0.3, 4.5), (22, -1.1, 3.2)])
def test_pose_tilt_and_bones_come_back_from_any_camera(tilt: float, turned: float, distance: float) -> None:
    true = stepping(1.5, heading=turned)
    filmed = person_of(film(true, tilt=tilt, distance=distance, noise=0.02))
    person = filmed.person
    assert misplaced(person.positions, resample(true, 15.0, 30.0)) < 0.06
    assert filmed.tilt == pytest.approx(tilt, abs=4.0)
    assert np.ptp(bone_lengths(person.positions), axis=0).max() < 1e-3
    assert abs(person.positions[:, :, 1].min()) < 0.05
    assert foot_contacts(person.positions, 30.0).mean() > 0.9 and foot_skate(Duet(person, person)) < 3.0  # cm/s


def test_a_walk_across_the_picture_covers_its_way() -> None:
    true = stepping(3.0, speed=1.0, heading=np.pi / 2)
    true[..., 0] -= 1.5
    person = person_of(film(true, distance=5.0, noise=0.02)).person
    way = person.positions[-1, 0] - person.positions[0, 0]
    assert way[0] == pytest.approx(true[-1, 0, 0] - true[0, 0, 0], abs=0.2)
    assert abs(way[2]) < 0.2


def test_a_gap_is_marked_and_filled() -> None:
    landmarks = film(stepping(3.0))
    kept = (landmarks.frames < 15) | (landmarks.frames > 26)
    landmarks = replace(
        landmarks,
        frames=landmarks.frames[kept],
        world=landmarks.world[kept],
        image=landmarks.image[kept],
        seen=landmarks.seen[kept],
    )
    filmed = person_of(landmarks)
    lost = np.flatnonzero(filmed.confidence < 0.05) / 30.0
    assert lost[0] == pytest.approx(1.0, abs=0.15) and lost[-1] == pytest.approx(1.8, abs=0.15)
    assert filmed.confidence[5] > 0.9
    assert "Nobody was found" in filmed.notes[0]
    assert np.abs(np.diff(filmed.person.positions, axis=0)).max() < 0.2


def hidden(landmarks: Landmarks, *points: str, share: float = 1.0) -> Landmarks:
    """The same film, in the first share of which the network is unsure of some points."""
    seen = landmarks.seen.copy()
    seen[: round(share * len(seen)), [INDEX[point] for point in points]] = 0.2
    return replace(landmarks, seen=seen)


def test_legs_that_are_hidden_for_a_while_are_told() -> None:
    covered = hidden(film(stepping(1.0)), "left_ankle", "right_knee", share=0.4)
    (note,) = person_of(covered).notes
    assert note.startswith("The legs are hidden or out of the picture for 4")


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ("nobody", "Nobody was found"),
        ("sideways", "lies on its side"),
        ("upside down", "upside down"),
        ("legs", "The legs are not in the picture"),
        ("short", "less than half a second"),
    ],
)
def test_a_film_that_cannot_be_used_is_refused_in_a_sentence(change: str, sentence: str) -> None:
    landmarks = film(stepping(0.3 if change == "short" else 1.0))
    if change == "nobody":
        empty = {name: getattr(landmarks, name)[:0] for name in ("frames", "world", "image", "seen")}
        landmarks = replace(landmarks, **empty)
    elif change == "sideways":
        landmarks = replace(landmarks, image=landmarks.image[..., ::-1])
    elif change == "upside down":
        landmarks = replace(landmarks, image=1 - landmarks.image)
    elif change == "legs":
        seen = landmarks.seen.copy()
        seen[:, 25:] = 0.1
        landmarks = replace(landmarks, seen=seen)
    with pytest.raises(InputError, match=sentence):
        person_of(landmarks)


FOCAL = focal_length(1280, 720)


@settings(max_examples=30, deadline=None)
@given(x=st.floats(-1.5, 1.5), y=st.floats(-0.8, 0.8), z=st.floats(2, 8), seed=st.integers(0, 99))
def test_the_place_of_points_is_found_from_their_pictures(x: float, y: float, z: float, seed: int) -> None:
    world = np.random.default_rng(seed).normal(size=(2, 33, 3)) * [0.2, 0.5, 0.2]
    true = np.array([x, y, z])
    seen = world + true
    pixels = FOCAL * seen[..., :2] / seen[..., 2:]
    assert np.allclose(translation(world, pixels, np.ones((2, 33)), FOCAL), true, atol=1e-6)
    pixels[:, 3] += 400  # one point that is thrown far away does not matter
    assert np.allclose(translation(world, pixels, np.ones((2, 33)), FOCAL), true, atol=0.35)
