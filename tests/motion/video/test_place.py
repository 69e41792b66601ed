"""The geometry between picture and room."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from motion.video.place import focal_length, smooth, towards, translation, upright

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


def test_the_line_of_sight_is_turned_onto_the_person() -> None:
    pixels = np.full((1, 33, 2), 300.0)
    turn = towards(pixels, FOCAL)[0]
    sight = np.array([300.0, 300.0, FOCAL])
    assert np.allclose(turn @ [0, 0, 1], sight / np.linalg.norm(sight))
    assert np.allclose(turn @ turn.T, np.eye(3)) and np.isclose(np.linalg.det(turn), 1)


def test_a_camera_that_looks_down_sees_the_vertical_lean_towards_it() -> None:
    turn = upright(np.radians(30))
    assert np.allclose(turn @ [0, -np.cos(np.radians(30)), -np.sin(np.radians(30))], [0, 1, 0])
    assert np.allclose(turn @ turn.T, np.eye(3)) and np.isclose(np.linalg.det(turn), 1)


@settings(max_examples=20, deadline=None)
@given(slope=st.floats(-2, 2), start=st.floats(-3, 3), missing=st.integers(0, 12))
def test_smoothing_has_no_lag_and_bridges_what_is_missing(slope: float, start: float, missing: int) -> None:
    line = (start + slope * np.arange(40) / 15)[:, None]
    known = line.copy()
    known[15 : 15 + missing] = np.nan
    assert np.allclose(smooth(known, 15.0, seconds=0.5), line, atol=1e-3)


def test_smoothing_takes_noise_away() -> None:
    noisy = np.random.default_rng(0).normal(size=(300, 1))
    assert smooth(noisy, 15.0, seconds=0.5).std() < 0.5
