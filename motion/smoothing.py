"""Paths without jolts: the least sum of squared third differences, as people's hands and feet move.

Flash and Hogan 1985, "The coordination of arm movements": between places that are given, the path of least jerk is the
one that people take. Here it is found for sampled paths and held to what was made by weights (Whittaker 1923; Eilers
2003, "A perfect smoother", of third order), in time linear in the number of frames.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy  # its parts are loaded with their first use
from numpy.typing import ArrayLike, NDArray

from .errors import InputError
from .vectors import Array

_FIXED = 1e7
"""Weight of a frame that must stay, against third differences whose squared coefficients sum to 20."""
REACH = 10
"""Frames beside fixed ones over which a path is led to them."""
_SLACK = 1e-3
"""Weight of what was made right beside a fixed frame; there the path keeps what is slower than 1.5 Hz."""


def least_jerk(values: Array, weights: Array) -> Array:
    """The path that departs least from ``values`` (T, …), by ``weights`` (T,), and has small third differences.

    With weights of 1 it keeps what is slower than 4.8 Hz at 30 frames a second; of w, w^(1/6) times that.
    """
    flat = np.asarray(values, dtype=np.float64).reshape(len(values), -1)
    if len(flat) < 4:
        return np.array(values, dtype=np.float64)
    middle = flat.mean(axis=0)  # differences of small numbers
    banded = squared_differences(len(flat), (-1.0, 3.0, -3.0, 1.0))
    banded[-1] += weights
    offsets = scipy.linalg.solveh_banded(banded, weights[:, None] * (flat - middle), check_finite=False)
    return np.asarray(offsets + middle).reshape(np.shape(values))


def led(values: Array, fixed: NDArray[np.bool_]) -> Array:
    """A path (T, …) that stays where it is at ``fixed`` (T,) frames and leads there without a jolt.

    Only frames within :data:`REACH` of a fixed one move, and the nearer they are, the freer they are.
    """
    if not fixed.any() or fixed.all():
        return np.array(values, dtype=np.float64)
    away = frames_from(fixed)
    stays = fixed | (away > REACH)
    path = least_jerk(values, np.where(stays, _FIXED, _SLACK ** (1 - away / (REACH + 1))))
    path[stays] = values[stays]
    return path


def filled(positions: Array, label: str = "The motion") -> Array:
    """(T, J, 3) in which joints that are not finite are interpolated over time, and held at the ends.

    Raises:
        InputError: for a joint that is never there, which ``label`` holds.
    """
    lost = np.asarray(~np.isfinite(positions).all(axis=-1))
    if not lost.any():
        return positions
    if lost.all(axis=0).any():
        raise InputError(f"{label} holds a joint that is NaN in every frame: export it again.")
    complete, times = np.array(positions), np.arange(len(positions))
    for joint in np.flatnonzero(lost.any(axis=0)):
        seen = np.flatnonzero(~lost[:, joint])
        for axis in range(3):
            complete[:, joint, axis] = np.interp(times, seen, positions[seen, joint, axis])
    return complete


def frames_from(marked: NDArray[np.bool_]) -> Array:
    """(T,) distance in frames from the nearest frame that is ``marked`` (T,); T where none is."""
    distances = (
        scipy.ndimage.distance_transform_edt(~marked) if marked.any() else np.full(len(marked), float(len(marked)))
    )
    return np.asarray(distances)


def squared_differences(count: int, coefficients: Sequence[float]) -> Array:
    """(n, count) the upper bands of D'D for ``solveh_banded``; D takes differences of n coefficients."""
    last = len(coefficients) - 1
    bands = np.zeros((last + 1, count))
    for i in range(last + 1):
        for j in range(i, last + 1):
            bands[last - (j - i), j : count - last + j] += coefficients[i] * coefficients[j]
    return bands


def without_flicker(marked: NDArray[np.bool_], shortest: int) -> NDArray[np.bool_]:
    """Marked frames (T,) without gaps and stretches that are shorter than so many frames."""
    padded = np.pad(marked, shortest, mode="edge")
    closed = scipy.ndimage.binary_closing(padded, np.ones(shortest + 1))
    return np.asarray(scipy.ndimage.binary_opening(closed, np.ones(shortest))[shortest:-shortest])


def begun_before(need: Array, frames: int, eased: float) -> Array:
    """(T,) at least about ``need`` (T,), without kinks: it begins ``frames`` earlier and ends as much later.

    ``eased`` is the width, in frames, of the Gaussian that rounds it.
    """
    widened = scipy.ndimage.maximum_filter1d(need, 2 * frames + 1, mode="nearest")
    return np.asarray(scipy.ndimage.gaussian_filter1d(widened, eased, mode="nearest"))


def eased_marks(marked: NDArray[np.bool_], frames: int) -> Array:
    """(T,) 1 at marked frames, and along a minimum-jerk course to 0 within so many frames beside them."""
    return minimum_jerk(1 - frames_from(marked) / (frames + 1)) * marked.any()


# ---- Easing between two states ---------------------------------------------------------------------------------------
def smoothstep(value: ArrayLike, low: float = 0.0, high: float = 1.0) -> NDArray[np.floating]:
    """0 up to ``low``, 1 from ``high`` on, and between them 3 s² - 2 s³ of the share s of the way; of any shape."""
    share = np.clip((np.asarray(value) - low) / (high - low), 0.0, 1.0)
    return share * share * (3 - 2 * share)


def minimum_jerk(value: ArrayLike) -> NDArray[np.floating]:
    """0 up to 0, 1 from 1 on, and between them the course of least jerk, 10 s³ - 15 s⁴ + 6 s⁵; of any shape."""
    share = np.clip(np.asarray(value), 0.0, 1.0)
    return share**3 * (10 - 15 * share + 6 * share**2)
