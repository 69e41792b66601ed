"""Places in which the words of a first beat have two people begin."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from acts.plan import other_of

from .bodies.poses import grounded, seated, upright
from .bodies.strikes import Strike
from .floor import ABREAST, BEHIND, CLOSE, LINKED, Standing
from .holds import TWIRL
from .lifts import Carry, Lift
from .moves import Move
from .postures import Posture
from .ways import Way

BACKS = 0.34
"""Metres between the pelvises of two people who stand or sit back to back: the backs touch."""
BEHIND_BACK = 0.6
"""Metres between two people one of whom stands behind the other."""
RUN_UP = 2.5
"""Metres that somebody runs who jumps on the other's back."""
LEAD = 1.6
"""Metres by which somebody is ahead who is overtaken."""
REACH = 0.75
"""Metres between two people one of whom touches the other."""
_START = {Way.AWAY: 1.1, Way.THING: 1.1, Way.PAST: 2.2, Way.ROUND: 1.2, Way.BACK: 0.9}
"""Metres between two people at the beginning of a first beat with such a move."""
_SEATS = {Posture.SITS: seated, Posture.GROUND: grounded}


@dataclass(frozen=True)
class Setting:
    """The part of a first beat that says where its people are.

    Attributes:
        backs: they are back to back.
        beside: they are side by side.
        postures: that they take up or are in.
        lift, strike: of the beat.
        twirls: one turns under the other's arm.
        apart: metres between them where they face each other, are side by side or one stands behind; 0 leaves it free.
        behind: the person who stands behind the other; "" for nobody.
    """

    backs: bool = False
    beside: bool = False
    postures: Sequence[Posture] = ()
    lift: Lift | None = None
    strike: Strike | None = None
    twirls: bool = False
    apart: float = 0.0
    behind: str = ""


def starting(moves: Sequence[Move], seconds: float, *, near: bool = False) -> Standing:
    """Places before a first beat: a at the origin, facing +Z, and b so that their moves can begin.

    Args:
        moves: of the first beat that has any.
        seconds: its length.
        near: they are within reach of each other, unless one comes to the other.
    """
    ways = {move.way: move for move in reversed(moves)}
    if Way.ALONG in ways:
        gap = LINKED if ways[Way.ALONG].linked else ABREAST
        return Standing(np.array([[0.0, 0.0], [-gap, 0.0]]), np.zeros(2))
    if Way.AFTER in ways and any(move.backwards for move in moves):
        gap = ways[Way.AFTER].near or BEHIND
        return Standing(np.array([[0.0, 0.0], [0.0, gap]]), np.array([0.0, math.pi]))
    if Way.AFTER in ways:
        lead = 1 if ways[Way.AFTER].person == "a" else -1
        return Standing(np.array([[0.0, 0.0], [0.0, lead * BEHIND]]), np.zeros(2))
    if Way.PAST in ways and Way.AHEAD in ways and ways[Way.PAST].person != ways[Way.AHEAD].person:
        lead = 1 if ways[Way.PAST].person == "a" else -1
        return Standing(np.array([[0.0, 0.0], [0.0, lead * LEAD]]), np.zeros(2))
    if Way.PAST in ways and ways[Way.PAST].backwards:
        facing = math.pi if ways[Way.PAST].person == "a" else 0.0  # both look the same way
        return Standing(np.array([[0.0, 0.0], [0.0, _START[Way.PAST]]]), np.full(2, facing))
    if Way.BACKS in ways:
        apart = BACKS - 2 * float(upright(np.zeros(2), 0.0)[0, 2])
        return Standing(np.array([[0.0, 0.0], [0.0, -apart]]), np.array([0.0, math.pi]))
    gap = next((_START[move.way] for move in moves if move.way in _START), REACH if near else 1.4)
    gap = next((ways[way].near for way in (Way.HOLD, Way.SPAR) if way in ways), gap)
    for way in (Way.TO, Way.BEHIND):
        if way in ways:
            gap = float(np.clip(CLOSE + 0.6 * seconds * ways[way].speed, 1.8, 3.6 if ways[way].speed < 2 else 5.0))
    averted = (Way.AVERTED,) if Way.ROUND in ways else (Way.AVERTED, Way.FACE)
    turned = next((m.person for m in moves if m.way in averted), "")
    turned = turned or next((other_of(m.person) for m in moves if m.way is Way.BEHIND), "")
    ahead = -1.0 if turned == "a" else 1.0
    facing_b = 0.0 if turned else math.pi
    return Standing(np.array([[0.0, 0.0], [0.0, ahead * gap]]), np.array([0.0, facing_b]))


def standing(setting: Setting) -> Standing | None:
    """The places of two people in a setting; None where it leaves them free."""
    if setting.backs:
        pose = next((_SEATS[posture] for posture in setting.postures if posture in _SEATS), upright)
        behind = float(pose(np.zeros(2), 0.0)[0, 2])  # the feet are where they stand
        apart = BACKS - 2 * behind
        return Standing(np.array([[0.0, 0.0], [0.0, -apart]]), np.array([0.0, math.pi]))
    if setting.beside:
        return Standing(np.array([[0.0, 0.0], [-(setting.apart or ABREAST), 0.0]]), np.zeros(2))
    lifted = setting.lift
    if lifted is not None and lifted.carry is Carry.BACK and lifted.comes not in ("", lifted.carrier):
        return _from_behind(lifted)
    if lifted is not None and not lifted.comes:
        return _carried(lifted)
    if setting.behind:
        places = np.zeros((2, 2))
        places["ab".index(setting.behind), 1] = -(setting.apart or BEHIND_BACK)
        return Standing(places, np.zeros(2))
    struck = setting.strike
    if setting.twirls or (struck and struck.answered) or setting.apart:
        apart = TWIRL if setting.twirls else struck.bout.value if struck else setting.apart
        return Standing(np.array([[0.0, 0.0], [0.0, apart]]), np.array([0.0, math.pi]))
    return None


def _from_behind(lifted: Lift) -> Standing:
    """A place behind the other, for a person about to run up and jump on their back."""
    places = np.zeros((2, 2))
    places["ab".index(lifted.carrier) - 1, 1] = -RUN_UP
    return Standing(places, np.zeros(2))


def _carried(lifted: Lift) -> Standing:
    """A place in front of the other for one who is lifted or dragged, and behind the walker for one who is carried."""
    places, headings = np.zeros((2, 2)), np.zeros(2)
    if lifted.carry in (Carry.UP, Carry.DRAGS):
        places[1, 1], headings[1] = lifted.carry.near, math.pi
    else:
        places["ab".index(lifted.carrier) - 1, 1] = -0.3
    return Standing(places, headings)
