"""From MakeHuman's stance to the pose in which a body is bound to SMPL22."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.spatial.transform import Rotation

from motion.skeleton import SMPL22

from .makehuman import J, Look, MakeHuman

SIDES = ("left", "right")
CUBES = {
    "hip": "upper-leg", "knee": "knee", "ankle": "ankle", "foot": "toe-2-1",
    "collar": "clavicle", "shoulder": "shoulder", "elbow": "elbow", "wrist": "hand",
}  # fmt: skip
"""Joints of the limbs and the helper cubes that mark them."""
CHAIN = {"collar": "shoulder", "shoulder": "elbow", "elbow": "wrist", "wrist": None,
         "hip": "knee", "knee": "ankle", "ankle": "foot", "foot": None}  # fmt: skip
"""Joints of a side and the next joint of their limb."""

Points = dict[str, np.ndarray]
"""Places (3,) of the joints of the limbs, by name."""


def bind(
    mh: MakeHuman, shape: np.ndarray, weights: np.ndarray, look: Look
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Vertices, joints (22, 3) and turns (22, 3, 3) of the pose in which the body is bound.

    Legs and trunk stand as SMPL22's rest pose stands, on a floor at 0; the arms keep MakeHuman's directions with
    SMPL22's lengths. A turn takes a bone from this pose to SMPL22's T-pose.
    """
    rest = SMPL22.rest_positions()
    rest[:, 1] -= rest[J["left_foot"], 1]
    marks = {f"{s}_{n}": mh.joint(shape, f"{s[0]}-{c}") for s in SIDES for n, c in CUBES.items()}
    mapped = _trunk_map(mh, shape, marks, rest, look)
    shape = mapped(shape)
    marks = {name: mapped(point) for name, point in marks.items()}
    joints, turns = rest.copy(), np.tile(np.eye(3), (22, 1, 1))
    goals = {name: rest[J[name]].copy() for name in marks}
    for side in SIDES:
        goals[f"{side}_hip"] = np.array([np.copysign(0.096, goals[f"{side}_knee"][0]), 0.892, -0.012])
        _place_arm(side, marks, goals, joints, turns)
    # Each limb is turned and stretched onto its goal; what hangs at its end goes along.
    moved = shape * (1 - sum(weights[:, J[name]] for name in marks))[:, None]
    for side in SIDES:
        limbs = _limb_turns(side, marks, goals)
        for name in CHAIN:
            joint = f"{side}_{name}"
            origin = marks[joint] * [1, 0, 1] if name == "foot" else marks[joint]
            moved += weights[:, [J[joint]]] * ((shape - origin) @ limbs[name].T + goals[joint])
    return moved, joints, turns


def _trunk_map(
    mh: MakeHuman, shape: np.ndarray, marks: Points, rest: np.ndarray, look: Look
) -> Callable[[np.ndarray], np.ndarray]:
    """Brings points (…, 3) to SMPL22's heights and depths piecewise, and to its widths by one scale."""
    neck, head = mh.joint(shape, "neck"), mh.joint(shape, "head")
    top = shape[mh.used("body"), 1].max()
    tall = 1.765 if look.sex == "male" else 1.735
    if look.age == "child":  # whose head is large against the bones
        tall = rest[J["head"], 1] + top - head[1]
    scale = 0.5 + 0.5 * tall / top
    at = [0.0, marks["left_hip"][1], marks["left_shoulder"][1], neck[1], head[1], top]
    to = [0.0, 0.892, rest[J["left_shoulder"], 1], rest[J["neck"], 1] + 0.008, rest[J["head"], 1], tall]
    deep = [marks["left_hip"][2], marks["left_hip"][2], marks["left_shoulder"][2], neck[2], head[2], head[2]]
    want = [-0.012, -0.012, rest[J["left_shoulder"], 2], -0.040, -0.012, -0.012]
    shift = np.array(want) - scale * np.array(deep)

    def mapped(points: np.ndarray) -> np.ndarray:
        y = points[..., 1]
        z = scale * points[..., 2] + np.interp(y, at, shift)
        return np.stack([scale * points[..., 0], np.interp(y, at, to), z], axis=-1)

    return mapped


def _place_arm(side: str, marks: Points, goals: Points, joints: np.ndarray, turns: np.ndarray) -> None:
    """Writes goals, joints and turns of an arm that points as in ``marks`` and is as long as SMPL22's."""
    goals[f"{side}_collar"] = marks[f"{side}_collar"]
    for upper, lower in (("shoulder", "elbow"), ("elbow", "wrist")):
        along = marks[f"{side}_{lower}"] - marks[f"{side}_{upper}"]
        length = SMPL22.bone_lengths[J[f"{side}_{lower}"]]
        goals[f"{side}_{lower}"] = goals[f"{side}_{upper}"] + along * length / np.linalg.norm(along)
        joints[J[f"{side}_{lower}"]] = goals[f"{side}_{lower}"]
    shoulder, elbow, wrist = (J[f"{side}_{n}"] for n in ("shoulder", "elbow", "wrist"))
    turns[shoulder] = swing(joints[elbow] - joints[shoulder], SMPL22.offsets[elbow])
    forearm = turns[shoulder] @ (joints[wrist] - joints[elbow])
    turns[elbow] = turns[wrist] = swing(forearm, SMPL22.offsets[wrist]) @ turns[shoulder]


def _limb_turns(side: str, marks: Points, goals: Points) -> Points:
    """(3, 3) for each joint of a side: turns and stretches the part behind it from ``marks`` to ``goals``."""
    limbs = {}
    for name, child in CHAIN.items():
        if child is None:
            continue
        old, new = (m[f"{side}_{child}"] - m[f"{side}_{name}"] for m in (marks, goals))
        if name == "ankle":  # the sole stays flat: only turned about the vertical
            yaw = np.arctan2(new[0], new[2]) - np.arctan2(old[0], old[2])
            c, n = np.cos(yaw), np.sin(yaw)
            long = np.hypot(new[0], new[2]) / np.hypot(old[0], old[2])
            high = goals[f"{side}_ankle"][1] / marks[f"{side}_ankle"][1]
            limbs[name] = np.array([[c, 0, n], [0, 1, 0], [-n, 0, c]]) @ np.diag([1, high, long])
            continue
        along = old / np.linalg.norm(old)
        stretch = np.linalg.norm(new) / np.linalg.norm(old) - 1
        rotation = swing(old, new)
        limbs[name] = rotation @ (np.eye(3) + stretch * np.outer(along, along))
        if name == "elbow":  # the hand turns with the forearm and keeps its size
            limbs["wrist"] = rotation
    limbs["foot"] = limbs["ankle"]
    return limbs


def swing(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """(3, 3) the smallest rotation of direction a onto direction b."""
    a, b = a / np.linalg.norm(a), b / np.linalg.norm(b)
    axis = np.cross(a, b)
    angle = np.arctan2(np.linalg.norm(axis), a @ b)
    return Rotation.from_rotvec(axis / max(np.linalg.norm(axis), 1e-12) * angle).as_matrix()
