"""Bystanders: the people who do nothing in a sentence, and how they stand.

Networks that were trained on people who mostly do the same let a bystander sit down, bow or wave along. A bystander
is therefore given a standing pose twice a second, and the network makes the movement between.
"""

from __future__ import annotations

import re

import numpy as np
from numpy.typing import NDArray

from motion import SMPL22
from motion.kinematics import forward_kinematics
from motion.transforms import heading_matrix

from .clauses import Clause, clauses
from .moves import MOVED, Way, goes, moves, way_of

Array = NDArray[np.floating]

_NOTHING = re.compile(
    r"\b(?:stands?|standing|stays?|waits?|watch(?:es|ing)?|looks? on|observ\w+|remains?|listens?|ignor\w+|nothing|"
    r"motionless|upright|unmoved|idle|rooted|pays? no attention|"
    r"star(?:es?|ing)|gaz\w+|just looks?|refus\w+|declin\w+|keeps? still|without (?:moving|reacting|answering)|"
    r"do(?:es)? ?n[o']t (?:\w+ )?(?:move|react|answer|respond|budge|follow|return|take|shake|wave|bow|clap|join|accept"
    r"|\w+ back))\b"
)
_BUSY = re.compile(
    r"\b(?:sit|seated|kneel|crouch|squat|lie|lying|lean|wav(?!e back)|point|hold|talk|speak|laugh|cheer|"
    r"clap(?!s? back)|danc|arms? (?:crossed|folded|raised|up)|hands? (?:up|raised|on)|offer|push|pull|step|turns?|"
    r"back to back)\w*"
)
_ALONE = re.compile(
    r"\b(?:(?:jump|leap|hop|fall|kneel|crawl|roll|spin|squat|crouch|stretch|bow|clap|applaud|beckon|salut|nod|shrug|"
    r"collaps|cheer|danc|faint|yawn|curts|stamp|scratch|juggl|exercis|shiver|trembl|sob|laugh|pray|meditat|march)\w*|sits?|sitting|lies|lying|wav(?:es?|ing)|points?|pointing|rais\w+|lowers?|"
    r"lifts? (?:his|her|their|the|both)|gets? (?:up|down)|stands? up|trips?)\b"
)
"""Acts that need nobody else."""
_TOUCH = re.compile(
    r"\b(?:hug|embrac|pat|pats|tap|hit|slap|grab|hold|tak|giv|pull|push|shov|lift|carr|help|kiss|cover|comfort|touch|"
    r"lay|lean|tickl|shak|strok|catch|throw|kick|punch|lead|drag|support|tackl|trip|pass|hand|high[- ]fiv|fist)\w*"
)
_DOWN = re.compile(
    r"\b(?:(?:sit|kneel|lie|crouch|squat|get|go|drop|sink|fall)s? (?:\w+ )?down\b|falls?\b|collapses?\b|faints?\b"
    r"|(?:drop|sink|fall|go|get)(?:s|es)? (?:\w+ ){0,3}?(?:ground|floor|knees?)\b)"
)
_IN_VAIN = re.compile(r"\b(?:left hanging|in vain|gets? no answer|(?:is|are) ignored)\b")


def idle(sentence: str) -> frozenset[str]:
    """The people, "a" and "b", who stand by and do nothing else in a beat's sentence.

    These are people who are said to wait, to watch or not to answer, or who are not mentioned while the other does
    something that needs nobody else, such as sitting down.
    """
    found = clauses(sentence)
    vain = {"ab".replace(c.who, "") for c in found if _IN_VAIN.search(c.words) and c.who != "ab"}
    own = {person: [c for c in found if person in c.who] for person in "ab"}
    if any(c.who == "ab" for c in found) or any(
        MOVED.search(c.words) and _TOUCH.search(c.words) for c in found
    ):
        return frozenset(vain)
    return frozenset(vain | {p for p, q in ("ab", "ba") if _stands_by(own[p], own[q])})


def is_planned(sentence: str) -> bool:
    """True if a beat's words say where people go, who stands by, or who begins on their feet."""
    return goes(moves(sentence)) or bool(idle(sentence)) or bool(goes_down(sentence))


