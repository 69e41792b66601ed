"""Properties of placing motion in the world."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from motion import SMPL22
from motion.transforms import canonicalize, heading, mirrored, resample, turn
from motion.vectors import square_frame, unit, wrapped

from .bodies import FPS, marching

ANGLES = st.floats(-3.1, 3.1)
quick = settings(max_examples=20, deadline=None)


@quick
@given(ANGLES, st.floats(-50, 50), st.floats(-50, 50))
def test_canonical_frame_forgets_where_the_scene_was(angle, x, z):
    positions, _ = marching()
    scene = np.stack([positions, turn(positions, 2.0) + np.array([1.0, 0, 2.0])])
    moved = turn(scene, angle) + np.array([x, 0, z])
    first = canonicalize(scene)
    np.testing.assert_allclose(canonicalize(moved), first, atol=1e-9)
    np.testing.assert_allclose(first[0, 0, 0, [0, 2]], 0, atol=1e-9)
    assert abs(heading(first[0, 0])) < 1e-9
    np.testing.assert_allclose(first[..., 1], scene[..., 1])


def test_mirror_is_its_own_inverse_and_swaps_hands():
    positions, _ = marching()
    reflected = mirrored(positions)
    np.testing.assert_allclose(mirrored(reflected), positions)
    left, right = SMPL22.index("left_wrist"), SMPL22.index("right_wrist")
    np.testing.assert_allclose(reflected[:, left], positions[:, right] * [-1, 1, 1])
    np.testing.assert_allclose(heading(reflected), -heading(positions), atol=1e-9)


@quick
@given(st.sampled_from([24.0, 25.0, 30.0, 50.0, 60.0, 120.0]))
def test_resampling_keeps_length_and_smooth_motion(fps):
    positions, _ = marching(60)
    there = resample(positions, FPS, fps)
    assert len(there) == int(59 / FPS * fps + 1e-6) + 1
    np.testing.assert_allclose(there[0], positions[0], atol=1e-9)
    if fps >= 50:
        back = resample(there, fps, FPS)
        np.testing.assert_allclose(back, positions[: len(back)], atol=0.003)


def test_resampled_motion_runs_through_curves_not_along_chords() -> None:
    def thrown(fps: float) -> np.ndarray:
        times = np.arange(int(fps) + 1) / fps
        return np.stack([times, 2 + 3 * times - 4.9 * times**2, times**3], axis=-1)[:, None]

    assert np.allclose(resample(thrown(10), 10, 30), thrown(30), atol=1e-9)


def test_a_frame_has_up_as_its_y_and_is_a_rotation() -> None:
    up, across = np.array([[0.0, 2, 0], [1, 1, 0]]), np.array([[3.0, 5, 0], [0, 1, 1]])
    frames = square_frame(up, across)
    assert np.allclose(frames[..., 1], unit(up))
    assert np.allclose(frames.mT @ frames, np.eye(3)) and np.allclose(np.linalg.det(frames), 1)
    assert (np.einsum("ni,ni->n", frames[..., 0], across) > 0).all()


def test_angles_are_wrapped_to_a_turn_about_zero() -> None:
    assert wrapped(0.5) == pytest.approx(0.5)
    assert wrapped(np.pi) == pytest.approx(-np.pi)
    assert np.allclose(wrapped(np.array([7.0, -4.0, 0.0])), [7 - 2 * np.pi, 2 * np.pi - 4, 0])
