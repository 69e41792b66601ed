"""Poses of a body that stands, sits, kneels, crouches, bends down, lies or jumps, by the angles of its joints."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from motion import SMPL22
from motion.kinematics import forward_kinematics
from motion.limbs import bent_towards
from motion.smoothing import minimum_jerk
from motion.transforms import heading, heading_matrix

Array = NDArray[np.floating]

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
LOWER = tuple(
    SMPL22.index(name)
    for name in (
        "pelvis",
        "left_hip",
        "right_hip",
        "spine1",
        "left_knee",
        "right_knee",
        "left_ankle",
        "right_ankle",
        "left_foot",
        "right_foot",
    )
)
"""Joints of the pelvis and the legs: with these known, the arms and the head are free for other acts."""
ARMS = tuple(SMPL22.index(f"{side}_{name}") for side in ("left", "right") for name in ("shoulder", "elbow", "wrist"))
HANDS = tuple(SMPL22.index(f"{side}_{name}") for side in ("left", "right") for name in ("elbow", "wrist"))
"""Joints that move where the shoulders are held."""
FLAT = (
    *LOWER,
    *(
        SMPL22.index(name)
        for name in (
            "spine2",
            "spine3",
            "neck",
            "head",
            "left_collar",
            "right_collar",
            "left_shoulder",
            "right_shoulder",
        )
    ),
)
"""The same with the trunk, the head and the shoulders, for those who lie or bend down."""
TRUNK = tuple(joint for joint in FLAT if joint not in LOWER or joint == SMPL22.index("spine1"))
"""Joints of the trunk, the head and the shoulders."""
ALL = tuple(range(SMPL22.num_joints))
TOES = (SMPL22.index("left_foot"), SMPL22.index("right_foot"))
_UNALIKE = np.array([0.06, 0.1, 0.15])
"""Radians by which each arm of a person who stands hangs closer, further ahead and more bent, or less, than usual."""
_SIDES = {"left": 1.0, "right": -1.0}
"""Sides of the body, with the sign of their x for a person who faces +Z."""


def all_but(free: Collection[int]) -> list[int]:
    """All joints of a body but some."""
    return [joint for joint in ALL if joint not in free]


def standing(place: Array, angle: float, seconds: Array, *, seed: int = 0) -> Array:
    """A standing person with hanging arms who shifts their weight a little.

    Args:
        place: (2,) x and z of the pelvis in metres.
        angle: heading in radians from +Z towards +X.
        seconds: (N,) moments.
        seed: draws the phases of the sway, and how each arm hangs.

    Returns:
        (N, 22, 3) metres, the feet on the floor and at one place.
    """
    rng = np.random.default_rng(seed)
    phases, hangs = rng.uniform(0, 2 * np.pi, 4), _UNALIKE * rng.uniform(-1, 1, (2, 3))
    sway = [
        np.sin(2 * np.pi * np.asarray(seconds) / period + phase)
        for period, phase in zip((5.3, 3.9, 7.1, 4.4), phases, strict=True)
    ]
    turns = np.tile(np.eye(3), (len(seconds), SMPL22.num_joints, 1, 1))
    turns[:, 0] = heading_matrix(angle) @ about(2, 0.012 * sway[0])
    turns[:, SMPL22.index("spine2")] = about(2, -0.02 * sway[0]) @ heading_matrix(0.03 * sway[1])
    turns[:, SMPL22.index("neck")] = about(0, 0.05 + 0.02 * sway[1])
    turns[:, SMPL22.index("head")] = heading_matrix(0.1 * sway[2])
    sides = (("left", 1.0, sway[3], hangs[0]), ("right", -1.0, sway[1], hangs[1]))
    for side, sign, arm, (close, ahead, bent) in sides:
        turns[:, SMPL22.index(f"{side}_shoulder")] = about(2, -sign * (1.4 + close + 0.015 * arm)) @ about(
            0, 0.05 + ahead + 0.03 * arm
        )
        turns[:, SMPL22.index(f"{side}_elbow")] = heading_matrix(-sign * (0.3 + bent + 0.06 * arm))
        turns[:, SMPL22.index(f"{side}_hip")] = about(2, -sign * 0.02 - 0.012 * sway[0]) @ about(
            0, np.full(len(seconds), -0.06)
        )
        turns[:, SMPL22.index(f"{side}_knee")] = about(0, np.full(len(seconds), 0.12))
        turns[:, SMPL22.index(f"{side}_ankle")] = about(0, np.full(len(seconds), -0.06))
    poses = forward_kinematics(turns, np.zeros((len(seconds), 3)))
    return _on_floor(poses, place, angle)


_SITS: Mapping[str, float] = {"hip": -1.45, "knee": 1.5, "ankle": -0.05, "shoulder": 1.2, "elbow": 0.6, "spine": 0.08}
_CROUCHES: Mapping[str, float] = {"hip": -1.75, "knee": 2.2, "ankle": -0.5, "shoulder": 1.2, "elbow": 0.5, "spine": 0.2}
_BENDS: Mapping[str, float] = {"hip": -0.6, "knee": 0.95, "ankle": -0.38, "shoulder": 1.2, "elbow": 0.3, "spine": 0.1}
_STOOPS: Mapping[str, float] = {"hip": -0.7, "knee": 0.9, "ankle": -0.2, "shoulder": 1.4, "elbow": 0.3, "spine": 0.05}
_LIES: Mapping[str, float] = {"hip": -0.12, "knee": 0.25, "ankle": 0.4, "shoulder": 0.9, "elbow": 0.2, "spine": 0.0}
_BELLY, _ELBOW_LIES = (-0.03, 0.14, -0.19), (-1.0, -0.6, 0.2)
"""Metres from the pelvis of a person on the back, the feet towards +Z, to a wrist on the belly, and its elbow's way."""
_SITS_UP: Mapping[str, float] = {"hip": -2.4, "knee": 1.9, "ankle": 0.1, "shoulder": 1.2, "elbow": 0.3, "spine": 0.15}
_STOOPED = 1.6
"""Radians by which the trunk of a person leans who bends down to the floor."""
_BENT = 0.9
"""Radians of a bend from the hips."""
STANDS: Mapping[str, float] = {"hip": -0.06, "knee": 0.12, "ankle": -0.06, "shoulder": 1.4, "elbow": 0.3, "spine": 0.0}
BOW_BEGINS = 0.25
"""Seconds of a beat before a bow, and after it."""
BOW_TAKES = (1.2, 2.0)
"""Seconds of a bow, at least and at most."""
_BOW_DOWN, _BOW_UP = 0.42, 0.52
"""Shares of a bow at which somebody is down, and from which they rise."""
_WITH_TRUNK = {"left": 0.3, "right": 0.4}
"""How far arms turn with a trunk that bows."""
_FLIES: Mapping[str, float] = {"hip": -0.2, "knee": 0.4, "ankle": 0.45, "shoulder": 1.3, "elbow": 0.3, "spine": 0.0}


