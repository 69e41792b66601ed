"""Poses of a body that stands, sits, kneels, crouches, bends down or lies, by the angles of its joints."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from functools import cache

import numpy as np

from motion import SMPL22
from motion.kinematics import forward_kinematics
from motion.limbs import bent_towards
from motion.skeleton import TOES
from motion.transforms import heading_matrix
from motion.vectors import FLAT, Array, direction, floor_points, rotations_by

Turns = dict[str, Array]
"""Rotations (3, 3) or (N, 3, 3) of joints by name."""
Pose = tuple[int, Array]
"""A frame of the scene and a pose (22, 3) in metres of its world."""

UPRIGHT = 0.8
"""Height in metres of the pelvis above which a person is on their feet."""
STANCE = 0.12
"""Metres by which a standing person's toes are ahead of the place where they stand."""
SOLE = 0.02
"""Height in metres of the toe joint of a foot that stands."""
LYING = 0.6
"""Metres from where somebody stood to the pelvis when they lie."""
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


_SITS: Mapping[str, float] = {"hip": -1.45, "knee": 1.5, "ankle": -0.05, "shoulder": 1.2, "elbow": 0.6, "spine": 0.08}
_CROUCHES: Mapping[str, float] = {"hip": -1.75, "knee": 2.2, "ankle": -0.5, "shoulder": 1.2, "elbow": 0.5, "spine": 0.2}
_STOOPS: Mapping[str, float] = {"hip": -0.7, "knee": 0.9, "ankle": -0.2, "shoulder": 1.4, "elbow": 0.3, "spine": 0.05}
_LIES: Mapping[str, float] = {"hip": -0.12, "knee": 0.25, "ankle": 0.4, "shoulder": 0.9, "elbow": 0.2, "spine": 0.0}
_BELLY, _ELBOW_LIES = (-0.03, 0.14, -0.19), (-1.0, -0.6, 0.2)
"""Metres from the pelvis of a person on the back, the feet towards +Z, to a wrist on the belly, and its elbow's way."""
_SITS_UP: Mapping[str, float] = {"hip": -2.4, "knee": 1.9, "ankle": 0.1, "shoulder": 1.2, "elbow": 0.3, "spine": 0.15}
_STOOPED = 1.6
"""Radians by which the trunk of a person leans who bends down to the floor."""
STANDS: Mapping[str, float] = {"hip": -0.06, "knee": 0.12, "ankle": -0.06, "shoulder": 1.4, "elbow": 0.3, "spine": 0.0}


def placed(poses: Array, places: Array, headings: Array | float) -> Array:
    """Poses (…, 22, 3) around the origin that face +Z, at places (…, 2) with headings (…)."""
    turned = poses @ np.swapaxes(heading_matrix(headings), -1, -2)
    return np.asarray(turned + floor_points(np.asarray(places, dtype=float))[..., None, :])


@cache
def _standing() -> Array:
    return _on_floor(_pose_of(0.0, STANDS)[None], np.zeros(2), 0.0)[0]


def upright(places: Array, headings: Array | float) -> Array:
    """People standing still at places (…, 2) with headings (…): (…, 22, 3) metres."""
    return placed(_standing(), places, headings)


def seated(place: Array, angle: float) -> Array:
    """A person sitting as on a chair, the feet where they stood: (22, 3) metres."""
    return _on_floor(_pose_of(angle, _SITS)[None], place, angle)[0]


def grounded(place: Array, angle: float) -> Array:
    """A person sitting on the ground, the feet where they stood: (22, 3) metres."""
    pose = _pose_of(angle, {"hip": -1.8, "knee": 0.35, "ankle": 0.0, "shoulder": 1.3, "elbow": 0.3, "spine": 0.1})
    pose[:, 1] += 0.08 - pose[:, 1].min()
    return pose + ahead_of(place, angle, STANCE) - pose[TOES].mean(axis=0) * FLAT


def bending(places: Array, headings: Array | float, lean: float) -> Array:
    """People (…, 22, 3) in metres who stand as :func:`upright` says, bent from the hips by so many radians."""
    return leaning(upright(places, headings), headings, lean)


def leaning(poses: Array, angle: Array | float, lean: Array | float) -> Array:
    """Poses (…, 22, 3) with trunk, head and arms turned forward about the pelvis by so many radians (…)."""
    upper = [j for j in ALL if j not in LOWER or j == JOINT["spine1"]]
    moved, root = poses.copy(), poses[..., :1, :]
    moved[..., upper, :] = root + (poses[..., upper, :] - root) @ _tilt(angle, lean)
    return moved


def _tilt(angle: Array | float, lean: Array | float) -> Array:
    """(…, 3, 3) what points (N, 3) are multiplied by to turn forward, for a heading, by so many radians (…)."""
    turn = heading_matrix(angle)
    return np.swapaxes(turn @ about(0, lean) @ np.swapaxes(turn, -1, -2), -1, -2)


def stooping(place: Array, angle: float, share: float = 1.0) -> Array:
    """A person bent down on soft knees, or by a share of that, whose arms hang to the floor: (22, 3) metres."""
    bent = {name: (1 - share) * up + share * _STOOPS[name] for name, up in STANDS.items()}
    pose = leaning(_on_floor(_pose_of(angle, bent)[None], place, angle)[0], angle, share * _STOOPED)
    for side, _ in BOTH_SIDES:
        shoulder, elbow, wrist = (JOINT[f"{side}_{name}"] for name in ("shoulder", "elbow", "wrist"))
        for joint, parent in ((elbow, shoulder), (wrist, elbow)):
            pose[joint] = pose[parent] - [0.0, float(SMPL22.bone_lengths[joint]), 0.0]
    return pose