def touches(sentence: str) -> bool:
    """True if the words of a beat are of a touch."""
    return bool(_TOUCH.search(sentence.lower()))


def goes_down(sentence: str) -> frozenset[str]:
    """The people who sit, kneel or lie down or fall in a beat's sentence, and so are on their feet before."""
    return frozenset(who for clause in clauses(sentence) if _DOWN.search(clause.words) for who in clause.who)


def _stands_by(own: list[Clause], others: list[Clause]) -> bool:
    if own:
        return all(_NOTHING.search(c.words) and not _BUSY.search(_NOTHING.sub("", c.words)) for c in own)
    acts = [c for c in others if way_of(c.words) is None or way_of(c.words) is Way.TURN]
    return bool(acts) and all(_ALONE.search(c.words) and not _TOUCH.search(c.words) for c in acts)


def standing(place: Array, angle: float, seconds: Array, *, seed: int = 0) -> Array:
    """Somebody who stands with hanging arms and shifts their weight a little.

    Args:
        place: (2,) x and z of the pelvis in metres.
        angle: heading in radians from +Z towards +X.
        seconds: (N,) moments.
        seed: draws the phases of the sway.

    Returns:
        (N, 22, 3) metres, the feet on the floor and at one place.
    """
    phases = np.random.default_rng(seed).uniform(0, 2 * np.pi, 4)
    sway = [
        np.sin(2 * np.pi * np.asarray(seconds) / period + phase)
        for period, phase in zip((5.3, 3.9, 7.1, 4.4), phases, strict=True)
    ]
    turns = np.tile(np.eye(3), (len(seconds), SMPL22.num_joints, 1, 1))
    turns[:, 0] = heading_matrix(angle) @ _about(2, 0.012 * sway[0])
    turns[:, SMPL22.index("spine2")] = _about(2, -0.02 * sway[0]) @ heading_matrix(0.03 * sway[1])
    turns[:, SMPL22.index("neck")] = _about(0, 0.05 + 0.02 * sway[1])
    turns[:, SMPL22.index("head")] = heading_matrix(0.1 * sway[2])
    for side, sign, arm in (("left", 1.0, sway[3]), ("right", -1.0, sway[1])):
        turns[:, SMPL22.index(f"{side}_shoulder")] = _about(2, -sign * (1.4 + 0.015 * arm)) @ _about(
            0, 0.05 + 0.03 * arm
        )
        turns[:, SMPL22.index(f"{side}_elbow")] = heading_matrix(-sign * (0.3 + 0.06 * arm))
        turns[:, SMPL22.index(f"{side}_hip")] = _about(2, -sign * 0.02 - 0.012 * sway[0]) @ _about(
            0, np.full(len(seconds), -0.06)
        )
        turns[:, SMPL22.index(f"{side}_knee")] = _about(0, np.full(len(seconds), 0.12))
        turns[:, SMPL22.index(f"{side}_ankle")] = _about(0, np.full(len(seconds), -0.06))
    root = np.zeros((len(seconds), 3))
    poses = forward_kinematics(turns, root)
    soles = poses[:, [SMPL22.index("left_foot"), SMPL22.index("right_foot")]]
    poses -= soles.mean(axis=1, keepdims=True) * [1, 0, 1]
    poses[..., 1] += SOLE - soles[..., 1].mean(axis=1)[:, None]
    return poses + np.array([place[0], 0.0, place[1]]) + _ahead(angle)


SOLE = 0.02
"""Height in metres of the toe joint of a foot that stands."""


def _ahead(angle: float) -> Array:
    """From a pelvis to the middle between the toes below it."""
    return 0.12 * np.array([np.sin(angle), 0.0, np.cos(angle)])


def _about(axis: int, angle: Array | float) -> Array:
    """(…, 3, 3) rotations about X (0) or Z (2)."""
    angle = np.asarray(angle, dtype=np.float64)
    cos, sin, one, zero = np.cos(angle), np.sin(angle), np.ones_like(angle), np.zeros_like(angle)
    rows = (
        [one, zero, zero, zero, cos, -sin, zero, sin, cos]
        if axis == 0
        else [cos, -sin, zero, sin, cos, zero, zero, zero, one]
    )
    return np.stack(rows, axis=-1).reshape(*angle.shape, 3, 3)