def upright(place: Array, angle: float) -> Array:
    """A person standing still: (22, 3) metres."""
    return _on_floor(_posed(angle, STANDS)[None], place, angle)[0]


def seated(place: Array, angle: float) -> Array:
    """A person sitting as on a chair, the feet where they stood: (22, 3) metres."""
    return _on_floor(_posed(angle, _SITS)[None], place, angle)[0]


def grounded(place: Array, angle: float) -> Array:
    """A person sitting on the ground, the feet where they stood: (22, 3) metres."""
    pose = _posed(angle, {"hip": -1.8, "knee": 0.35, "ankle": 0.0, "shoulder": 1.3, "elbow": 0.3, "spine": 0.1})
    pose[:, 1] += 0.08 - pose[:, 1].min()
    ahead = STANCE * np.array([np.sin(angle), 0.0, np.cos(angle)])
    return pose + (np.array([place[0], 0.0, place[1]]) + ahead - pose[list(TOES)].mean(axis=0)) * [1, 0, 1]


def bending(place: Array, angle: float, lean: float = _BENT) -> Array:
    """A person bent from the hips by so many radians: (22, 3) metres."""
    return leaning(upright(place, angle), angle, lean)


def leaning(pose: Array, angle: float, lean: float) -> Array:
    """A pose (22, 3) with its trunk, head and arms turned forward about the pelvis by so many radians."""
    upper = [j for j in range(SMPL22.num_joints) if j not in LOWER or j == SMPL22.index("spine1")]
    turn = heading_matrix(angle) @ about(0, lean) @ heading_matrix(-angle)
    moved = pose.copy()
    moved[upper] = pose[0] + (pose[upper] - pose[0]) @ turn.T
    return moved


