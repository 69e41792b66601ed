"""Vectors, angles and stretches of frames."""

from __future__ import annotations

import math
from typing import Any, TypeVar

import numpy as np
import scipy  # its parts are loaded with their first use
from numpy.typing import NDArray

Array = NDArray[np.floating]
FLAT = np.array([1.0, 0.0, 1.0])
"""Times a vector or a place: its part along the floor."""
Angle = TypeVar("Angle", float, Array)
Real = TypeVar("Real", bound=np.floating[Any])


def unit(vectors: NDArray[Real]) -> NDArray[Real]:
    """(…, N) the same directions at length 1; zeros stay zero."""
    return np.asarray(vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-12))


def left_of(way: Array) -> Array:
    """(…, 3) what is to the left of level ways (…, 3), as long as they are."""
    return np.stack([way[..., 2], np.zeros(way.shape[:-1]), -way[..., 0]], axis=-1)


def square_to(vectors: Array, axis: Array) -> Array:
    """(…, 3) vectors without their part along unit vectors (…, 3)."""
    return np.asarray(vectors - np.sum(vectors * axis, axis=-1, keepdims=True) * axis)


def heading_of(way: Array) -> Array:
    """(…,) radians from +Z towards +X of directions (…, 3) as seen from above."""
    return np.asarray(np.arctan2(way[..., 0], way[..., 2]))


def bearing(line: Array) -> float:
    """The heading in radians of a line (2,) over the floor, from +Z towards +X: what :func:`direction` takes."""
    return math.atan2(line[0], line[1])


def direction(heading: float | Array) -> Array:
    """The unit vectors (…, 2), x and z, of headings (…) in radians from +Z towards +X."""
    return np.stack([np.sin(heading), np.cos(heading)], axis=-1)


def leftwards(heading: float | Array) -> Array:
    """The unit vectors (…, 2), x and z, to the left of headings (…) in radians."""
    return np.stack([np.cos(heading), -np.sin(heading)], axis=-1)


def floor_points(places: Array) -> Array:
    """(…, 3) the points on the floor of places (…, 2), x and z."""
    return np.insert(places, 1, 0.0, axis=-1)


def square_frame(up: Array, across: Array) -> Array:
    """(…, 3, 3) rotation whose Y column is ``up`` and whose X column is ``across`` made square to it; both (…, 3)."""
    y = unit(up)
    x = unit(square_to(across, y))
    return np.stack([x, y, np.cross(x, y)], axis=-1)


def rotations_by(vectors: Array) -> Array:
    """(…, 3, 3) rotations by the length of vectors (…, 3), radians, about their directions."""
    turns = scipy.spatial.transform.Rotation.from_rotvec(vectors.reshape(-1, 3)).as_matrix()
    return np.asarray(turns).reshape(*vectors.shape, 3)


def rotation_vectors(rotations: Array) -> Array:
    """(…, 3) the other way round: axes of rotations (…, 3, 3), as long as the angles in radians."""
    turns = scipy.spatial.transform.Rotation.from_matrix(rotations.reshape(-1, 3, 3)).as_rotvec()
    return np.asarray(turns).reshape(rotations.shape[:-1])


def slerp(first: Array, second: Array, share: Array) -> Array:
    """Rotations (…, 3, 3) a ``share`` (…,) of the shortest way from first to second; it is broadcast."""
    return first @ rotations_by(share[..., None] * rotation_vectors(np.swapaxes(first, -1, -2) @ second))


def travelled(path: Array) -> Array:
    """(N,) metres along a path (N, D) to each of its points."""
    return np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=-1))])


def floor_speed(place: Array, fps: float) -> Array:
    """(T,) metres a second over the floor of a joint (T, 3)."""
    return np.asarray(np.linalg.norm(np.gradient(place[:, [0, 2]], axis=0), axis=-1) * fps)


def wrapped(angle: Angle) -> Angle:
    """The same angle in [-π, π), radians."""
    return (angle + np.pi) % (2 * np.pi) - np.pi


def runs(mask: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """(start, stop) of each stretch of True in (T,)."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], mask.astype(np.int8), [0]])))
    return list(zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True))
