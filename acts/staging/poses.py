"""Poses of a body by the angles of its joints, and those of them that have a name in ``figures.toml``."""

from __future__ import annotations

import tomllib
from collections.abc import Collection, Mapping
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from motion import SMPL22
from motion.kinematics import forward_kinematics
from motion.skeleton import HEAD_TOP, SIDES, TOES
from motion.transforms import heading_matrix
from motion.vectors import FLAT, Array, floor_points, rotations_by

Pose = tuple[int, Array]
"""A frame of the scene and a pose (22, 3) in metres of its world."""

UPRIGHT = 0.8
"""Height in metres of the pelvis above which a person is on their feet."""
STANCE = 0.12
"""Metres by which a standing person's toes are ahead of the place where they stand."""
JOINT: Mapping[str, int] = {name: i for i, name in enumerate(SMPL22.joint_names)}
"""Indices of the joints."""
ALL = tuple(JOINT.values())
LOWER = tuple(i for name, i in JOINT.items() if name.endswith(("pelvis", "hip", "spine1", "knee", "ankle", "foot")))
"""Joints of the pelvis and the legs: with these known, the arms and the head are free for other acts."""
HANDS = tuple(i for name, i in JOINT.items() if name.endswith(("elbow", "wrist")))
"""Joints that move where the shoulders are held."""
ELBOWS, WRISTS = HANDS[:2], HANDS[2:]
TRUNK = (JOINT["spine1"], *(joint for joint in ALL if joint not in (*LOWER, *HANDS)))
"""Joints of the trunk, the head and the shoulders."""
BOTH_SIDES = (("left", 1.0), ("right", -1.0))
"""Sides of the body, with the sign of their x for a person who faces +Z."""


def all_but(free: Collection[int]) -> list[int]:
    """All joints of a body but some."""
    return [joint for joint in ALL if joint not in free]


# ---- angles ------------------------------------------------------------------------------------------
SINGLE = ("pitch", "roll", "yaw", "spine", "lean", "twist", "neck", "tilt", "look")
"""Degrees by which the pelvis is pitched forward, rolled to the left and turned to the left, by which the trunk is bent
forward, leant to the left and twisted to the left, and by which the head is bent, tilted and turned likewise."""
METRES = ("rise", "ahead", "aside")
"""Metres of the lowest joint over the floor, and of the body ahead and to the left of where it would be."""
PAIRED = ("hip", "out", "turnout", "knee", "ankle", "shrug", "arm", "side", "rotate", "elbow", "free")
"""Degrees by which a thigh is turned out, raised and spread, a knee bent, toes pointed, a shoulder shrugged, an arm
raised forward, spread and turned in, an elbow bent; "free" is 1 for a leg that does not carry the body, as it swings
past the floor. A number for both sides, or [left, right]."""
NAMES = (*SINGLE, *METRES, *(f"{side}_{name}" for side in SIDES for name in PAIRED))
FILE: dict[str, Any] = tomllib.loads(Path(__file__).with_name("figures.toml").read_text(encoding="utf-8"))
CLEARANCES = np.array([FILE["skin"][name.split("_")[-1]] for name in JOINT])
"""Metres from each joint to the skin below it, on which a body lies or stands."""
_NAMED: dict[str, dict[str, Any]] = FILE["postures"] | FILE["poses"]


def angles_of(row: Mapping[str, Any]) -> Array:
    """The angles (len(NAMES),) in radians, and metres, of a row: those of its pose, with what it says beside."""
    beside = {name: value for name, value in row.items() if name not in ("in", "pose")}
    said = _NAMED["stands"] | _NAMED[row.get("pose", "stands")] | beside
    angles = np.zeros(len(NAMES))
    for name, value in said.items():
        if name in METRES:
            angles[NAMES.index(name)] = value
        elif name in SINGLE:
            angles[NAMES.index(name)] = np.deg2rad(value)
        else:
            for side, own in zip(SIDES, np.broadcast_to(value, 2), strict=True):
                angles[NAMES.index(f"{side}_{name}")] = own if name == "free" else np.deg2rad(own)
    return angles


