"""A filmed person picture by picture: near to the truth, without the pictures to come."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from motion import SMPL22, InputError
from motion.video import Landmarks
from motion.video.following import MEASURED, FollowedPerson, OneEuro

from .filming import film, stepping


def followed(landmarks: Landmarks, **camera: Any) -> tuple[np.ndarray, FollowedPerson]:
    """The poses (T, 22, 3) of the pictures after the measured ones."""
    person = FollowedPerson(**camera)
    poses = [person.add(landmarks, picture) for picture in range(len(landmarks.times))]
    assert all(pose is None for pose in poses[:MEASURED])
    return np.stack([pose for pose in poses[MEASURED:] if pose is not None]), person


@pytest.mark.parametrize(
    ("tilt", "turned", "distance", "speed"),
    [(0, 0.3, 4.5, 0.0), (22, -1.1, 3.2, 0.0), (10, np.pi / 2, 5.0, 1.0), (10, 0.0, 6.0, 0.8)],
)
def test_pose_path_and_tilt_come_back(tilt: float, turned: float, distance: float, speed: float) -> None:
    true = stepping(3.0, heading=turned, speed=speed)
    found, person = followed(film([true], tilt=tilt, distance=distance, noise=0.02))
    true = true[MEASURED:]
    assert len(found) == len(true)
    assert np.linalg.norm(found - found[:, :1] - true + true[:, :1], axis=-1).mean() < 0.03
    assert np.abs(found[:, 0] - found[0, 0] - true[:, 0] + true[0, 0]).mean() < 0.05
    assert person.tilt == pytest.approx(tilt, abs=2.0)
    assert abs(found[..., 1].min(axis=1).mean()) < 0.03
    assert np.abs(found[0, 0, [0, 2]]).max() < 0.2, "the path begins at the origin"


def test_no_pose_depends_on_later_pictures() -> None:
    landmarks = film([stepping(2.0)], noise=0.02)
    found, _ = followed(landmarks)
    changed = replace(landmarks, world=landmarks.world.copy(), image=landmarks.image.copy())
    changed.world[20:] *= 1.5
    changed.image[20:] += 0.1
    other, _ = followed(changed)
    assert np.array_equal(found[: 20 - MEASURED], other[: 20 - MEASURED])
    assert not np.array_equal(found[20 - MEASURED], other[20 - MEASURED])


def test_bones_are_constant() -> None:
    found, _ = followed(film([stepping(1.5)], noise=0.05))
    lengths = np.stack([np.linalg.norm(found[:, a] - found[:, b], axis=-1) for a, b in SMPL22.bones])
    assert lengths.std(axis=1).max() < 0.02


def test_the_person_who_was_followed_is_followed_on() -> None:
    left, right = stepping(2.0), stepping(2.0)
    left[..., 0] -= 0.3
    right[..., 0] += 1.0
    both = film([left, right], order=5)
    person = FollowedPerson()
    path = [pose[0, 0] for i in range(30) if (pose := person.add(both, i)) is not None]
    assert np.ptp(path) < 0.1, "the nearer to the middle, whatever order the two are found in"


def test_what_the_camera_cannot_be_is_refused_and_half_a_person_gets_a_hint() -> None:
    with pytest.raises(InputError, match="lens of 10°"):
        FollowedPerson(lens=10)
    with pytest.raises(InputError, match="tilt of 80°"):
        FollowedPerson(tilt=80)
    landmarks = film([stepping(1.0)])
    _, person = followed(landmarks)
    assert person.hint == ""
    hidden = landmarks.seen.copy()
    hidden[:, 25:29] = 0.1
    _, person = followed(replace(landmarks, seen=hidden))
    assert "Step back" in person.hint


def test_the_filter_keeps_what_moves_fast_and_calms_what_rests() -> None:
    noise = np.random.default_rng(0).normal(0, 0.02, (60, 1, 3))
    rests, moves = OneEuro(1.0, 3.0), OneEuro(1.0, 3.0)
    calm = np.stack([rests(value, 1 / 15) for value in noise])[20:]
    assert calm.std() < 0.6 * noise.std()
    way = np.arange(60)[:, None, None] * np.full((1, 1, 3), 2.0 / 15)
    late = way[-1] - [moves(value, 1 / 15) for value in way][-1]
    assert late.max() < 0.1, "two metres a second lag less than a twentieth of a second"
