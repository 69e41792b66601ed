"""Predicates on touches between two people, and of a person with their own body."""

from __future__ import annotations

import numpy as np

from .joints import SIDES, Array, Motion
from .stretches import Mask
from .vocabulary import predicate

BODY = {
    "shoulder": ("left_shoulder", "right_shoulder", "left_collar", "right_collar"),
    "back": ("spine1", "spine2", "spine3", "neck", "left_collar", "right_collar", "left_shoulder", "right_shoulder"),
    "trunk": (
        "pelvis",
        "spine1",
        "spine2",
        "spine3",
        "neck",
        "left_collar",
        "right_collar",
        "left_shoulder",
        "right_shoulder",
    ),
    "chest": ("spine2", "spine3", "left_collar", "right_collar"),
    "head": ("head", "neck"),
    "face": ("head",),
    "breast": ("spine3", "left_collar", "right_collar"),
    "hand": ("left_wrist", "right_wrist"),
    "arm": ("left_elbow", "right_elbow", "left_wrist", "right_wrist"),
    "elbow": ("left_elbow", "right_elbow"),
    "wrist": ("left_wrist", "right_wrist"),
    "hip": ("left_hip", "right_hip"),
    "waist": ("pelvis", "spine1", "left_hip", "right_hip"),
    "knee": ("left_knee", "right_knee"),
    "leg": ("left_hip", "right_hip", "left_knee", "right_knee", "left_ankle", "right_ankle"),
    "foot": ("left_foot", "right_foot", "left_ankle", "right_ankle"),
    "body": (
        "pelvis",
        "spine1",
        "spine2",
        "spine3",
        "neck",
        "head",
        "left_collar",
        "right_collar",
        "left_shoulder",
        "right_shoulder",
        "left_elbow",
        "right_elbow",
        "left_wrist",
        "right_wrist",
        "left_hip",
        "right_hip",
        "left_knee",
        "right_knee",
    ),
}
"""Joints by the words for a part of the body."""


# ---- touches ---------------------------------------------------------------------------------------------
HANDS = 0.12
"""Metres between wrists or between palms of two people whose hands meet."""
ON_JOINT = 0.2
"""Metres between a hand and the joint that it touches, which lies inside the body."""


def _hand_gaps(m: Motion) -> Array:
    """(2, 2, T) metres between each hand of a (left, right) and each of b: wrists or palms, what is less."""
    wrists = [m.pair(who, "wrist") for who in (0, 1)]
    gaps = [
        np.linalg.norm(mine[:, None] - theirs[None], axis=-1) for mine, theirs in (wrists, (m.palms[0], m.palms[1]))
    ]
    return np.minimum(*gaps)


@predicate
def hands_meet(m: Motion, a_side: str = "any", b_side: str = "any", gap: float = HANDS) -> Mask:
    """A hand of a and a hand of b meet; sides may be named."""
    rows = [SIDES.index(a_side)] if a_side in SIDES else [0, 1]
    columns = [SIDES.index(b_side)] if b_side in SIDES else [0, 1]
    return _hand_gaps(m)[np.ix_(rows, columns)].min(axis=(0, 1)) < gap


def elbow_gap(m: Motion) -> Array:
    """(T,) metres between the nearest elbows of the two."""
    mine, theirs = (m.pair(who, "elbow") for who in (0, 1))
    return np.asarray(np.linalg.norm(mine[:, None] - theirs[None], axis=-1).min(axis=(0, 1)))


@predicate
def elbows_meet(m: Motion, gap: float = 0.18) -> Mask:
    """An elbow of a and an elbow of b meet, whose joints are inside the arms."""
    return elbow_gap(m) < gap


@predicate
def both_hands_meet(m: Motion, gap: float = 0.15) -> Mask:
    """Each hand of a meets another hand of b."""
    gaps = _hand_gaps(m)
    straight, crossed = np.maximum(gaps[0, 0], gaps[1, 1]), np.maximum(gaps[0, 1], gaps[1, 0])
    return np.minimum(straight, crossed) < gap


def to_joints(m: Motion, points: Array, who: int, part: str) -> Array:
    """(P, T) least distance of points (P, T, 3) to a person's joints of a part."""
    joints = np.stack([m.joint(who, name) for name in BODY[part]])
    return np.linalg.norm(points[:, None] - joints[None], axis=-1).min(axis=1)


@predicate
def hand_on(m: Motion, who: int, part: str, side: str = "any", gap: float = ON_JOINT) -> Mask:
    """A hand (wrist or palm) is on a part of the other's body; "both": each hand is."""
    if side == "both":
        return hand_on(m, who, part, "left", gap) & hand_on(m, who, part, "right", gap)
    return to_joints(m, m.hands(who, side), 1 - who, part).min(axis=0) < gap


@predicate
def both_hands_on(m: Motion, who: int, part: str, gap: float = 0.22) -> Mask:
    """Both hands are on a part of the other's body."""
    return hand_on(m, who, part, "both", gap)


@predicate
def foot_on(m: Motion, who: int, part: str, gap: float = ON_JOINT) -> Mask:
    """A foot is on a part of the other's body."""
    return to_joints(m, m.pair(who, "foot"), 1 - who, part).min(axis=0) < gap


@predicate
def hand_to_own(m: Motion, who: int, part: str, side: str = "any", gap: float = ON_JOINT) -> Mask:
    """A hand is on a part of the person's own body; "both": each hand is."""
    if side == "both":
        return hand_to_own(m, who, part, "left", gap) & hand_to_own(m, who, part, "right", gap)
    return to_joints(m, m.hands(who, side), who, part).min(axis=0) < gap


@predicate
def hugs(m: Motion) -> Mask:
    """Chest near chest, and a hand of each on the other's trunk."""
    chests = np.linalg.norm(m.joint(0, "spine3") - m.joint(1, "spine3"), axis=-1)
    return (chests < 0.55) & hand_on(m, 0, "back", gap=0.25) & hand_on(m, 1, "back", gap=0.25)


@predicate
def arms_linked(m: Motion, gap: float = 0.2) -> Mask:
    """An elbow of one is at an elbow or a hand of the other, or their hands meet."""
    found = hands_meet(m)
    for who in (0, 1):
        found = found | (to_joints(m, m.pair(who, "elbow"), 1 - who, "arm").min(axis=0) < gap)
    return found


@predicate
def heads_near(m: Motion, metres: float = 0.4) -> Mask:
    """The heads are closer than ``metres``."""
    return np.linalg.norm(m.joint(0, "head") - m.joint(1, "head"), axis=-1) < metres


@predicate
def touches(m: Motion) -> Mask:
    """A hand of either one is on the other's body or hands."""
    return hands_meet(m) | hand_on(m, 0, "body", gap=0.15) | hand_on(m, 1, "body", gap=0.15)