def stooping(place: Array, angle: float, share: float = 1.0) -> Array:
    """A person bent down on soft knees, or by a share of that, whose arms hang to the floor: (22, 3) metres."""
    bent = {name: (1 - share) * up + share * _STOOPS[name] for name, up in STANDS.items()}
    pose = leaning(_on_floor(_posed(angle, bent)[None], place, angle)[0], angle, share * _STOOPED)
    for side in _SIDES:
        shoulder, elbow, wrist = (SMPL22.index(f"{side}_{name}") for name in ("shoulder", "elbow", "wrist"))
        for joint, parent in ((elbow, shoulder), (wrist, elbow)):
            pose[joint] = pose[parent] - [0.0, float(SMPL22.bone_lengths[joint]), 0.0]
    return pose


def crouching(place: Array, angle: float) -> Array:
    """A person crouching on their feet: (22, 3) metres."""
    return _on_floor(_posed(angle, _CROUCHES)[None], place, angle)[0]


def kneeling(place: Array, angle: float) -> Array:
    """Somebody on the right knee, the left foot in front: (22, 3) metres."""
    pose = _posed(
        angle,
        {"hip": -1.75, "knee": 1.8, "ankle": -0.05, "shoulder": 1.3, "elbow": 0.4, "spine": 0.03},
        {"hip": 0.1, "knee": 1.4, "ankle": 0.9, "shoulder": 1.3, "elbow": 0.4, "spine": 0.03},
    )
    pose[:, 1] += SOLE + 0.04 - pose[:, 1].min()
    return pose + np.array([place[0], 0.0, place[1]])


def lying(place: Array, angle: float) -> Array:
    """A person lying on the back, the feet about where they stood: (22, 3) metres."""
    pose = _posed(0.0, _LIES)
    pose = (pose - pose[0]) @ (heading_matrix(angle) @ about(0, -np.pi / 2)).T
    pose[:, 1] += 0.08 - pose[:, 1].min()
    return pose + np.array([place[0], 0.0, place[1]]) - LYING * np.array([np.sin(angle), 0.0, np.cos(angle)])


def at_rest(poses: Array) -> Array:
    """Poses (N, 22, 3) of a person lying on the back, with the right hand on the belly."""
    found = np.array(poses)
    arm = [SMPL22.index(f"right_{joint}") for joint in ("shoulder", "elbow", "wrist")]
    turns = np.swapaxes(heading_matrix(heading(found)), -1, -2)
    goal, pole = (np.asarray(way) @ turns for way in (_BELLY, _ELBOW_LIES))
    shoulder, elbow, wrist = (found[:, joint] for joint in arm)
    found[:, arm[1]], found[:, arm[2]] = bent_towards(shoulder, elbow, wrist, found[:, 0] + goal, pole)
    return found


def _reclining(place: Array, angle: float, share: float) -> Array:
    """A person between sitting with the feet under them and lying on the back, by a share from 0 to 1."""
    ends = _on_floor(_posed(angle, _SITS_UP)[None], place, angle)[0], lying(place, angle)
    pose = _posed(0.0, {name: (1 - share) * up + share * _LIES[name] for name, up in _SITS_UP.items()})
    pose = (pose - pose[0]) @ (heading_matrix(angle) @ about(0, -share * np.pi / 2)).T
    lowest = [float(end[:, 1].min()) for end in ends]
    pose[:, 1] += (1 - share) * lowest[0] + share * lowest[1] - pose[:, 1].min()
    return pose + ((1 - share) * ends[0][0] + share * ends[1][0]) * [1, 0, 1]


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


def leaping(place: Array, angle: float, rise: float = 0.22) -> Sequence[tuple[float, Array]]:
    """A jump on the spot as poses (22, 3) in metres, with their seconds from its highest moment.

    It is in the air as long as a body in free fall.

    Args:
        place: (2,) x and z of the pelvis in metres.
        angle: heading in radians from +Z towards +X.
        rise: metres by which the feet leave the floor.
    """
    up = (2 * rise / 9.81) ** 0.5
    bent = _on_floor(_posed(angle, _BENDS)[None], place, angle)[0]
    high = _on_floor(_posed(angle, _FLIES)[None], place, angle)[0] + np.array([0.0, rise, 0.0])
    return ((-up - 0.23, bent), (0.0, high), (up + 0.2, bent), (up + 0.6, upright(place, angle)))


