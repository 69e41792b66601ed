"""The frame of reference in which a person's motion is predicted; no torch here."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from motion.transforms import heading, heading_matrix

Array = NDArray[np.floating]


def to_last_pose(positions: Array, frame: int = -1) -> tuple[Array, Array, Array]:
    """Moves people so that one pose of each stands over the origin and faces +Z; heights stay.

    Args:
        positions: (…, T, 22, 3) metres.
        frame: whose pose; the last by default.

    Returns:
        positions (…, T, 22, 3) float64 there, and the matrices (…, 3, 3) and shifts (…, 3) of
        :func:`to_world`.
    """
    pose = positions[..., frame, :, :].astype(np.float64)
    shift = pose[..., 0, :] * np.array([1.0, 0.0, 1.0])
    turn = heading_matrix(-heading(pose))
    return (positions - shift[..., None, None, :]) @ np.swapaxes(turn, -1, -2)[..., None, :, :], turn, shift


def to_world(positions: Array, turn: Array, shift: Array) -> Array:
    """Inverse of :func:`to_last_pose`: (…, T, 22, 3) back in the clip's world."""
    return positions @ turn[..., None, :, :] + shift[..., None, None, :]
