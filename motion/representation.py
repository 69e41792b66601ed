"""InterGen's non-canonical motion representation, both ways (Liang et al. 2024, section 4.1).

A person and frame are 262 numbers: world positions of 22 joints (66), their forward differences (66),
6D rotations of joints 1–21 (126) and four foot contacts. The last frame has no forward difference and is
dropped. Both people stand in one frame: person a's root over the origin, facing +Z, at the first frame.
"""

from __future__ import annotations

import numpy as np

from .kinematics import fit_rotations
from .skeleton import FEET
from .transforms import heading_matrix
from .vectors import FLAT, Array, square_to, unit

NUM_FEATURES = 262
POSITIONS, VELOCITIES = slice(0, 66), slice(66, 132)
ROTATIONS, CONTACTS = slice(132, 258), slice(258, 262)
CONTACT_SQUARED_STEP = 0.001
CONTACT_HEIGHTS = np.array([0.12, 0.05, 0.12, 0.05])
"""Squared metres from frame to frame, and metres of left ankle, left toe, right ankle and right toe, of feet that can
stand on the floor."""

# The released data is Z-up.
Z_UP_TO_Y_UP = np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]])


def upright(raw: Array) -> Array:
    """(T, 22, 3) metres, Y up, of InterHuman's frames (T, 66 or more), which begin with 22 places, Z up."""
    return raw[:, :66].astype(np.float64).reshape(-1, 22, 3) @ Z_UP_TO_Y_UP.T


def encode_person(positions: Array, rotations: Array | None = None) -> Array:
    """One person's features in the frame that the positions are in.

    Args:
        positions: (T, 22, 3) metres, floor at 0, at least two frames.
        rotations: (T, 21, 6) of joints 1–21; fitted to the positions by default.

    Returns:
        (T − 1, 262) float32.
    """
    positions = np.asarray(positions, dtype=np.float64)
    frames = len(positions)
    if frames < 2:
        raise ValueError("The representation holds forward differences: give at least two frames.")
    if rotations is None:
        rotations = to_6d(fit_rotations(positions)[:, 1:])
    velocities = np.diff(positions, axis=0)
    parts = [
        positions[:-1].reshape(frames - 1, 66),
        velocities.reshape(frames - 1, 66),
        np.asarray(rotations)[:-1].reshape(frames - 1, 126),
        contact_labels(positions),
    ]
    return np.concatenate(parts, axis=-1).astype(np.float32)


def contact_labels(positions: Array) -> Array:
    """(T − 1, 4) 1.0 where an ankle or toe of (T, 22, 3) moves < √0.001 m to the next frame and is low."""
    feet = positions[:, list(FEET)]
    moved = np.sum(np.diff(feet, axis=0) ** 2, axis=-1)
    return ((moved < CONTACT_SQUARED_STEP) & (feet[:-1, :, 1] < CONTACT_HEIGHTS)).astype(np.float64)


def decode_positions(features: Array) -> Array:
    """World positions from features.

    Args:
        features: (T, 262) or (T, 524).

    Returns:
        (T + 1, 22, 3), or (2, T + 1, 22, 3) for a pair: the frame that encoding dropped comes from the last velocities.
    """
    features = np.asarray(features)
    if features.ndim != 2 or features.shape[-1] not in (NUM_FEATURES, 2 * NUM_FEATURES):
        raise ValueError(f"Features are (frames, 262) or (frames, 524), not {features.shape}.")
    if features.shape[-1] == 2 * NUM_FEATURES:
        people = np.split(features, 2, axis=-1)
        return np.stack([decode_positions(person) for person in people])
    positions = features[:, POSITIONS].reshape(-1, 22, 3)
    last = positions[-1] + features[-1, VELOCITIES].reshape(22, 3)
    return np.concatenate([positions, last[None]])


def decode_humanml3d(features: Array) -> Array:
    """(T, 22, 3) metres, Y up, of HumanML3D's features (T, 263), which T2M-GPT and MDM share (Guo et al. 2022).

    They hold the root's turn about Y (radians a frame), its velocity in its own heading (x, z), its height, and the
    places of the other 21 joints against it in that heading; what follows is not needed.
    """
    features = np.asarray(features, dtype=np.float64)
    half = np.concatenate([[0.0], np.cumsum(features[:-1, 0])])  # a quaternion's angle
    turns = heading_matrix(-2 * half)
    root = np.zeros((len(features), 3))
    steps = features[:-1, [1, 3, 2]] * FLAT
    root[1:] = np.cumsum(np.einsum("tij,tj->ti", turns[1:], steps), axis=0)
    root[:, 1] = features[:, 3]
    local = features[:, 4:67].reshape(-1, 21, 3)
    joints = local @ np.swapaxes(turns, -1, -2) + root[:, None] * FLAT
    return np.concatenate([root[:, None], joints], axis=1)


def to_6d(rotations: Array) -> Array:
    """(…, 6) the first two columns of (…, 3, 3) rotations, one after the other (Zhou et al. 2019)."""
    return np.concatenate([rotations[..., 0], rotations[..., 1]], axis=-1)


def from_6d(numbers: Array) -> Array:
    """(…, 3, 3) rotations from (…, 6) by Gram–Schmidt (Zhou et al. 2019, eq. 15)."""
    first, second = numbers[..., :3], numbers[..., 3:]
    x = unit(first)
    y = unit(square_to(second, x))
    return np.stack([x, y, np.cross(x, y)], axis=-1)
