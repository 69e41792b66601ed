"""Postures: people who sit, kneel, crouch or lie down in a story and stay so, and people who jump.

A network that was trained on people who sit down and get up again does not leave them seated. The acts say how the
people hold themselves at the end of each beat; until they get up, their pelvis and legs are given, and the trunk and
head of those who lie or bend down.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum


class Posture(Enum):
    """A way to hold oneself."""

    STANDS = "stands"
    SITS = "sits"
    KNEELS = "kneels"
    GROUND = "sits on the ground"
    CROUCHES = "crouches"
    BENDS = "bends down"
    LIES = "lies"
    ALL_FOURS = "on all fours"


LOWERED = frozenset((Posture.KNEELS, Posture.CROUCHES, Posture.BENDS))
"""Those by which somebody gets down to what is low."""


@dataclass(frozen=True)
class Change:
    """A posture that one person takes up in a beat, or in which it finds them.

    Attributes:
        posture: how they hold themselves from then on.
        already: they do so when the beat begins, if nothing before it says otherwise ("while she sits").
        after: how much of the beat comes before, from 0 to 1.
        passing: they are up again at once, as after ducking.
        gently: they let themselves down and do not fall.
    """

    posture: Posture
    already: bool = False
    after: float = 0.0
    passing: bool = False
    gently: bool = False
