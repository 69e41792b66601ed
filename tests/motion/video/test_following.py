"""A filmed person picture by picture: near to the truth, without the pictures to come."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from motion.video import Landmarks
from motion.video.following import HIDDEN, MEASURED, FollowedPerson, Gaze

from .filming import film, stepping


def followed(landmarks: Landmarks) -> tuple[np.ndarray, FollowedPerson]:
    """The poses (T, 22, 3) of the pictures after the measured ones."""
    person = FollowedPerson()
    poses = [person.add(landmarks, picture) for picture in range(len(landmarks.times))]
    assert all(pose is None for pose in poses[:MEASURED])
    return np.stack([pose for pose in poses[MEASURED:] if pose is not None]), person


@pytest.mark.parametrize(
    ("tilt", "turned", "distance", "speed"),
    [(0, 0.3, 4.5, 0.0), (22, -1.1, 3.2, 0.0), (10, np.pi / 2, 5.0, 1.0), (10, 0.0, 6.0, 0.8)],
)
def test_pose_path_and_tilt_come_back(tilt: float, turned: float, distance: float, speed: float) -> None:
    true = stepping(3.0, heading=turned, speed=speed)
    found, person = followed(film(true, tilt=tilt, distance=distance, noise=0.02))
    true = true[MEASURED:]
    assert len(found) == len(true)
    assert np.linalg.norm(found - found[:, :1] - true + true[:, :1], axis=-1).mean() < 0.03
    assert np.abs(found[:, 0] - found[0, 0] - true[:, 0] + true[0, 0]).mean() < 0.05
    assert person.tilt == pytest.approx(tilt, abs=2.0)
    assert abs(found[..., 1].min(axis=1).mean()) < 0.03
    assert np.abs(found[0, 0, [0, 2]]).max() < 0.2, "the path begins at the origin"


def test_no_pose_depends_on_later_pictures() -> None:
    landmarks = film(stepping(2.0), noise=0.02)
    found, _ = followed(landmarks)
    changed = replace(landmarks, world=landmarks.world.copy(), image=landmarks.image.copy())
    changed.world[20:] *= 1.5
    changed.image[20:] += 0.1
    other, _ = followed(changed)
    assert np.array_equal(found[: 20 - MEASURED], other[: 20 - MEASURED])
    assert not np.array_equal(found[20 - MEASURED], other[20 - MEASURED])


def test_half_a_person_gets_a_hint() -> None:
    landmarks = film(stepping(1.0))
    _, person = followed(landmarks)
    assert person.hint == ""
    hidden = landmarks.seen.copy()
    hidden[:, 25:29] = 0.1
    _, person = followed(replace(landmarks, seen=hidden))
    assert "Step back" in person.hint


def seen(face: float | None, *, tilt: float = 10.0, hidden: bool = False) -> Gaze | None:
    """The gaze of somebody at the origin, whom the camera films from +Z."""
    landmarks = film(stepping(1.0, heading=0.4), tilt=tilt, face=face, noise=0.01)
    if hidden:
        landmarks = replace(landmarks, seen=landmarks.seen * (np.arange(33) != 0))
    person = FollowedPerson()
    assert person.gaze is None
    poses = [person.add(landmarks, picture) for picture in range(MEASURED + 4)]
    assert poses[-1] is not None
    return person.gaze


@pytest.mark.parametrize("face", [0.0, 0.9, -1.6, 2.8])
@pytest.mark.parametrize("tilt", [0.0, 25.0])
def test_a_face_points_where_its_nose_is(face: float, tilt: float) -> None:
    found = seen(face, tilt=tilt)
    assert found is not None
    np.testing.assert_allclose(found.ahead, [np.sin(face), 0, np.cos(face)], atol=0.2)
    assert found.camera == pytest.approx(np.cos(face), abs=0.2)
    assert found.towards(np.array([2.0, -1.0, 0.0])) == pytest.approx(np.sin(face), abs=0.2)
    assert found.towards(np.array([0.0, 1.0, 0.0])) == 0


def test_a_face_that_is_not_seen_is_turned_away_and_one_without_depth_tells_nothing() -> None:
    assert seen(0.0, hidden=True) is HIDDEN
    assert HIDDEN.camera == -1 and HIDDEN.towards(np.array([0.0, 0.0, 1.0])) == 0
    assert seen(None) is None
