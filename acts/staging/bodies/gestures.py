"""Gestures of the hands: a raised hand, a wave, a pointing arm.

The network has rarely seen a gesture together with a way or a posture that is given, and some not at all, so hands are
given, also to people who only stand (:mod:`.arm_course` gives the arm).
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

import numpy as np
from numpy.typing import NDArray

from motion import SMPL22

from .poses import upright
from .strokes import STROKES

Array = NDArray[np.floating]
SIDES = ("left", "right")


class Hand(Enum):
    """A gesture of a hand."""

    HIGH = "high above the head"
    UP = "raised"
    SALUTES = "salutes"
    CLAPS = "claps"
    PHONE = "holds a phone to the ear"
    EARS = "covers the ears"
    EYES = "covers the eyes"
    PHOTO = "holds a camera before the face"
    PRAYS = "holds the palms together"
    AHEAD = "stretched out in front"
    OFFERS = "holds out a hand"
    WAVES = "waves"
    BECKONS = "beckons"
    POINTS = "points at the other"
    LINKED = "holds the other's hand"
    SPREAD = "stretched out to the side"
    HIPS = "on the hip"
    CHEST = "on the chest"
    BELLY = "on the belly"
    HEAD = "on the back of the head"
    MOUTH = "before the mouth"
    FANS = "fans the neck"
    BEHIND = "behind the back"
    CROSSED = "folded before the chest"
    FLAPS = "flaps like a wing"
    CIRCLES = "goes round in circles"
    SWINGS = "swings to and fro"
    SHAKES = "is shaken out"
    WORKS = "works before the body"
    RUBS = "rubs the other hand"
    AROUND = "around the back of the other, who is beside"
    LOWERS = "is lowered"
    DRUMS = "beats a drum"
    TYPES = "types"
    JUGGLES = "juggles"
    DRIBBLES = "bounces a ball"
    CONDUCTS = "conducts"
    PUMPS = "goes up and down before the body"
    KNOCKS = "knocks"
    PAINTS = "paints a wall"
    BRUSHES = "goes to and fro before the mouth"
    CARRIES = "carries something before the body"
    HAMMERS = "hammers"
    EATS = "brings food to the mouth"
    COMBS = "combs the hair"
    WRITES = "writes"
    BEATS = "beats the chest"
    BENDS = "is bent at the elbow"


@dataclass(frozen=True)
class Gesture:
    """A gesture of one person.

    Attributes:
        hand: which one.
        sides: "left", "right" or both of them.
    """

    hand: Hand
    sides: tuple[str, ...]


OF_BOTH = (Hand.HIGH, Hand.AHEAD, Hand.CLAPS, Hand.EARS, Hand.EYES, Hand.PHOTO, Hand.PRAYS, Hand.RUBS)
"""Gestures of both hands."""
_AT_BODY = {
    Hand.HIPS: (0.21, 0.1, 0.0),
    Hand.CHEST: (0.02, 0.36, 0.2),
    Hand.BELLY: (0.04, 0.14, 0.2),
    Hand.HEAD: (0.12, 0.66, -0.05),
    Hand.MOUTH: (0.07, 0.48, 0.17),
    Hand.BEHIND: (0.04, 0.02, -0.18),
    Hand.FANS: (0.12, 0.42, 0.22),
    Hand.CROSSED: (-0.1, 0.24, 0.17),
    Hand.SHAKES: (0.28, 0.08, 0.12),
    Hand.WORKS: (0.1, 0.16, 0.28),
    Hand.RUBS: (0.05, 0.24, 0.26),
}
"""Metres from the pelvis to the left wrist of hands that are held at one's own body."""
AT_OTHER = (Hand.LINKED, Hand.AROUND)
"""Gestures at the other's body."""
_REACH = 0.47
"""Metres from the shoulder to the wrist of an arm that is nearly straight."""
_BEYOND, _AT_BACK = 0.4, np.array([0.0, 0.32, -0.12])
"""Metres from the pelvis to the other beside, and up and back, of a hand around their back."""
_CLAPPING = np.array([0.0, 0.28, 0.3])
"""Metres from the pelvis to where hands clap."""
_EAR = np.array([0.2, 0.54, 0.06])
"""Metres from the pelvis to the left wrist of a hand at the ear, whose palm is higher."""
_EYE = np.array([0.08, 0.58, 0.18])
"""Metres from the pelvis to the left wrist of a hand before the eyes."""
_CLAP_RATE = 2.0
"""Claps a second."""
_WAVE = (1.2, 0.11)
"""Strokes a second of a wave, and the metres that the hand goes to either side of a place beside the head."""
_BECKON = (1.1, 0.08)
"""Strokes a second of a hand that beckons, and the metres that it goes to and fro."""
_FAN = (2.0, 0.1)
"""Strokes a second of a hand that fans, and the metres that it goes to either side."""


