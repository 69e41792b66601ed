"""Placing motion in the world: facing, canonical frame, floor, mirror, resampling.

All functions take and give arrays (…, T, J, 3) of positions in metres, Y up. Headings are angles around
Y in radians, 0 along +Z and positive towards +X.
"""

from __future__ import annotations

import numpy as np
import scipy  # its parts are loaded with their first use

from .skeleton import LEGS, SMPL22
from .vectors import Array


def heading_matrix(angle: float | Array) -> Array:
    """(…, 3, 3) rotation about Y that turns +Z to the heading ``angle`` (radians)."""
    angle = np.asarray(angle, dtype=np.float64)
    cos, sin, zero, one = np.cos(angle), np.sin(angle), np.zeros_like(angle), np.ones_like(angle)
    rows = [cos, zero, sin, zero, one, zero, -sin, zero, cos]
    return np.stack(rows, axis=-1).reshape(*angle.shape, 3, 3)


def facing(positions: Array) -> Array:
    """(…, T, 3) unit vector in the XZ plane that the body faces: Y × (left → right reversed).

    Across runs from the right hip to the left hip, as in InterGen's canonical frame; a degenerate
    frame (hips above each other) faces +Z.
    """
    across = positions[..., LEGS[0][0], :] - positions[..., LEGS[1][0], :]
    forward = np.stack([-across[..., 2], np.zeros_like(across[..., 0]), across[..., 0]], axis=-1)
    # Y × (right − left) = forward for a body whose left is at +X when it faces +Z.
    length = np.linalg.norm(forward, axis=-1, keepdims=True)
    return np.where(length > 1e-6, forward / np.maximum(length, 1e-6), np.array([0.0, 0.0, 1.0]))


def heading(positions: Array) -> Array:
    """(…, T) heading of the body in radians, 0 along +Z and positive towards +X."""
    forward = facing(positions)
    return np.arctan2(forward[..., 0], forward[..., 2])


def turn(positions: Array, angle: float) -> Array:
    """Turns positions by ``angle`` radians about the vertical axis through the origin."""
    return positions @ heading_matrix(angle).T


def canonicalize(positions: Array) -> Array:
    """Moves a scene so that the first person stands at the origin facing +Z at the first frame.

    Args:
        positions: (P, T, 22, 3) people of one scene, or (T, 22, 3) for one person.

    Returns:
        the same shape, with that person's root at XZ = 0, facing +Z. Heights do not change.
    """
    reference = positions[0] if positions.ndim == 4 else positions
    root = reference[0, 0] * np.array([1.0, 0.0, 1.0])
    return turn(positions - root, -float(heading(reference[0])))


def mirrored(positions: Array) -> Array:
    """The motion as a mirror in the plane X = 0 shows it: X negated, left and right joints exchanged."""
    return positions[..., list(SMPL22.mirror), :] * np.array([-1.0, 1.0, 1.0])


def resample(positions: Array, fps: float, new_fps: float) -> Array:
    """Resamples (T, J, 3) from ``fps`` to ``new_fps`` with a cubic spline; the first frame stays.

    Fewer than four frames are interpolated linearly.
    """
    frames = len(positions)
    if frames == 1 or fps == new_fps:
        return np.array(positions, dtype=np.float64)
    duration = (frames - 1) / fps
    times = np.arange(int(np.floor(duration * new_fps + 1e-6)) + 1) / new_fps
    spline = scipy.interpolate.make_interp_spline(np.arange(frames) / fps, positions, k=3 if frames > 3 else 1, axis=0)
    return spline(np.minimum(times, duration))
