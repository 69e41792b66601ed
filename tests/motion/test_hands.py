"""Finger shapes: what hands look like, how they blend, and their grips in files."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from motion import SMPL22, Duet, InputError, formats
from motion.body import load_body, skin
from motion.hands import SHAPES, Grip, angles
from motion.looks import LOOKS
from motion.skeleton import SIDES
from tests.motion.bodies import marching
from tests.motion.formats.arrays import npz

POSE = SMPL22.rest_positions()[None] + np.array([0.0, 0.95, 0.0])
PEOPLE = Duet.from_positions(np.stack([marching(60)[0], marching(60, seed=1)[0] + 1.0]), fps=30)


def tips(shape: str, name: str = "a", *, small: bool = False) -> np.ndarray:
    """(2, 5) metres from each wrist to its fingers' ends."""
    body = load_body(name, small=small)
    surface = skin(body, POSE, np.tile(SHAPES[shape], (1, 2, 1)))[0]
    found = np.zeros((2, 5))
    fingers = body.fingers
    for side in range(2):
        wrist = POSE[0, SMPL22.index(f"{SIDES[side]}_wrist")]
        for finger in range(5):
            last = 15 * side + 3 * finger + 2
            mine = fingers.vertices[(fingers.bones[:, 0] == last) & (fingers.weights[:, 0] > 0.5)]
            found[side, finger] = np.linalg.norm(surface[mine] - wrist, axis=1).max()
    return found


@pytest.mark.parametrize("name", LOOKS)
@pytest.mark.parametrize("small", [False, True])
def test_fingers_curl_in_a_fist_and_one_points(name, small):
    flat, fist, point, relaxed = (tips(s, name, small=small) for s in ("flat", "fist", "point", "relaxed"))
    assert (fist[:, 1:] < flat[:, 1:] - 0.05).all()
    assert (point[:, 1] > flat[:, 1] - 0.01).all() and (point[:, 2:] < flat[:, 2:] - 0.05).all()
    assert ((flat[:, 1:] > relaxed[:, 1:]) & (relaxed[:, 1:] > fist[:, 1:])).all()
    np.testing.assert_allclose(flat[0], flat[1], atol=0.005)


def test_only_the_hand_that_grips_changes_and_it_does_so_over_time():
    grip = Grip(0, "left", "fist", 20, 40)
    shapes = angles((grip,), 0, np.arange(60.0), 30)
    np.testing.assert_array_equal(shapes[:, 1], np.tile(SHAPES["relaxed"], (60, 1)))
    np.testing.assert_allclose(shapes[30, 0], SHAPES["fist"])
    np.testing.assert_array_equal(shapes[[10, 55], 0], np.tile(SHAPES["relaxed"], (2, 1)))
    steps = np.abs(np.diff(shapes[:, 0], axis=0)).max()
    assert steps < 0.6 * np.abs(SHAPES["fist"] - SHAPES["relaxed"]).max(), "the fingers jump"
    assert (angles((grip,), 1, np.arange(60.0), 30) == SHAPES["relaxed"]).all()


def test_grips_come_back_from_our_file(tmp_path):
    grips = (Grip(0, "left", "thumbs up", 20, 40), Grip(1, "right", "pinch", 0, 10))
    formats.write(replace(PEOPLE, grips=grips), tmp_path / "x.npz")
    back = formats.read(tmp_path / "x.npz")
    assert isinstance(back, Duet) and back.grips == grips


@pytest.mark.parametrize(
    "text",
    [
        "nonsense",
        '[[2, "left", "fist", 0, 9]]',
        '[[0, "left", "paw", 0, 9]]',
        '[[0, "left", "fist", -1, 9]]',
        "[" * 5000,
    ],
)
def test_damaged_grips_are_one_sentence(text):
    data = npz(positions=PEOPLE.positions, fps=np.float64(30), grips=np.array(text))
    with pytest.raises(InputError, match=r"^x\.npz"):
        formats.read(data, name="x.npz")