def bodies(angles: Array, angle: float) -> Array:
    """Poses (N, 22, 3) from the pelvis, of people with a heading, by the angles (N, len(NAMES)) of their joints."""
    of = dict(zip(NAMES, angles.T, strict=True))
    trunk = about(2, -of["lean"] / 3) @ about(0, of["spine"] / 3) @ heading_matrix(of["twist"] / 3)
    head = about(2, -of["tilt"] / 2) @ about(0, of["neck"] / 2) @ heading_matrix(of["look"] / 2)
    pelvis = heading_matrix(angle) @ heading_matrix(of["yaw"]) @ about(2, -of["roll"]) @ about(0, of["pitch"])
    turns: dict[str, Array] = {"pelvis": pelvis}
    turns |= dict.fromkeys(("spine1", "spine2", "spine3"), trunk) | dict.fromkeys(("neck", "head"), head)
    for side, sign in BOTH_SIDES:
        own = {name: of[f"{side}_{name}"] for name in PAIRED}
        spread, turned = about(2, sign * own["out"]), heading_matrix(sign * own["turnout"])
        hangs = about(2, -sign * (np.pi / 2 - own["side"]))
        turns[f"{side}_hip"] = turned @ about(0, -own["hip"]) @ spread
        turns[f"{side}_knee"] = about(0, own["knee"])
        turns[f"{side}_ankle"] = about(0, own["ankle"])
        turns[f"{side}_collar"] = about(2, sign * own["shrug"])
        turns[f"{side}_shoulder"] = about(0, -own["arm"]) @ hangs @ about(0, own["rotate"])
        turns[f"{side}_elbow"] = heading_matrix(-sign * own["elbow"])
    rotations = np.tile(np.eye(3), (len(angles), len(JOINT), 1, 1))
    for joint, turn in turns.items():
        rotations[:, JOINT[joint]] = turn
    return forward_kinematics(rotations, np.zeros((len(angles), 3)))


def gaps(poses: Array) -> Array:
    """(N, 23) metres of the skin at each joint of poses, and of the top of the head, over a floor at 0."""
    neck, head = (poses[:, JOINT[name]] for name in ("neck", "head"))
    up = (head - neck)[:, 1] / np.linalg.norm(head - neck, axis=1).clip(min=1e-6)
    crown = head[:, 1] + HEAD_TOP * up
    return np.concatenate([poses[..., 1] - CLEARANCES, crown[:, None]], axis=1)


def about(axis: int, angle: Array | float) -> Array:
    """(…, 3, 3) rotations about X (0), Y (1) or Z (2) by radians (…)."""
    return rotations_by(np.asarray(angle, dtype=np.float64)[..., None] * np.eye(3)[axis])


# ---- named poses -------------------------------------------------------------------------------------


def placed(poses: Array, places: Array, headings: Array | float) -> Array:
    """Poses (…, 22, 3) around the origin that face +Z, at places (…, 2) with headings (…)."""
    turned = poses @ np.swapaxes(heading_matrix(headings), -1, -2)
    return np.asarray(turned + floor_points(np.asarray(places, dtype=float))[..., None, :])


@cache
def _posed(name: str) -> Array:
    angles = angles_of({"pose": name})
    pose = bodies(angles[None], 0.0)
    rise, ahead = (float(angles[NAMES.index(each)]) for each in ("rise", "ahead"))
    shift = [0.0, rise - float(gaps(pose).min()), STANCE + ahead] - pose[0, TOES].mean(axis=0) * FLAT
    return np.asarray(pose[0] + shift)


def posed(name: str, places: Array, headings: Array | float) -> Array:
    """People in a pose of ``figures.toml``, on the floor, who stood at places (…, 2) with headings (…).

    Returns:
        (…, 22, 3) metres, with the toes where they were, or as far ahead of there as the pose says.
    """
    return placed(_posed(name), places, headings)


def upright(places: Array, headings: Array | float) -> Array:
    """People standing still at places (…, 2) with headings (…): (…, 22, 3) metres."""
    return posed("stands", places, headings)


def bending(places: Array, headings: Array | float, lean: float) -> Array:
    """People (…, 22, 3) in metres who stand as :func:`upright` says, bent from the hips by so many radians."""
    return leaning(upright(places, headings), headings, lean)


def leaning(poses: Array, angle: Array | float, lean: Array | float) -> Array:
    """Poses (…, 22, 3) with trunk, head and arms turned forward about the pelvis by so many radians (…)."""
    upper = [j for j in ALL if j not in LOWER or j == JOINT["spine1"]]
    moved, root, turn = poses.copy(), poses[..., :1, :], heading_matrix(angle)
    tilt = np.swapaxes(turn @ about(0, lean) @ np.swapaxes(turn, -1, -2), -1, -2)
    moved[..., upper, :] = root + (poses[..., upper, :] - root) @ tilt
    return moved