def wrist(gesture: Gesture, side: str, seconds: Array, towards: Array) -> Array:
    """A wrist's path beside the pelvis of a person who faces +Z.

    Args:
        gesture: the gesture.
        side: "left" or "right".
        seconds: (N,) moments.
        towards: (N, 3) unit directions to the other person, as seen by the one who faces +Z.

    Returns:
        (N, 3) metres from the pelvis.
    """
    pose = upright(np.zeros(2), 0.0)
    shoulder = pose[SMPL22.index(f"{side}_shoulder")] - pose[0]
    out = 1.0 if side == "left" else -1.0
    offset: Array = np.zeros((len(seconds), 3))
    match gesture.hand:
        case Hand.HIGH:
            offset[:] = [0.1 * out, 0.45, 0.08]
        case Hand.UP:
            offset[:] = [0.1 * out, 0.32, 0.16]
        case Hand.SALUTES:
            offset[:] = [0.03 * out, 0.15, 0.15]  # the fingertips are at the temple, the elbow is out
        case Hand.CLAPS:
            offset = _CLAPPING - shoulder + np.zeros((len(seconds), 3))
            offset[:, 0] += out * (0.075 + 0.07 * (1 + np.cos(2 * np.pi * _CLAP_RATE * np.asarray(seconds))))
        case Hand.PHONE | Hand.EARS:
            offset = _EAR * [out, 1.0, 1.0] - shoulder + np.zeros((len(seconds), 3))
        case Hand.EYES | Hand.PHOTO:
            offset = _EYE * [out, 1.0, 1.0] - shoulder + np.zeros((len(seconds), 3))
            offset[:, 2] += 0.1 if gesture.hand is Hand.PHOTO else 0.0
        case Hand.PRAYS:
            offset = _CLAPPING - shoulder + np.zeros((len(seconds), 3))
            offset[:] += [0.04 * out, 0.08, -0.08]
        case Hand.OFFERS:
            offset[:] = [-0.06 * out, -0.2, 0.38]
        case Hand.AHEAD:
            offset[:] = [0.02 * out, -0.05, 0.45]
        case Hand.WAVES:
            offset[:] = [0.2 * out, 0.18, 0.16]
            offset[:, 0] += _WAVE[1] * np.sin(2 * np.pi * _WAVE[0] * np.asarray(seconds))
        case Hand.BECKONS:
            stroke = np.sin(2 * np.pi * _BECKON[0] * np.asarray(seconds))
            offset[:] = [0.02 * out, -0.06, 0.3]
            offset += _BECKON[1] * stroke[:, None] * [0.0, -0.6, 0.8]
        case Hand.POINTS:
            offset = _REACH * towards + np.array([0.0, -0.05, 0.0])
        case Hand.AROUND:
            shoulder = np.zeros(3)
            offset = _BEYOND * towards + _AT_BACK
        case Hand.LOWERS:
            offset[:] = pose[SMPL22.index(f"{side}_wrist")] - pose[0] - shoulder
        case Hand.LINKED:
            shoulder = np.zeros(3)
            offset[:] = [0.22 * out, 0.0, 0.08]
        case _ if (stroke := STROKES.get(gesture.hand.name.lower())) is not None:
            offset = stroke.way(out, seconds) - shoulder
        case _:
            offset = _beside(gesture.hand, out, np.asarray(seconds), shoulder)
    return shoulder + offset


def _beside(hand: Hand, out: float, seconds: Array, shoulder: Array) -> Array:
    """A wrist's way (N, 3) beside the shoulder, of hands at one's own body and of arms that move by themselves."""
    turn, offset = 2 * np.pi * seconds, np.zeros((len(seconds), 3))
    match hand:
        case Hand.SPREAD:
            offset[:] = [0.45 * out, 0.0, 0.06]
        case Hand.FLAPS:
            offset[:] = [0.4 * out, 0.0, 0.06]
            offset[:, 1] = 0.22 * np.sin(turn * 1.2) - 0.06
        case Hand.CIRCLES:
            offset[:, 0] = 0.14 * out
            offset[:, 1], offset[:, 2] = 0.42 * np.cos(turn / 1.3), 0.42 * np.sin(turn / 1.3)
        case Hand.SWINGS:
            angle = 0.9 * np.sin(turn / 1.4)
            offset[:, 0] = 0.06 * out
            offset[:, 1], offset[:, 2] = -0.44 * np.cos(angle), 0.44 * np.sin(angle)
        case _:
            offset[:] = _AT_BODY[hand] * np.array([out, 1.0, 1.0]) - shoulder
            if hand is Hand.SHAKES:
                offset[:, 1] += 0.05 * np.sin(turn * 3.0)
            elif hand is Hand.WORKS:
                offset[:, 0] += 0.06 * np.cos(turn * 0.9)
                offset[:, 2] += 0.06 * np.sin(turn * 0.9)
            elif hand is Hand.RUBS:
                offset[:, 1] += 0.04 * out * np.sin(turn * 1.6)
            elif hand is Hand.CROSSED:
                offset[:, 1] -= 0.05 * out  # one forearm lies over the other
            elif hand is Hand.FANS:
                offset[:, 0] += _FAN[1] * np.sin(turn * _FAN[0])
    return offset
