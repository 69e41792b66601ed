"""Light on bodies and the shadow on the floor."""

import numpy as np
import pytest

from motion import SMPL22
from motion.body import load_body
from webdemo.view.theme import Shadow

STANDING = SMPL22.rest_positions() + np.array([0, 0.98, 0])


def test_the_floor_is_dark_below_people_and_open_far_away() -> None:
    shadow = Shadow(np.stack([STANDING, STANDING + np.array([2, 0, 1])]), [])
    assert shadow.dark.min() >= 0 and shadow.dark.max() <= 1
    dark, _ = shadow.at(np.array([0.0, 2.0, 1.0]), np.array([0.0, 1.0, -1.0]))
    assert min(dark[:2]) > 2 * dark[2]
    outside, places = shadow.at(np.array([50.0]), np.array([0.0]))
    assert not len(outside) and not len(places)


def test_a_person_in_the_air_casts_less() -> None:
    low, high = (Shadow((STANDING + np.array([0, up, 0]))[None], []) for up in (0.0, 0.8))
    assert high.dark.sum() < 0.6 * low.dark.sum()


def test_soles_darken_the_floor_they_touch() -> None:
    body = load_body("man", small=True)
    poses = np.stack([STANDING])
    plain, pressed = Shadow(poses, []), Shadow(poses, [body.vertices])
    x, z = (np.array([body.joints[SMPL22.index("left_foot"), axis]]) for axis in (0, 2))
    assert pressed.at(x, z)[0] > plain.at(x, z)[0]
    assert pressed.dark.sum() == pytest.approx(plain.dark.sum(), rel=0.6)
