"""A body on the floor, by the angles of its joints: whatever is lowest touches the floor and does not glide over it.

So a body stands on its feet, on its hands or lies, and it rolls and wheels over the floor, without a word on which of
them carries it.
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import scipy  # its parts are loaded with their first use

from motion import FPS
from motion.limbs import solve_two_bones
from motion.skeleton import ARMS, HEAD_TOP, LEGS, TOES
from motion.smoothing import minimum_jerk
from motion.transforms import facing, heading_matrix
from motion.vectors import FLAT, Array

from .poses import BOTH_SIDES, JOINT, STANCE, Turns, about, ahead_of, poses_of

_CLEAR = tomllib.loads(Path(__file__).with_name("figures.toml").read_text(encoding="utf-8"))["skin"]
"""Metres from a joint to the skin below it, on which a body lies or stands."""
_CLEARANCES = np.array([_CLEAR[name.split("_")[-1]] for name in JOINT])
_SHARED = 0.008
"""Metres over the lowest joint within which others carry the body with it."""
_EVEN = 1.5
"""Frames over which the way of the body is evened out, where another joint comes to carry it."""
_LEG = ("knee", "ankle", "foot")
_ON_FLOOR, _STANDS = 0.025, 0.6
"""Metres over the floor and metres a second up to which a hand or a foot stands."""
_HOLDS, _BLEND = 5, 5
"""Frames for which it stands at least, and over which it is led to its spot."""


def grounded_poses(angles: Mapping[str, Array], place: Array, angle: float) -> Array:
    """Poses on the floor, from angles over time; the first one has its feet where a standing person has them.

    Args:
        angles: (N,) radians and metres by the names of :data:`.figures.NAMES`.
        place: (2,) x and z of the pelvis of the person who stands there, in metres.
        angle: heading in radians from +Z towards +X.

    Returns:
        (N, 22, 3) metres, one pose a frame.
    """
    poses = poses_of(_turns(angles, angle), len(angles["pitch"]))
    gaps = _gaps(poses)
    for side, _ in BOTH_SIDES:
        gaps[:, [JOINT[f"{side}_{name}"] for name in _LEG]] += angles[f"{side}_free"][:, None]
    height = -gaps.min(axis=1)
    root = _rolled(poses, gaps + height[:, None])
    root[:, 1] = height
    root = _evened(root)
    root[:, 1] += _evened(scipy.ndimage.maximum_filter1d(np.maximum(height - root[:, 1], 0.0), 3))
    root[:, 1] += angles["rise"]
    ahead, left = (heading_matrix(angle)[:, axis] for axis in (2, 0))
    root += angles["ahead"][:, None] * ahead + angles["aside"][:, None] * left
    poses = poses + root[:, None]
    return _staying(poses + ahead_of(place, angle, STANCE) - poses[0, TOES].mean(axis=0) * FLAT)


def _evened(values: Array) -> Array:
    """Values (N, …) over time without kinks."""
    return np.asarray(scipy.ndimage.gaussian_filter1d(values, _EVEN, axis=0, mode="nearest"))


def _turns(angles: Mapping[str, Array], angle: float) -> Turns:
    """Rotations (N, 3, 3) of the joints against their parents."""
    trunk = about(2, -angles["lean"] / 3) @ about(0, angles["spine"] / 3) @ heading_matrix(angles["twist"] / 3)
    head = about(2, -angles["tilt"] / 2) @ about(0, angles["neck"] / 2) @ heading_matrix(angles["look"] / 2)
    pelvis = heading_matrix(angle) @ heading_matrix(angles["yaw"])
    turns: Turns = {"pelvis": pelvis @ about(2, -angles["roll"]) @ about(0, angles["pitch"])}
    turns |= dict.fromkeys(("spine1", "spine2", "spine3"), trunk) | dict.fromkeys(("neck", "head"), head)
    for side, sign in BOTH_SIDES:
        own = {name.removeprefix(f"{side}_"): value for name, value in angles.items() if side in name}
        spread, turned = about(2, sign * own["out"]), heading_matrix(sign * own["turnout"])
        hangs = about(2, -sign * (np.pi / 2 - own["side"]))
        turns[f"{side}_hip"] = turned @ about(0, -own["hip"]) @ spread
        turns[f"{side}_knee"] = about(0, own["knee"])
        turns[f"{side}_ankle"] = about(0, own["ankle"])
        turns[f"{side}_collar"] = about(2, sign * own["shrug"])
        turns[f"{side}_shoulder"] = about(0, -own["arm"]) @ hangs @ about(0, own["rotate"])
        turns[f"{side}_elbow"] = heading_matrix(-sign * own["elbow"])
    return turns


def _gaps(poses: Array) -> Array:
    """(N, 23) metres of the skin at each joint, and of the top of the head, over the height of the pelvis."""
    neck, head = (poses[:, JOINT[name]] for name in ("neck", "head"))
    up = (head - neck)[:, 1] / np.linalg.norm(head - neck, axis=1).clip(min=1e-6)
    crown = head[:, 1] + HEAD_TOP * up
    return np.concatenate([poses[..., 1] - _CLEARANCES, crown[:, None]], axis=1)


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
            shift = _to_its_spot(poses[:, tip], float(_CLEARANCES[tip]))
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
