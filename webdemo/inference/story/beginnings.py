"""Places in which the words of a first beat have two people begin."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .floor import ABREAST, Standing
from .holds import TWIRL
from .lifts import Carry, Lift
from .poses import grounded, seated
from .postures import Posture
from .strikes import Bout, Strike

KICK = 1.0
"""Metres between two people one of whom kicks the other."""
BACKS = 0.5
"""Metres between the pelvises of two people who stand or sit back to back."""
RUN_UP = 2.5
"""Metres that somebody runs who jumps on the other's back."""
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
        apart: metres between them where they face each other; 0 leaves it free.
    """

    backs: bool = False
    beside: bool = False
    postures: Sequence[Posture] = ()
    lift: Lift | None = None
    strike: Strike | None = None
    twirls: bool = False
    apart: float = 0.0


def standing(setting: Setting) -> Standing | None:
    """The places of two people in a setting; None where it leaves them free."""
    if setting.backs:
        seat = next((_SEATS[posture] for posture in setting.postures if posture in _SEATS), None)
        behind = float(seat(np.zeros(2), 0.0)[0, 2]) if seat else 0.0  # the feet are where they stand
        apart = BACKS - 2 * behind
        return Standing(np.array([[0.0, 0.0], [0.0, -apart]]), np.array([0.0, math.pi]))
    if setting.beside:
        return Standing(np.array([[0.0, 0.0], [-ABREAST, 0.0]]), np.zeros(2))
    lifted = setting.lift
    if lifted is not None and lifted.carry is Carry.BACK and lifted.comes not in ("", lifted.carrier):
        return _from_behind(lifted)
    if lifted is not None and not lifted.comes:
        return _carried(lifted)
    struck = setting.strike
    if setting.twirls or (struck and struck.answered) or setting.apart:
        apart = TWIRL if setting.twirls else Bout.FISTS.value if struck else setting.apart
        return Standing(np.array([[0.0, 0.0], [0.0, apart]]), np.array([0.0, math.pi]))
    return None


def _from_behind(lifted: Lift) -> Standing:
    """A place behind the other, for a person about to run up and jump on their back."""
    places = np.zeros((2, 2))
    places["ab".index(lifted.carrier) - 1, 1] = -RUN_UP
    return Standing(places, np.zeros(2))


def _carried(lifted: Lift) -> Standing:
    """A place before the other for who is lifted or dragged, and behind the one who walks on for who is carried."""
    places, headings = np.zeros((2, 2)), np.zeros(2)
    if lifted.carry in (Carry.UP, Carry.DRAGS):
        places[1, 1], headings[1] = lifted.carry.near, math.pi
    else:
        places["ab".index(lifted.carrier) - 1, 1] = -0.3
    return Standing(places, headings)
