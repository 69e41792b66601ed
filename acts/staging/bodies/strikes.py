"""Blows and throws: people who fight, with or without weapons, play with rackets, or throw each other a ball.

The network throws punches at the distance of its training scenes, most of which miss by half a metre, and only one of
the two strikes; rackets and balls it does not know. So the two are kept at the distance that they need, and the arms
are given at the moments of their blows, in turn. The rest is the network's.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

import numpy as np
from numpy.typing import NDArray

from motion import SMPL22
from motion.transforms import heading_matrix

from .poses import bending

Array = NDArray[np.floating]


class Bout(Enum):
    """Kinds of blows and throws, and the metres between the pelvises of the two."""

    FISTS = 0.75
    SLAPS = 0.65
    WEAPONS = 1.3
    RACKETS = 3.0
    THROWS = 2.2


@dataclass(frozen=True)
class Strike:
    """The blows or throws of a beat.

    Attributes:
        bout: of which kind.
        turns: who strikes, in order, "a" and "b", over and over where ``goes_on``.
        goes_on: they strike through the whole beat.
        answered: the other ducks, falls or steps back at the first blow.
        late: something else goes on until then.
        hands: the hand of each blow, where the words name them; "" leaves it open.
        up: what is thrown goes up, and comes down to the one who threw it.
    """

    bout: Bout
    turns: str
    goes_on: bool = True
    answered: bool = False
    late: bool = False
    hands: tuple[str, ...] = ()
    up: bool = False


@dataclass(frozen=True)
class Blow:
    """One blow or throw: the frame of the beat at which it lands, who strikes, and the hand."""

    frame: int
    person: int
    side: str


_CIRCLING = 0.03
"""Turns a second of two who fight around the middle between them."""
FIRST = 20
"""Frames before the first blow."""
_DRAWN = 5
"""Frames before a blow in which the arm is drawn back."""
PERIODS = {Bout.FISTS: 22, Bout.SLAPS: 24, Bout.WEAPONS: 26, Bout.RACKETS: 36, Bout.THROWS: 48}
"""Frames from one blow to the next."""
_FLIGHT = 16
"""Frames for which what was thrown is in the air."""
_REACHES = {
    Bout.FISTS: ((0.14, 0.4, 0.14), None),
    Bout.SLAPS: ((0.5, 0.5, 0.08), None),
    Bout.WEAPONS: ((0.12, 0.78, 0.02), (0.02, 0.4, 0.5)),
    Bout.RACKETS: ((0.45, 0.3, -0.1), (-0.05, 0.4, 0.45)),
    Bout.THROWS: ((0.22, 0.68, -0.12), (0.05, 0.5, 0.48)),
}
"""Metres from the pelvis to the left wrist before a blow, and as it lands; None on the other's head."""
_READY = np.array([0.12, 0.2, 0.28])
"""Metres from the pelvis to the left wrist between two blows."""
_RECOVERS = 11
"""Frames after a blow in which the arm is ready again."""
CATCHING = np.array([0.12, 0.35, 0.4])
"""Metres from the pelvis to the left wrist of hands that catch."""
_TWIST, _LEAN = 0.4, 0.12
"""Radians by which the shoulder goes ahead with the fist, and by which the trunk leans forward."""
_ARM = 0.5
"""Metres from the shoulder to the wrist of an arm that strikes."""
_FIST = 0.1
"""Metres from the wrist to what its fist hits."""
_CHEEK = np.array([0.11, 0.0, 0.05])
"""Metres from the other's head to the left wrist of a flat hand on the cheek: aside, up, and back to the shoulder."""


def turning(bout: Bout) -> float:
    """Turns a second of the two around the middle between them."""
    return _CIRCLING if bout in (Bout.FISTS, Bout.WEAPONS) else 0.0


