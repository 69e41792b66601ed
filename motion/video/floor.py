"""The floor under filmed people: how the camera is tilted, and a path on which standing feet stay where they are."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy  # its parts are loaded with their first use
from numpy.typing import NDArray

from motion.skeleton import SMPL22

from .place import smooth, upright

Array = NDArray[np.floating]

_ANKLES = [SMPL22.index("left_ankle"), SMPL22.index("right_ankle")]
_TOES = [SMPL22.index("left_foot"), SMPL22.index("right_foot")]
_LEAN = np.radians(6.0)
"""By how much people lean on the whole, and by how much the network tilts them."""
_UNEVEN = 0.04
"""Metres by which the height of a standing foot is uncertain."""
_REACH = (1.2, 0.8, 0.4)
"""Speeds in m/s at which a foot's share of standing has fallen to 1/e, one for each round of the correction."""
_LIFTED = 0.05
"""Metres above the lower foot at which a foot's share of standing has fallen to 1/e."""
_GLIDE, _BENDS = 0.2, 10.0
"""m/s by which a standing foot may glide, m/s² by which the correction may accelerate."""
_LOOSE = (0.06, 0.2)
"""Metres by which the path from the picture may be off, across and along the line of sight."""
_INDEPENDENT = 0.5
"""Seconds after which the error of a foot's height is another one."""


def level(people: Sequence[Array], lean: Sequence[float], fps: float = 15.0) -> float:
    """Radians by which the camera looks down: people are upright, and their standing feet are on one plane.

    Args:
        people: (T, 22, 3) joints of each along the axes right, up and towards the camera, not yet levelled.
        lean: the tilt at which each person would be upright on the whole.
    """
    tilt = float(np.mean(lean))
    flip = np.diag([1.0, -1.0, -1.0])
    for _ in range(4):
        turn = upright(tilt) @ flip
        # How the height of the feet changes with the tilt, and what it should change by: least squares.
        normal = len(people) / _LEAN**2
        right = sum((each - tilt) / _LEAN**2 for each in lean)
        for positions in people:
            feet = (positions @ turn.T)[:, _ANKLES]
            low = feet[..., 1].min(axis=1)
            far = np.take_along_axis(feet[..., 2], feet[..., 1].argmin(axis=1)[:, None], axis=1)[:, 0]
            weight = 1 / _UNEVEN**2 / max(_INDEPENDENT * fps, 1.0)
            away, height = far - far.mean(), low - low.mean()
            # Turning by δ lifts what is nearer to the camera by δ times its distance.
            normal += weight * float(away @ away)
            right -= weight * float(away @ height)
        step = right / normal
        tilt += float(np.clip(step, -0.2, 0.2))
    return tilt


def steady_path(positions: Array, fps: float) -> Array:
    """Moves whole frames so that feet that stand stay in place and the lower foot is on the floor.

    The shift along the floor solves least squares: the lower foot does not move while it is slow against the body,
    and the shift itself accelerates little. The height follows the lower foot slowly, so that jumps remain.

    Args:
        positions: (T, 22, 3) metres, Y up.
        fps: frames a second.

    Returns:
        (T, 22, 3) with the floor at 0.
    """
    moved = np.array(positions, dtype=np.float64)
    moved[..., 1] -= _ground(moved, fps)[:, None]
    if len(moved) < 3:
        return moved
    for reach in _REACH:  # what glides at first stands once the path is better
        moved[..., [0, 2]] += _shift(*_standing(moved, fps, reach), fps)[:, None]
    return moved


def _standing(positions: Array, fps: float, reach: float) -> tuple[Array, Array]:
    """(T, 2) velocity of the foot that stands, m/s, and (T,) how surely one stands, 0 to 1."""
    feet = (positions[:, _ANKLES] + positions[:, _TOES]) / 2
    velocity = np.gradient(feet[..., [0, 2]], axis=0) * fps
    lifted = feet[..., 1] - feet[..., 1].min(axis=1, keepdims=True)
    speed = np.linalg.norm(velocity, axis=-1)
    stands = np.exp(-((lifted / _LIFTED) ** 2)) * np.exp(-((speed / reach) ** 2)) + 1e-9
    drift = (velocity * stands[..., None]).sum(axis=1) / stands.sum(axis=1)[:, None]
    return drift, stands.max(axis=1)


def _shift(drift: Array, share: Array, fps: float) -> Array:
    """(T, 2) the shift whose velocity takes away ``drift`` where ``share`` is 1, and which is small and smooth."""
    frames = len(drift)
    difference = scipy.sparse.diags([-1.0, 1.0], [0, 1], shape=(frames - 1, frames)) * fps
    second = scipy.sparse.diags([1.0, -2.0, 1.0], [0, 1, 2], shape=(frames - 2, frames)) * fps**2
    between = (share[1:] + share[:-1]) / 2
    weight = scipy.sparse.diags(between / _GLIDE**2)
    wanted = difference.T @ weight @ ((drift[1:] + drift[:-1]) / -2)
    shift = np.empty((frames, 2))
    for axis, loose in enumerate(_LOOSE):
        system = difference.T @ weight @ difference + second.T @ second / _BENDS**2
        system = (system + scipy.sparse.identity(frames) / loose**2).tocsc()
        shift[:, axis] = scipy.sparse.linalg.spsolve(system, wanted[:, axis])
    return shift


def _ground(positions: Array, fps: float) -> Array:
    """(T,) the height of the floor under the person: the low points of the lower foot, smoothed."""
    low = np.minimum(positions[:, _TOES, 1].min(axis=1), positions[:, _ANKLES, 1].min(axis=1) - 0.06)
    window = max(3, round(1.2 * fps)) | 1
    lowest = scipy.ndimage.percentile_filter(low, 20, size=min(window, 2 * len(low) - 1), mode="nearest")
    return smooth(lowest[:, None], fps, seconds=1.0)[:, 0]
