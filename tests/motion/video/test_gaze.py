"""Where a filmed face points."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from motion.video.following import MEASURED, FollowedPerson
from motion.video.gaze import HIDDEN, Gaze

from .filming import film, stepping


def seen(face: float | None, *, tilt: float = 10.0, hidden: bool = False) -> Gaze | None:
    """The gaze of somebody at the origin, whom the camera films from +Z."""
    landmarks = film([stepping(1.0, heading=0.4)], tilt=tilt, face=face, noise=0.01)
    if hidden:
        landmarks = replace(landmarks, seen=landmarks.seen * (np.arange(33) != 0))
    person = FollowedPerson(tilt=tilt)
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