def blows(struck: Strike, frames: int, *, first: int = 0) -> list[Blow]:
    """The blows of a beat of so many frames, from its ``first`` frame at which the two are at their distance."""
    period = PERIODS[struck.bout] * (1 if len(set(struck.turns)) > 1 or struck.hands else 2)
    if struck.bout is Bout.THROWS and not struck.goes_on:  # each in its own share of the beat
        period = max(period, frames // len(struck.turns))
    last = frames - (_FLIGHT + 6 if struck.bout is Bout.THROWS else _DRAWN)
    at = range(first + FIRST, last, period)
    made = [
        Blow(frame, "ab".index(struck.turns[i % len(struck.turns)]), _hand(struck, i)) for i, frame in enumerate(at)
    ]
    return made if struck.goes_on else made[: len(struck.turns)]


def _hand(struck: Strike, number: int) -> str:
    """The hand that the words name; else fists take turns; weapons, rackets and balls are in the right hand."""
    if (named := "".join(struck.hands[number : number + 1])) in ("left", "right"):
        return named
    left = struck.bout is Bout.FISTS and number // len(struck.turns) % 2
    return "left" if left else "right"


def poses(bout: Bout, side: str, place: Array, other: Array) -> tuple[tuple[int, ...], Array]:
    """A blow or throw as frames beside the one at which it lands, and poses of the one who strikes.

    Args:
        bout: of which kind.
        side: "left" or "right".
        place: (2,) x and z of the one who strikes, in metres.
        other: (2,) of the other.

    Returns:
        N frames, and (N, 22, 3) metres from the pelvis; only the trunk and the wrist of that side are meant.
    """
    line = np.asarray(other) - place
    angle, sign = float(np.arctan2(line[0], line[1])), 1.0 if side == "left" else -1.0
    wrist, turn = SMPL22.index(f"{side}_wrist"), heading_matrix(angle)
    back, ahead = _REACHES[bout]
    drawn = bending(place, angle + sign * _TWIST / 2, _LEAN)
    drawn[wrist] = drawn[0] + turn @ (np.array(back) * [sign, 1.0, 1.0])
    landed = bending(place, angle - sign * _TWIST, _LEAN)
    if ahead is None:
        pose = bending(np.asarray(other), angle + np.pi, _LEAN)
        head = pose[SMPL22.index("head")] + landed[0] - pose[0] + np.array([line[0], 0.0, line[1]])
        if bout is Bout.SLAPS:
            head = head + turn @ (_CHEEK * [sign, 1.0, -1.0])
        shoulder = landed[SMPL22.index(f"{side}_shoulder")]
        length = float(np.linalg.norm(head - shoulder))
        near = 0.0 if bout is Bout.SLAPS else _FIST
        landed[wrist] = shoulder + (head - shoulder) * min(_ARM, length - near) / length
    else:
        landed[wrist] = landed[0] + turn @ (np.array(ahead) * [sign, 1.0, 1.0])
    after = drawn if ahead is None else ready(place, other)
    return (-_DRAWN, -1, 1, _RECOVERS), np.stack([pose - pose[0] for pose in (drawn, landed, landed, after)])


def ready(place: Array, other: Array, reach: Array = _READY) -> Array:
    """A pose (22, 3) from the pelvis of a person with both hands ready, towards the other; places as above."""
    line = np.asarray(other) - place
    angle = float(np.arctan2(line[0], line[1]))
    pose = bending(place, angle, _LEAN)
    for side, sign in (("left", 1.0), ("right", -1.0)):
        pose[SMPL22.index(f"{side}_wrist")] = pose[0] + heading_matrix(angle) @ (reach * [sign, 1.0, 1.0])
    return pose - pose[0]


def catching(place: Array, other: Array, *, up: bool = False) -> tuple[tuple[int, ...], Array]:
    """Both hands that catch what is thrown, or thrown up, as :func:`poses` from the frame at which it is thrown."""
    flight = 2 * _FLIGHT if up else _FLIGHT
    return (flight - 6, flight, flight + 6), np.stack([ready(place, other, CATCHING)] * 3)
