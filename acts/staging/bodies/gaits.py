"""Gaits of people who are low: they crawl on hands and knees, or walk on their knees.

The network knows neither, so the whole body is given: one pose a place, its phase the way that was gone.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

from motion import SMPL22
from motion.kinematics import forward_kinematics
from motion.transforms import heading_matrix

from .poses import SOLE, about

Array = NDArray[np.floating]

CYCLE = 0.46
"""Metres of two steps, so that a knee stays where it was set down while the other one moves."""
_SWING, _LIFT = 0.3, 0.12
"""Radians of a thigh or an arm to either side of the vertical, and by which a knee is bent more as it comes forward."""
_LEVEL, _TALL = 1.35, 0.08
"""Radians by which the trunk of a person leans who crawls, and who walks on the knees."""
_SIDES = (("left", 1.0), ("right", -1.0))


def low_gait(gait: str, places: Array, headings: Array) -> Array:
    """A person who goes low over the floor.

    Args:
        gait: a name of :data:`GAITS`.
        places: (N, 2) x and z of the pelvis in metres, one after another.
        headings: (N,) radians from +Z towards +X.

    Returns:
        (N, 22, 3) metres, on the floor.
    """
    steps = np.linalg.norm(np.diff(places, axis=0, prepend=places[:1]), axis=1)
    phase = 2 * math.pi * np.cumsum(steps) / CYCLE
    poses = forward_kinematics(GAITS[gait](phase, headings), np.zeros((len(places), 3)))
    poses += np.insert(places, 1, SOLE - poses[..., 1].min(axis=1), axis=1)[:, None]
    return poses


def on_all_fours(place: Array, angle: float) -> Array:
    """Somebody on hands and knees, the pelvis over a place (x, z) and the face to a heading: (22, 3) metres."""
    return low_gait("crawls", np.asarray(place, dtype=float)[None], np.array([angle]))[0]


def _crawls(phase: Array, headings: Array) -> Array:
    """Rotations (N, 22, 3, 3) on hands and knees; a hand and the knee of the other side move together."""
    turns = _on_knees(phase, headings, _LEVEL)
    for side, sign in _SIDES:
        arm = about(0, math.pi / 2 - _LEVEL + _SWING * np.sin(phase + (math.pi if sign > 0 else 0.0)))
        turns[:, SMPL22.index(f"{side}_shoulder")] = arm @ heading_matrix(-sign * 1.5)
    turns[:, SMPL22.index("neck")] = about(0, -0.5)
    return turns


def _kneels(phase: Array, headings: Array) -> Array:
    """Rotations (N, 22, 3, 3) on the knees, the trunk upright and the arms hanging."""
    turns = _on_knees(phase, headings, _TALL)
    for side, sign in _SIDES:
        turns[:, SMPL22.index(f"{side}_shoulder")] = about(2, -sign * 1.35)
        turns[:, SMPL22.index(f"{side}_elbow")] = heading_matrix(-sign * 0.4)
    return turns


def _on_knees(phase: Array, headings: Array, lean: float) -> Array:
    """Rotations (N, 22, 3, 3) of a person whose thighs swing about the vertical and whose shins lie on the floor."""
    turns = np.tile(np.eye(3), (len(phase), SMPL22.num_joints, 1, 1))
    turns[:, 0] = np.stack([heading_matrix(float(angle)) for angle in headings]) @ about(0, lean)
    for side, sign in _SIDES:
        own = phase + (0.0 if sign > 0 else math.pi)
        swing, lift = _SWING * np.sin(own), _LIFT * np.maximum(-np.cos(own), 0.0)
        turns[:, SMPL22.index(f"{side}_hip")] = about(0, swing - lift - lean)
        turns[:, SMPL22.index(f"{side}_knee")] = about(0, math.pi / 2 - swing + lift)
        turns[:, SMPL22.index(f"{side}_ankle")] = about(0, np.full(len(phase), 0.95))
    return turns


GAITS: Mapping[str, Callable[[Array, Array], Array]] = {"crawls": _crawls, "on the knees": _kneels}
"""The gaits: rotations of the joints, of the phase (N,) in radians and of the heading (N,)."""
