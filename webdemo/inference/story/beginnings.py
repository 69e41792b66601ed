"""Places in which the words of a first beat have two people begin."""

from __future__ import annotations

import math
import re

import numpy as np

from .floor import ABREAST, Standing
from .holds import TWIRL, twirls
from .lifts import Carry, Lift, lift
from .poses import grounded, seated
from .postures import Posture, changes
from .strikes import Bout, strike

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


def beginning(sentence: str) -> Standing | None:
    """Places of two people of whom a sentence says that they are side by side or back to back; None of others."""
    words = sentence.lower()
    if _BACKS.search(words):
        held = (change.posture for listed in changes(sentence).values() for change in listed)
        seat = next((_SEATS[posture] for posture in held if posture in _SEATS), None)
        behind = float(seat(np.zeros(2), 0.0)[0, 2]) if seat else 0.0  # the feet are where they stand
        apart = BACKS - 2 * behind
        return Standing(np.array([[0.0, 0.0], [0.0, -apart]]), np.array([0.0, math.pi]))
    if _BESIDE.search(words):
        return Standing(np.array([[0.0, 0.0], [-ABREAST, 0.0]]), np.zeros(2))
    if (lifted := lift(sentence)) is not None and not lifted.comes:
        return _carried(lifted)
    struck = strike(sentence)
    if twirls(sentence) or (struck and struck.answered) or _KICKS.search(words):
        apart = TWIRL if twirls(sentence) else Bout.FISTS.value if struck else KICK
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
