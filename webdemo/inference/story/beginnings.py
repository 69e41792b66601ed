"""Places in which the words of a first beat have two people begin."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .floor import ABREAST, Standing
from .holds import TWIRL, twirls
from .lifts import Carry, Lift, lift
from .poses import grounded, seated
from .postures import Posture, changes
from .strikes import Bout, Strike, strike

_BESIDE = re.compile(
    r"\b(?:side by side|shoulder to shoulder|next to (?:each other|one another|him|her|person [ab]|the other)"
    r"|beside (?:each other|one another|him|her|person [ab]|the other))\b"
)
_BACKS = re.compile(r"\bback[- ]to[- ]back\b")
_KICKS = re.compile(
    r"\bkick(?:s|ing)?(?: (?:out )?at)? (?:person [ab]|the other|him|her|them|each other|one another|(?:the|an?) \w+$)"
)
KICK = 1.0
"""Metres between two people one of whom kicks the other."""
BACKS = 0.5
"""Metres between the pelvises of two people who stand or sit back to back."""
_SEATS = {Posture.SITS: seated, Posture.GROUND: grounded}


def keeps_place(sentence: str) -> bool:
    """True if a sentence has two people side by side or back to back, where they stay."""
    words = sentence.lower()
    return bool(_BACKS.search(words) or _BESIDE.search(words))


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


def beginning(sentence: str) -> Standing | None:
    """Places of two people of whom a sentence says where they are; None of others."""
    words = sentence.lower()
    held = [change.posture for listed in changes(sentence).values() for change in listed]
    return standing(
        Setting(
            bool(_BACKS.search(words)), bool(_BESIDE.search(words)), held, lift(sentence), strike(sentence),
            bool(twirls(sentence)), KICK if _KICKS.search(words) else 0.0,
        )
    )  # fmt: skip


def standing(setting: Setting) -> Standing | None:
    """The places of two people in a setting; None where it leaves them free."""
    if setting.backs:
        seat = next((_SEATS[posture] for posture in setting.postures if posture in _SEATS), None)
        behind = float(seat(np.zeros(2), 0.0)[0, 2]) if seat else 0.0  # the feet are where they stand
        apart = BACKS - 2 * behind
        return Standing(np.array([[0.0, 0.0], [0.0, -apart]]), np.array([0.0, math.pi]))
    if setting.beside:
        return Standing(np.array([[0.0, 0.0], [-ABREAST, 0.0]]), np.zeros(2))
    if setting.lift is not None and not setting.lift.comes:
        return _carried(setting.lift)
    struck = setting.strike
    if setting.twirls or (struck and struck.answered) or setting.apart:
        apart = TWIRL if setting.twirls else Bout.FISTS.value if struck else setting.apart
        return Standing(np.array([[0.0, 0.0], [0.0, apart]]), np.array([0.0, math.pi]))
    return None


def _carried(lifted: Lift) -> Standing:
    """A place before the other for who is lifted or dragged, and behind the one who walks on for who is carried."""
    places, headings = np.zeros((2, 2)), np.zeros(2)
    if lifted.carry in (Carry.UP, Carry.DRAGS):
        places[1, 1], headings[1] = lifted.carry.near, math.pi
    else:
        places["ab".index(lifted.carrier) - 1, 1] = -0.3
    return Standing(places, headings)