def bowing(place: Array, angle: float, lean: float = _BENT) -> Sequence[tuple[float, Array]]:
    """A bow on the spot as poses (22, 3) in metres, with their seconds from its lowest moment."""
    low, up = bending(place, angle, lean), upright(place, angle)
    return ((-0.7, up), (-0.15, low), (0.15, low), (0.85, up))


def bowed(poses: Array, angle: float, seconds: Array, length: float, times: int = 1, lean: float = _BENT) -> Array:
    """Standing poses (N, 22, 3) of a person who bows so many times, the arms hanging.

    Trunk and head bend down and rise along minimum-jerk courses, slowly where there is time. The arms follow them
    by a share, so that the hands slide along the thighs, one a little behind the other.

    Args:
        poses: of the person who stands.
        angle: heading in radians.
        seconds: (N,) moments of the beat.
        length: seconds of the beat.
        times: bows.
        lean: radians of a bow.
    """
    each = float(np.clip((length - 2 * BOW_BEGINS) / times, *BOW_TAKES))
    since = np.asarray(seconds, dtype=float) - BOW_BEGINS
    phase = np.where((since >= 0) & (since < times * each), since % each, 0.0) / each
    down, up = minimum_jerk(phase / _BOW_DOWN), minimum_jerk((phase - _BOW_UP) / (1 - _BOW_UP))
    found = []
    for pose, bent in zip(np.asarray(poses, dtype=float), lean * (down - up), strict=True):
        made = leaning(pose, angle, float(bent))
        for side, share in _WITH_TRUNK.items():
            shoulder, *arm = (SMPL22.index(f"{side}_{name}") for name in ("shoulder", "elbow", "wrist"))
            turn = heading_matrix(angle) @ about(0, share * float(bent)) @ heading_matrix(-angle)
            made[arm] = made[shoulder] + (pose[arm] - pose[shoulder]) @ turn.T
        found.append(made)
    return np.stack(found)


def _posed(angle: float, left: Mapping[str, float], right: Mapping[str, float] | None = None) -> Array:
    """A pose (22, 3) around the origin by angles in radians: flexed hips are negative, flexed knees positive."""
    turns = np.tile(np.eye(3), (1, SMPL22.num_joints, 1, 1))
    turns[:, 0] = heading_matrix(angle)
    for spine in ("spine1", "spine2"):
        turns[:, SMPL22.index(spine)] = about(0, left["spine"])
    for (side, sign), angles in zip(_SIDES.items(), (left, right or left), strict=True):
        turns[:, SMPL22.index(f"{side}_shoulder")] = about(2, -sign * angles["shoulder"])
        turns[:, SMPL22.index(f"{side}_elbow")] = heading_matrix(-sign * angles["elbow"])
        turns[:, SMPL22.index(f"{side}_hip")] = about(2, -sign * 0.02) @ about(0, angles["hip"])
        for joint in ("knee", "ankle"):
            turns[:, SMPL22.index(f"{side}_{joint}")] = about(0, angles[joint])
    return forward_kinematics(turns, np.zeros((1, 3)))[0]


def _on_floor(poses: Array, place: Array, angle: float) -> Array:
    """The poses (N, 22, 3) with their toes on the floor, where those of one who stands at ``place`` are."""
    soles = poses[:, TOES]
    moved = poses - soles.mean(axis=1, keepdims=True) * [1, 0, 1]
    moved[..., 1] += SOLE - soles[..., 1].mean(axis=1)[:, None]
    return moved + np.array([place[0], 0.0, place[1]]) + STANCE * np.array([np.sin(angle), 0.0, np.cos(angle)])


def about(axis: int, angle: Array | float) -> Array:
    """(…, 3, 3) rotations about X (0) or Z (2)."""
    angle = np.asarray(angle, dtype=np.float64)
    cos, sin, one, zero = np.cos(angle), np.sin(angle), np.ones_like(angle), np.zeros_like(angle)
    rows = (
        [one, zero, zero, zero, cos, -sin, zero, sin, cos]
        if axis == 0
        else [cos, -sin, zero, sin, cos, zero, zero, zero, one]
    )
    return np.stack(rows, axis=-1).reshape(*angle.shape, 3, 3)
