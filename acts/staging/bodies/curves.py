"""Curves and angles of planned ways."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.floating]


def eased(time: Array, share: float) -> Array:
    """Progress 0 to 1 that takes a share of the time to get up its speed, and as much to slow down."""
    share = min(share, 0.5)
    speed = np.clip(np.minimum(time / share, (1 - time) / share + 1e-3), 0.02, 1.0)
    done = np.cumsum(speed)
    return done / done[-1]


def smoothed(line: Array) -> Array:
    """Points on a curve that rounds the corners of a line (Chaikin's, four times)."""
    for _ in range(4):
        first, last = line[:1], line[-1:]
        near, far = 0.75 * line[:-1] + 0.25 * line[1:], 0.25 * line[:-1] + 0.75 * line[1:]
        line = np.concatenate([first, np.stack([near, far], axis=1).reshape(-1, 2), last])
    return line


def filled(values: Array, known: Array, first: float) -> Array:
    """The values with the last known one where they are not known."""
    at = np.maximum.accumulate(np.where(known, np.arange(len(values)), -1))
    return np.where(at >= 0, values[at.clip(0)], first)


def bearing(line: Array) -> float:
    """The heading in radians of a line (2,) over the floor, from +Z towards +X: what :func:`direction` takes."""
    return math.atan2(line[0], line[1])


def direction(heading: float) -> Array:
    """The unit vector (x, z) of a heading in radians from +Z towards +X."""
    return np.array([math.sin(heading), math.cos(heading)])