def crouching(place: Array, angle: float) -> Array:
    """A person crouching on their feet: (22, 3) metres."""
    return _on_floor(_pose_of(angle, _CROUCHES)[None], place, angle)[0]


def kneeling(place: Array, angle: float) -> Array:
    """Somebody on the right knee, the left foot in front: (22, 3) metres."""
    pose = _pose_of(
        angle,
        {"hip": -1.75, "knee": 1.8, "ankle": -0.05, "shoulder": 1.3, "elbow": 0.4, "spine": 0.03},
        {"hip": 0.1, "knee": 1.4, "ankle": 0.9, "shoulder": 1.3, "elbow": 0.4, "spine": 0.03},
    )
    pose[:, 1] += SOLE + 0.04 - pose[:, 1].min()
    return pose + floor_points(place)


def lying(place: Array, angle: float) -> Array:
    """A person lying on the back, the feet about where they stood and a hand on the belly: (22, 3) metres."""
    pose = _pose_of(0.0, _LIES)
    pose = (pose - pose[0]) @ (heading_matrix(angle) @ about(0, -np.pi / 2)).T
    pose[:, 1] += 0.08 - pose[:, 1].min()
    shoulder, elbow, wrist = (JOINT[f"right_{joint}"] for joint in ("shoulder", "elbow", "wrist"))
    goal, pole = (np.asarray(way) @ heading_matrix(angle).T for way in (_BELLY, _ELBOW_LIES))
    pose[elbow], pose[wrist] = bent_towards(pose[shoulder], pose[elbow], pose[wrist], pose[0] + goal, pole)
    return pose + ahead_of(place, angle, -LYING)


def _reclining(place: Array, angle: float, share: float) -> Array:
    """A person between sitting with the feet under them and lying on the back, by a share from 0 to 1."""
    ends = _on_floor(_pose_of(angle, _SITS_UP)[None], place, angle)[0], lying(place, angle)
    pose = _pose_of(0.0, {name: (1 - share) * up + share * _LIES[name] for name, up in _SITS_UP.items()})
    pose = (pose - pose[0]) @ (heading_matrix(angle) @ about(0, -share * np.pi / 2)).T
    lowest = [float(end[:, 1].min()) for end in ends]
    pose[:, 1] += (1 - share) * lowest[0] + share * lowest[1] - pose[:, 1].min()
    return pose + ((1 - share) * ends[0][0] + share * ends[1][0]) * FLAT


def rising(place: Array, angle: float, *, lies: bool) -> Sequence[tuple[float, Array]]:
    """Getting up from the ground, as poses (22, 3) in metres and shares of the time that it takes.

    They sit up, get their feet under them, and stand where :func:`lying` and :func:`grounded` have their feet.

    Args:
        place: (2,) x and z in metres where they stand afterwards.
        angle: heading in radians.
        lies: they lie on the back before, and do not sit.
    """
    if not lies:
        return ((0.6, crouching(place, angle)),)
    up = [(0.45 * share, _reclining(place, angle, 1 - share)) for share in (0.25, 0.5, 0.75, 1.0)]
    return (*up, (0.75, crouching(place, angle)))


def _pose_of(angle: float, left: Mapping[str, float], right: Mapping[str, float] | None = None) -> Array:
    """A pose (22, 3) around the origin by angles in radians, as :func:`turns_of` takes them."""
    return poses_of(turns_of(angle, left, right))[0]


def turns_of(angle: float, left: Mapping[str, float], right: Mapping[str, float] | None = None) -> Turns:
    """The rotations of joints by angles in radians: flexed hips are negative, flexed knees positive."""
    turns: Turns = {"pelvis": heading_matrix(angle)} | dict.fromkeys(("spine1", "spine2"), about(0, left["spine"]))
    for (side, sign), angles in zip(BOTH_SIDES, (left, right or left), strict=True):
        turns[f"{side}_shoulder"] = about(2, -sign * angles["shoulder"])
        turns[f"{side}_elbow"] = heading_matrix(-sign * angles["elbow"])
        turns[f"{side}_hip"] = about(2, -sign * 0.02) @ about(0, angles["hip"])
        turns |= {f"{side}_{joint}": about(0, angles[joint]) for joint in ("knee", "ankle")}
    return turns


def poses_of(turns: Turns, count: int = 1) -> Array:
    """Poses (N, 22, 3) from the pelvis, by the rotations of joints; the others are in T-pose."""
    rotations = np.tile(np.eye(3), (count, len(JOINT), 1, 1))
    for joint, turn in turns.items():
        rotations[:, JOINT[joint]] = turn
    return forward_kinematics(rotations, np.zeros((count, 3)))


def _on_floor(poses: Array, place: Array, angle: float) -> Array:
    """The poses (N, 22, 3) with their toes on the floor, where those of one who stands at ``place`` are."""
    soles = poses[:, TOES]
    moved = poses - soles.mean(axis=1, keepdims=True) * FLAT
    moved[..., 1] += SOLE - soles[..., 1].mean(axis=1)[:, None]
    return moved + ahead_of(place, angle, STANCE)


def ahead_of(place: Array, angle: float, metres: float) -> Array:
    """The point (3,) on the floor so many metres ahead of a person at a place (2,) with a heading."""
    return floor_points(place + metres * direction(angle))


def about(axis: int, angle: Array | float) -> Array:
    """(…, 3, 3) rotations about X (0), Y (1) or Z (2) by radians (…)."""
    return rotations_by(np.asarray(angle, dtype=np.float64)[..., None] * np.eye(3)[axis])
