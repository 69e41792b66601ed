"""Vectors and angles."""

import numpy as np
import pytest

from motion.vectors import square_frame, unit, wrapped


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_directions_have_length_one_and_zeros_stay_zero(dtype: type) -> None:
    found = unit(np.array([[[3.0, 0, 4], [0, 0, 0]], [[0, 1e-6, 0], [0, 0, -5]]], dtype))
    assert found.dtype == dtype
    assert np.allclose(found, [[[0.6, 0, 0.8], [0, 0, 0]], [[0, 1, 0], [0, 0, -1]]])


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
