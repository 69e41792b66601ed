"""A body on the floor, by the angles of its joints: whatever is lowest touches the floor and does not glide over it.

So a body stands on its feet, on its hands or lies, and it rolls and wheels over the floor, without a word on which of
them carries it.
"""

from __future__ import annotations

import numpy as np
import scipy  # its parts are loaded with their first use

from motion import FPS
from motion.limbs import solve_two_bones
from motion.skeleton import ARMS, LEGS, SIDES, TOES
from motion.smoothing import minimum_jerk
from motion.transforms import facing, heading_matrix
from motion.vectors import FLAT, Array, direction, floor_points

from .poses import CLEARANCES, JOINT, NAMES, STANCE, bodies, gaps

_SHARED = 0.008
"""Metres over the lowest joint within which others carry the body with it."""
_EVEN = 1.5
"""Frames over which the way of the body is evened out, where another joint comes to carry it."""
_LEG = ("knee", "ankle", "foot")
_ON_FLOOR, _STANDS = 0.025, 0.6
"""Metres over the floor and metres a second up to which a hand or a foot stands."""
_HOLDS, _BLEND = 5, 5
"""Frames for which it stands at least, and over which it is led to its spot."""


def grounded_poses(angles: Array, place: Array, angle: float) -> Array:
    """Poses on the floor, from angles over time; the first one has its feet where a standing person has them.

    Args:
        angles: (N, len(NAMES)) radians and metres, in the order of :data:`.poses.NAMES`.
        place: (2,) x and z of the pelvis of the person who stands there, in metres.
        angle: heading in radians from +Z towards +X.

    Returns:
        (N, 22, 3) metres, one pose a frame.
    """
    poses, of = bodies(angles, angle), dict(zip(NAMES, angles.T, strict=True))
    over = gaps(poses)
    for side in SIDES:
        over[:, [JOINT[f"{side}_{name}"] for name in _LEG]] += of[f"{side}_free"][:, None]
    height = -over.min(axis=1)
    root = _rolled(poses, over + height[:, None])
    root[:, 1] = height
    root = _evened(root)
    root[:, 1] += _evened(scipy.ndimage.maximum_filter1d(np.maximum(height - root[:, 1], 0.0), 3))
    root[:, 1] += of["rise"]
    ahead, left = (heading_matrix(angle)[:, axis] for axis in (2, 0))
    root += of["ahead"][:, None] * ahead + of["aside"][:, None] * left
    poses = poses + root[:, None]
    return _staying(poses + floor_points(place + STANCE * direction(angle)) - poses[0, TOES].mean(axis=0) * FLAT)


def _evened(values: Array) -> Array:
    """Values (N, …) over time without kinks."""
    return np.asarray(scipy.ndimage.gaussian_filter1d(values, _EVEN, axis=0, mode="nearest"))


def _rolled(poses: Array, over: Array) -> Array:
    """(N, 3) places of the pelvis on the floor from which the lowest joints do not glide.

    Args:
        poses: (N, 22, 3) metres from the pelvis.
        over: (N, 23) metres of each joint, and the top of the head, over the lowest one.
    """
    points = np.concatenate([poses, poses[:, JOINT["head"]][:, None]], axis=1)
    weights = np.exp(-over / _SHARED)
    shared = weights[:-1] * weights[1:]
    steps = np.einsum("np,npc->nc", shared, np.diff(points, axis=0)) / shared.sum(axis=1, keepdims=True)
    return np.concatenate([np.zeros((1, 3)), -np.cumsum(steps, axis=0)]) * FLAT


def _staying(poses: Array) -> Array:
    """Poses (N, 22, 3) whose hands and feet stay where they were put on the floor, and are not below it."""
    result, forward = poses.copy(), facing(poses)
    backward = -forward + np.array([0.0, -1.0, 0.0])
    for limbs, pole in ((ARMS, backward), (LEGS, forward)):
        for root, middle, end, *toe in limbs:
            tip = toe[0] if toe else end
            shift = _to_its_spot(poses[:, tip], float(CLEARANCES[tip]))
            moved = np.flatnonzero(np.abs(shift).sum(axis=1) > 0)
            first, second, third = (poses[moved, joint] for joint in (root, middle, end))
            bent, put = solve_two_bones(first, second, third, third + shift[moved], pole[moved], soft=0.01)
            for joint in toe:
                result[moved, joint] += put - third
            result[moved, middle], result[moved, end] = bent, put
    return result


def _to_its_spot(tip: Array, clearance: float) -> Array:
    """(N, 3) metres that lead the tip of a limb (N, 3) to the spot on which it stands; 0 where it is in the air."""
    speed = np.linalg.norm(np.gradient(tip[:, [0, 2]], axis=0), axis=1) * FPS
    stands = (tip[:, 1] < clearance + _ON_FLOOR) & (speed < _STANDS)
    shift = np.zeros_like(tip)
    labels, count = scipy.ndimage.label(scipy.ndimage.binary_closing(stands, iterations=2) | stands)
    for number in range(1, count + 1):
        at = np.flatnonzero(labels == number)
        if len(at) < _HOLDS:
            continue
        near = np.arange(max(at[0] - _BLEND, 0), min(at[-1] + _BLEND + 1, len(tip)))
        away = np.maximum(np.maximum(at[0] - near, near - at[-1]), 0) / (_BLEND + 1)
        spot = np.median(tip[at], axis=0) * FLAT + [0, clearance, 0]
        off = spot - tip[at[np.searchsorted(at, near).clip(max=len(at) - 1)]]
        shift[near] = minimum_jerk(1 - away)[:, None] * off
    shift[:, 1] = np.maximum(shift[:, 1], clearance - tip[:, 1])
    return shift
