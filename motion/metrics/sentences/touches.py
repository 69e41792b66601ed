"""Predicates on two bodies: touches, of a person's own body too, places beside each other, and unison."""

from __future__ import annotations

import tomllib
from pathlib import Path

import numpy as np
import scipy  # its parts are loaded with their first use

from motion.skeleton import SIDES

from .joints import Array, Mask, Motion, keep, predicate
from .paths import beside

_TABLES = tomllib.loads(Path(__file__).with_name("body.toml").read_text(encoding="utf-8"))
BODY = {
    part: tuple(dict.fromkeys(name.replace("*", side) for name in names.split() for side in SIDES))
    for part, names in _TABLES["joints"].items()
}
"""Joints by the words for a part of the body."""
NEARBY = 0.5
"""Metres, at least, as which the distance of a hand counts that is elsewhere on the body."""


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


@predicate
def elbows_meet(m: Motion, gap: float = 0.18) -> Mask:
    """An elbow of a and an elbow of b meet, whose joints are inside the arms."""
    mine, theirs = (m.pair(who, "elbow") for who in (0, 1))
    return np.linalg.norm(mine[:, None] - theirs[None], axis=-1).min(axis=(0, 1)) < gap


@predicate
def hips_meet(m: Motion, gap: float = 0.26) -> Mask:
    """A hip of a and a hip of b meet, whose joints are inside the bodies, of two who stand side by side."""
    mine, theirs = (m.pair(who, "hip") for who in (0, 1))
    return (np.linalg.norm(mine[:, None] - theirs[None], axis=-1).min(axis=(0, 1)) < gap) & beside(m)


@predicate
def both_hands_meet(m: Motion, gap: float = 0.15) -> Mask:
    """Each hand of a meets another hand of b."""
    gaps = _hand_gaps(m)
    straight, crossed = np.maximum(gaps[0, 0], gaps[1, 1]), np.maximum(gaps[0, 1], gaps[1, 0])
    return np.minimum(straight, crossed) < gap


def has_sides(part: str) -> bool:
    """True for a part of the body with joints on either side, such as an arm, unlike the face."""
    return any(joint.startswith(SIDES) for joint in BODY.get(part, ()))


def to_joints(m: Motion, points: Array, who: int, part: str) -> Array:
    """(P, T) least distance of points (P, T, 3) to a person's joints of a part, such as "arm" or "left arm".

    A point that is not where the part is on the body, such as one behind the face, counts as :data:`NEARBY` from it.
    """
    side, _, name = part.rpartition(" ")
    sided = [joint for joint in BODY[name] if side and joint.startswith(side)]
    joints = np.stack([m.joint(who, joint) for joint in sided or BODY[name]])
    gaps = np.linalg.norm(points[:, None] - joints[None], axis=-1).min(axis=1)
    there = m.of_trunk(who, points - np.mean([m.joint(who, joint) for joint in BODY[name]], axis=0))
    left, up, ahead = np.moveaxis(there, -1, 0)
    along = {"aside": np.abs(left), "up": up, "down": -up, "ahead": ahead, "behind": -ahead}
    for axis, least in _TABLES["where"].get(name, {}).items():
        gaps = np.where(along[axis] < least, np.maximum(gaps, NEARBY), gaps)
    return gaps


@predicate
def hand_on(m: Motion, who: int, part: str, side: str = "any", gap: float = ON_JOINT, whose: int | None = None) -> Mask:
    """A hand (wrist or palm) is on the other's ``part``; "both": each hand is.

    On "left foot" it is within ``gap`` metres and nearer to the left one than to the right one. With ``whose`` it is on
    that person's body.
    """
    if side == "both":
        return hand_on(m, who, part, "left", gap, whose) & hand_on(m, who, part, "right", gap, whose)
    hands, whose = m.hands(who, side), 1 - who if whose is None else whose
    gaps = to_joints(m, hands, whose, part)
    if part.startswith(SIDES):
        named, _, name = part.partition(" ")
        gaps[gaps >= to_joints(m, hands, whose, f"{SIDES[1 - SIDES.index(named)]} {name}")] = np.inf
    return gaps.min(axis=0) < gap


@predicate
def both_hands_on(m: Motion, who: int, part: str, gap: float = 0.22) -> Mask:
    """Both hands are on the other's ``part``."""
    return hand_on(m, who, part, "both", gap)


@predicate
def foot_on(m: Motion, who: int, part: str, gap: float = ON_JOINT) -> Mask:
    """A foot is on a part of the other's body."""
    return to_joints(m, m.pair(who, "foot"), 1 - who, part).min(axis=0) < gap


