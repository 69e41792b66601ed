"""The path of a filmed person: from points in the picture and points about the hips to a path in metres.

Axes of the camera: x to the right of the picture, y down, z away from it.
"""

from __future__ import annotations

import numpy as np
import scipy  # its parts are loaded with their first use

from motion.kinematics import swing
from motion.skeleton import SMPL22, TOES
from motion.smoothing import squared_differences
from motion.vectors import Array

from .landmarks import INDEX, LIMBS

LENS = 70.0
"""Degrees from corner to corner of the picture of an ordinary phone's or laptop's camera."""
_NEAREST = 0.3
"""Metres."""
_ROBUST = 0.05
"""A point that is this share of the distance to the person off counts half."""


def focal_length(width: int, height: int) -> float:
    """Pixels of a metre at a metre's distance, for a lens of :data:`LENS`."""
    return float(np.hypot(width, height) / 2 / np.tan(np.radians(LENS) / 2))


def towards(pixels: Array, focal: float) -> Array:
    """(T, 3, 3) rotation from the line of sight to the person, along which the network sees them, to the camera's.

    Args:
        pixels: (T, 33, 2) from the middle of the picture.
    """
    middle = pixels[:, LIMBS].mean(axis=1)
    sight = np.column_stack([middle, np.full(len(middle), focal)])
    return swing(np.array([0.0, 0.0, 1.0]), sight)


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
    places = np.zeros((len(world), 3))
    for _ in range(3):
        scaled = rows * weights[..., None, None]
        normal = np.einsum("tpki,tpkj->tij", scaled, rows)
        right = np.einsum("tpki,tpk->ti", scaled, known)
        places = np.linalg.solve(normal, right[..., None])[..., 0]
        off = np.linalg.norm(np.einsum("tpki,ti->tpk", rows, places) - known, axis=-1)
        weights = (seen**2 + 1e-4) / (1 + (off / _ROBUST) ** 2)
    places[:, 2] = np.maximum(places[:, 2], _NEAREST)
    return places


def smooth(values: Array, fps: float, *, seconds: float) -> Array:
    """Whittaker's smoother (1923) without lag: the path that is near ``values`` and accelerates little.

    Args:
        values: (T, D); not finite where unknown.
        fps: frames a second.
        seconds: about the time over which is smoothed.
    """
    known = np.asarray(np.isfinite(values).all(axis=-1))
    frames = len(values)
    if frames < 3:
        return np.where(known[:, None], values, 0.0)
    bands = (seconds * fps / (2 * np.pi)) ** 4 * 16 * squared_differences(frames, (1.0, -2.0, 1.0))
    bands[-1] += known + 1e-9
    return scipy.linalg.solveh_banded(bands, np.where(known[:, None], values, 0.0))


def body_tilt(world: Array, seen: Array) -> float:
    """Radians by which the camera looks down, if the person stands upright on the whole.

    Args:
        world: (T, 33, 3) metres about the hips, along the camera's axes.
        seen: (T, 33) weights.
    """
    head = world[:, [INDEX["left_shoulder"], INDEX["right_shoulder"]]].mean(axis=1)
    foot = world[:, [INDEX["left_ankle"], INDEX["right_ankle"]]].mean(axis=1)
    usable = np.isfinite(head).all(axis=-1) & np.isfinite(foot).all(axis=-1)
    up, seen = (head - foot)[usable], seen[usable]
    length = np.asarray(np.linalg.norm(up, axis=-1))
    # Who bends or kicks says nothing about the vertical.
    tall = length > 0.9 * np.percentile(length, 90)
    mean = np.average(up[tall] / length[tall, None], axis=0, weights=seen[tall].mean(axis=1) + 1e-6)
    return float(np.arctan2(-mean[2], -mean[1]))


def upright(tilt: float) -> Array:
    """(3, 3) from the camera's axes to the world's: x to the right, y up, z towards the camera."""
    sin, cos = np.sin(tilt), np.cos(tilt)
    return np.array([[1.0, 0.0, 0.0], [0.0, -cos, -sin], [0.0, sin, -cos]])


# ---- The floor: how the camera is tilted, and a path on which standing feet stay where they are ----------------------
_ANKLES = [SMPL22.index("left_ankle"), SMPL22.index("right_ankle")]
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


def level(positions: Array, lean: float, fps: float = 15.0) -> float:
    """Radians by which the camera looks down: the person is upright, and standing feet are on one plane.

    Args:
        positions: (T, 22, 3) joints along the axes right, up and towards the camera, not yet levelled.
        lean: the tilt at which the person would be upright on the whole.
    """
    tilt = lean
    flip = np.diag([1.0, -1.0, -1.0])
    for _ in range(4):
        turn = upright(tilt) @ flip
        # How the height of the feet changes with the tilt, and what it should change by: least squares.
        feet = (positions @ turn.T)[:, _ANKLES]
        low = feet[..., 1].min(axis=1)
        far = np.take_along_axis(feet[..., 2], feet[..., 1].argmin(axis=1)[:, None], axis=1)[:, 0]
        weight = 1 / _UNEVEN**2 / max(_INDEPENDENT * fps, 1.0)
        away, height = far - far.mean(), low - low.mean()
        # Turning by δ lifts what is nearer to the camera by δ times its distance.
        normal = 1 / _LEAN**2 + weight * float(away @ away)
        right = (lean - tilt) / _LEAN**2 - weight * float(away @ height)
        tilt += float(np.clip(right / normal, -0.2, 0.2))
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
    feet = (positions[:, _ANKLES] + positions[:, TOES]) / 2
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
    low = np.minimum(positions[:, TOES, 1].min(axis=1), positions[:, _ANKLES, 1].min(axis=1) - 0.06)
    window = max(3, round(1.2 * fps)) | 1
    lowest = scipy.ndimage.percentile_filter(low, 20, size=min(window, 2 * len(low) - 1), mode="nearest")
    return smooth(lowest[:, None], fps, seconds=1.0)[:, 0]
