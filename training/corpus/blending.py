"""Blends poses: fractions of a rotation, and smooth weights."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

Array = NDArray[np.floating]


def slerp(first: Array, second: Array, weight: Array) -> Array:
    """Rotations (…, 3, 3) a share ``weight`` (broadcast over the leading axes) of the way to ``second``.

    By Rodrigues' formula; rotations within a hundredth of a radian of a half turn apart have no shortest
    way, there the axis is found through quaternions.
    """
    relative = np.swapaxes(first, -1, -2) @ second
    trace = relative[..., 0, 0] + relative[..., 1, 1] + relative[..., 2, 2]
    skew = (relative - np.swapaxes(relative, -1, -2)) / 2
    angle = np.arctan2(np.sqrt(skew[..., 2, 1] ** 2 + skew[..., 0, 2] ** 2 + skew[..., 1, 0] ** 2), (trace - 1) / 2)
    sine = np.sin(angle)
    share = np.broadcast_to(weight, angle.shape) * angle
    axis = skew / np.where(sine > 1e-7, sine, 1.0)[..., None, None]
    half_turn = angle > np.pi - 0.01
    if half_turn.any():
        vectors = Rotation.from_matrix(relative[half_turn]).as_rotvec()
        x, y, z = (vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)).T
        zero = np.zeros_like(x)
        axis[half_turn] = np.stack([zero, -z, y, z, zero, -x, -y, x, zero], axis=-1).reshape(-1, 3, 3)
    part = np.sin(share)[..., None, None] * axis + (1 - np.cos(share))[..., None, None] * (axis @ axis)
    return first + first @ part


def ease(steps: int) -> Array:
    """(steps,) from just above 0 to just below 1 with zero slope and curvature at both ends."""
    t = (np.arange(steps) + 1.0) / (steps + 1.0)
    return t**3 * (10 + t * (6 * t - 15))