@predicate
def hand_to_own(m: Motion, who: int, part: str, side: str = "any", gap: float = ON_JOINT) -> Mask:
    """A hand is on the person's own ``part``; "both": each hand is."""
    return hand_on(m, who, part, side, gap, who)


@predicate
def hugs(m: Motion, gap: float = 0.55) -> Mask:
    """Chest near chest, and a hand of each on the other's back."""
    chests = np.linalg.norm(m.joint(0, "spine3") - m.joint(1, "spine3"), axis=-1)
    return (chests < gap) & hand_on(m, 0, "back", gap=0.25) & hand_on(m, 1, "back", gap=0.25)


@predicate
def arms_linked(m: Motion, gap: float = 0.2) -> Mask:
    """An elbow of one is at an elbow or a hand of the other, or their hands meet."""
    linked = hands_meet(m)
    for who in (0, 1):
        linked = linked | (to_joints(m, m.pair(who, "elbow"), 1 - who, "arm").min(axis=0) < gap)
    return linked


@predicate
def heads_near(m: Motion, metres: float = 0.4) -> Mask:
    """The heads are closer than ``metres``."""
    return np.linalg.norm(m.joint(0, "head") - m.joint(1, "head"), axis=-1) < metres


@predicate
def touches(m: Motion) -> Mask:
    """A hand of either one is on the other's body or hands."""
    return hands_meet(m) | hand_on(m, 0, "body", gap=0.15) | hand_on(m, 1, "body", gap=0.15)


# ---- two bodies --------------------------------------------------------------------------------------------
@predicate
def higher(m: Motion, who: int, metres: float = 0.25) -> Mask:
    """The person's head is ``metres`` or more above the other's."""
    return m.joint(who, "head")[:, 1] - m.joint(1 - who, "head")[:, 1] > metres


@predicate
def back_to_back(m: Motion, metres: float = 0.7) -> Mask:
    """Both face away from each other, ``metres`` apart at most."""
    return (m.off(0) > 120) & (m.off(1) > 120) & (m.distance < metres)


@predicate
def in_front(m: Motion, who: int, degrees: float = 60.0) -> Mask:
    """Is where the other faces, give or take ``degrees``."""
    return m.off(1 - who) < degrees


@predicate
def at_others_start(m: Motion, who: int, metres: float = 0.7) -> Mask:
    """Is within ``metres`` of where the other began, and further from where they themselves began."""
    there = np.linalg.norm(m.roots[who] - m.roots[1 - who][0], axis=-1)
    home = np.linalg.norm(m.roots[who] - m.roots[who][0], axis=-1)
    return (there < metres) & (home > there)


@predicate
def arm_on(m: Motion, who: int, part: str, gap: float = 0.22) -> Mask:
    """An elbow, wrist or palm is on a part of the other's body."""
    arms = np.concatenate([m.hands(who), m.pair(who, "elbow")])
    return to_joints(m, arms, 1 - who, part).min(axis=0) < gap


@predicate
def alike(m: Motion, mirrored: bool = False, lag: float = 0.0, least: float = 0.55) -> Mask:
    """Both move their limbs the same way at once, or b ``lag`` seconds after a.

    The limbs' velocities, each in its own body's frame, have a cosine of ``least`` or more over about a second, and
    both move. With ``mirrored`` a's left is compared with b's right.
    """
    first, second = m.limbs(0, mirrored=mirrored), m.limbs(1)
    shift = round(lag * m.fps)
    if abs(shift) >= m.frames:
        return np.zeros(m.frames, dtype=bool)
    first = np.roll(first, shift, axis=0)

    def over(values: Array) -> Array:
        return scipy.ndimage.gaussian_filter1d(values.sum(axis=(1, 2)), 0.3 * m.fps, mode="nearest")

    energies = over(first**2), over(second**2)
    cos = over(first * second) / np.sqrt(np.maximum(energies[0] * energies[1], 1e-12))
    mask = (cos > least) & (np.minimum(*energies) > 0.15)
    mask[: max(shift, 0)] = False
    mask[m.frames + min(shift, 0) :] = False
    return keep(mask, m.fps, lambda i, j: j - i >= 0.5 * m.fps, pause=0.1)


@predicate
def copies(m: Motion, who: int, least: float = 0.55) -> Mask:
    """Moves as the other did 0.4 to 2 s before, on the same side or mirrored."""
    sign = 1.0 if who == 1 else -1.0
    mask = np.zeros(m.frames, dtype=bool)
    for lag in np.arange(0.4, 2.01, 0.2):
        for mirrored in (False, True):
            mask |= alike(m, mirrored, sign * lag, least)
    return mask
