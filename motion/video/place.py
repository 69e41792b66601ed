"""The path of a filmed person: from points in the picture and points about the hips to a path in metres.

Axes of the camera: x to the right of the picture, y down, z away from it.
"""

from __future__ import annotations

import numpy as np
import scipy  # its parts are loaded with their first use
from numpy.typing import NDArray

from .landmarks import INDEX, LIMBS
from .tracks import Track

Array = NDArray[np.floating]

LENS = 70.0
"""Degrees from corner to corner of the picture of an ordinary phone's or laptop's camera."""
_NEAREST = 0.3
"""Metres."""
_ROBUST = 0.05
"""A point that is this share of the distance to the person off counts half."""


def focal_length(width: int, height: int, lens: float = LENS) -> float:
    """Pixels of a metre at a metre's distance, for a lens that sees ``lens`` degrees from corner to corner."""
    return float(np.hypot(width, height) / 2 / np.tan(np.radians(lens) / 2))


def towards(pixels: Array, focal: float) -> Array:
    """(T, 3, 3) rotation from the line of sight to the person, along which the network sees them, to the camera's.

    Args:
        pixels: (T, 33, 2) from the middle of the picture.
    """
    middle = pixels[:, LIMBS].mean(axis=1)
    sight = np.column_stack([middle, np.full(len(middle), focal)])
    sight /= np.linalg.norm(sight, axis=-1, keepdims=True)
    x, y, z = sight.T
    # The smallest rotation that turns (0, 0, 1) onto the line of sight.
    share = 1 / (1 + z)
    rows = [1 - x * x * share, -x * y * share, x, -x * y * share, 1 - y * y * share, y, -x, -y, z]
    return np.stack(rows, axis=-1).reshape(-1, 3, 3)


def translation(world: Array, pixels: Array, seen: Array, focal: float) -> Array:
    """(T, 3) metres from the camera to the middle of the hips at which the points fall where they are seen.

    For every point, focal · (x + t_x) = u · (z + t_z), and the same for y: linear least squares a frame, made
    robust by weights.

    Args:
        world: (T, 33, 3) metres about the hips, along the camera's axes.
        pixels: (T, 33, 2) from the middle of the picture.
        seen: (T, 33) weights.
    """
    rows = np.zeros((*pixels.shape[:2], 2, 3))
    rows[..., 0, 0] = rows[..., 1, 1] = 1.0
    rows[..., 2] = -pixels / focal
    known = pixels / focal * world[..., 2:] - world[..., :2]
    weights = seen**2 + 1e-4
    found = np.zeros((len(world), 3))
    for _ in range(3):
        scaled = rows * weights[..., None, None]
        normal = np.einsum("tpki,tpkj->tij", scaled, rows)
        right = np.einsum("tpki,tpk->ti", scaled, known)
        found = np.linalg.solve(normal, right[..., None])[..., 0]
        off = np.linalg.norm(np.einsum("tpki,ti->tpk", rows, found) - known, axis=-1)
        weights = (seen**2 + 1e-4) / (1 + (off / _ROBUST) ** 2)
    found[:, 2] = np.maximum(found[:, 2], _NEAREST)
    return found


def smooth(values: Array, fps: float, *, seconds: float, weights: Array | None = None) -> Array:
    """Whittaker's smoother (1923) without lag: the path that is near ``values`` and accelerates little.

    Args:
        values: (T, D); not finite where unknown.
        fps: frames a second.
        seconds: about the time over which is smoothed.
        weights: (T,) trust in each frame; 1 by default.
    """
    known = np.asarray(np.isfinite(values).all(axis=-1))
    trust = np.asarray(known * (1.0 if weights is None else weights))
    frames = len(values)
    if frames < 3:
        return np.where(known[:, None], values, 0.0)
    second = (1.0, -2.0, 1.0)
    strength = (seconds * fps / (2 * np.pi)) ** 4 * 16
    bands = np.zeros((3, frames))
    for row in range(frames - 2):
        for i in range(3):
            for j in range(i + 1):
                bands[i - j, row + j] += strength * second[i] * second[j]
    bands[0] += trust + 1e-9
    right = np.where(known[:, None], values, 0.0) * trust[:, None]
    return scipy.linalg.solveh_banded(bands, right, lower=True)


def body_tilt(world: Array, seen: Array) -> float:
    """Radians by which the camera looks down, if the person stands upright on the whole.

    Args:
        world: (T, 33, 3) metres about the hips, along the camera's axes.
        seen: (T, 33) weights.
    """
    head = world[:, [INDEX["left_shoulder"], INDEX["right_shoulder"]]].mean(axis=1)
    foot = world[:, [INDEX["left_ankle"], INDEX["right_ankle"]]].mean(axis=1)
    found = np.isfinite(head).all(axis=-1) & np.isfinite(foot).all(axis=-1)
    up, seen = (head - foot)[found], seen[found]
    length = np.asarray(np.linalg.norm(up, axis=-1))
    # Who bends or kicks says nothing about the vertical.
    tall = length > 0.9 * np.percentile(length, 90)
    mean = np.average(up[tall] / length[tall, None], axis=0, weights=seen[tall].mean(axis=1) + 1e-6)
    return float(np.arctan2(-mean[2], -mean[1]))


def upright(tilt: float) -> Array:
    """(3, 3) from the camera's axes to the world's: x to the right, y up, z towards the camera."""
    sin, cos = np.sin(tilt), np.cos(tilt)
    return np.array([[1.0, 0.0, 0.0], [0.0, -cos, -sin], [0.0, sin, -cos]])


def centred(track: Track, width: int, height: int) -> Array:
    """(T, 33, 2) pixels from the middle of the picture."""
    return track.pixels - np.array([width, height]) / 2
