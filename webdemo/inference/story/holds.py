"""Holds: couples who dance in each other's arms, and pairs who spin round with both hands joined.

The network lets go of hands while people turn. There, the way of both and their hands are given.
"""

from __future__ import annotations

import re
from enum import Enum

import numpy as np
from numpy.typing import NDArray

from .clauses import OTHER, clauses

Array = NDArray[np.floating]


class Hold(Enum):
    """A hold, and the metres between the pelvises of those who are in it."""

    CLOSED = 0.5
    RING = 0.85

    @property
    def turns(self) -> float:
        """Turns a second of the two around the middle between them."""
        return 0.14 if self is Hold.CLOSED else 0.17


_DANCE = re.compile(
    r"\b(?:waltz|tango|foxtrot|rumba|ballroom|slow[- ]?danc|salsa|polka|bachata|two-step)\w*"
    r"|\b(?:danc|sway)\w* (?:\w+ )?(?:close|closely|in each other's arms|cheek to cheek|arm in arm|a slow \w+)\b"
)
_TURN = re.compile(
    r"\b(?:spin|whirl|twirl|turn|danc|circl|go|swing|skip|run|jump)\w* (?:\w+ )?(?:a?round|in (?:a )?circles?)\b"
    r"|\bring[- ]a[- ]ring\b"
)
_HANDS = re.compile(
    r"\b(?:hold|tak|join|grab|link|clasp)\w* (?:each other by |each other's |one another's )?(?:on to )?"
    r"(?:both )?(?:their )?hands\b"
    r"|\bby (?:both|the) hands\b|\bboth hands joined\b|\bhand in hand\b"
)
_TWIRLS = re.compile(
    rf"\b(?:twirl|spin|turn|whirl)(?:s|ing)? {OTHER} (?:a?round )?(?:(?:once|twice) )?under\b"
    rf"|\btwirls? {OTHER}(?: a?round)?$|\bspins? {OTHER} out\b"
)
_TWIRLED = re.compile(
    r"\b(?:twirl|spin|turn)s? (?:a?round )?under (?:his|her|their|person [ab]'s|the \w+'s) (?:raised )?arm\b"
)
TWIRL = 0.42
"""Metres between the pelvises of two of whom one turns under the other's arm."""
_OVER = 1.88
"""Height in metres of the hands over somebody who turns under them."""
_BOTH = re.compile(r"\bboth (?:of )?(?:his|her|their|the other's|person [ab]'s) hands\b|\bby both hands\b")
_LEADS = re.compile(r"(?:is |are )?(?:lead|follow)(?:s|ing)?")
_NOT = re.compile(r"\b(?:do(?:es)?n't|not|without|never|refus\w+ to|wants? to|stops?)\b")


def hold(sentence: str) -> Hold | None:
    """The hold of a beat's sentence, where two people together dance or spin in one."""
    found = [clause for clause in clauses(sentence) if not _LEADS.fullmatch(clause.words)]
    words = " and ".join(clause.words for clause in found)
    if _NOT.search(words) or any(clause.who != "ab" for clause in found):
        return None
    if _DANCE.search(words):
        return Hold.CLOSED
    return Hold.RING if _HANDS.search(words) and _TURN.search(words) else None


def twirls(sentence: str) -> str:
    """The one, "a" or "b", under whose raised arm the other turns in a beat's sentence; "" if nobody does."""
    for clause in clauses(sentence):
        if clause.who == "ab" or not clause.subject or _NOT.search(clause.words):
            continue
        if _TWIRLS.search(clause.words):
            return clause.who
        if _TWIRLED.search(clause.words):
            return "b" if clause.who == "a" else "a"
    return ""


def raised(places: Array) -> Array:
    """The place of the two joined hands over two people (2, N, 2), one of whom turns under them: (N, 3) metres."""
    return np.insert(np.mean(places, axis=0), 1, _OVER, axis=-1)


def leads_by_both_hands(sentence: str) -> bool:
    """True if a beat's words have somebody hold both of the other's hands."""
    return bool(_BOTH.search(sentence.lower()))


def joined(kind: Hold, places: Array) -> Array:
    """The places of the wrists of two people in a hold.

    Args:
        kind: the hold.
        places: (2, N, 2) x and z in metres of a, who leads, and b.

    Returns:
        (2, 2, N, 3) metres: of each person the left wrist and the right one.
    """
    a, b = (np.insert(place, 1, 0.0, axis=-1) for place in places)
    ahead = (b - a) / np.linalg.norm(b - a, axis=-1, keepdims=True).clip(min=1e-6)
    left = np.cross([0.0, 1.0, 0.0], ahead)  # of a
    middle, up = (a + b) / 2, np.array([0.0, 1.0, 0.0])
    if kind is Hold.RING:
        one, other = (middle + side * 0.24 * left + 1.05 * up for side in (1, -1))
        gap = 0.03 * ahead
        return np.stack([[one - gap, other - gap], [other + gap, one + gap]])
    hands = middle + 0.42 * left + 1.3 * up
    return np.stack(
        [
            [hands - 0.03 * ahead, b - 0.2 * left + 1.2 * up],  # a's right hand on b's back
            [a - 0.17 * left + 1.42 * up + 0.1 * ahead, hands + 0.03 * ahead],  # b's left on a's shoulder
        ]
    )
