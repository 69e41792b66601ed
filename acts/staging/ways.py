"""Ways of moving over the floor, and the words that name them."""

from __future__ import annotations

from enum import Enum


class Way(Enum):
    """A way of moving over the floor, or of staying."""

    TO = "walks up to the other"
    BEHIND = "comes up behind the other"
    BESIDE = "comes up beside the other"
    AWAY = "walks away from the other"
    BACK = "steps back"
    PAST = "walks past the other"
    ROUND = "walks around the other"
    ALONG = "walks side by side with the other"
    AFTER = "follows the other"
    HOLD = "goes round with the other, in hold"
    SPAR = "stands before the other"
    TURN = "turns around"
    AVERTED = "has their back to the other"
    ASIDE = "steps aside"
    THING = "goes to a thing"
    FACE = "turns to the other"
    BACKS = "has their back to the other's"
    AHEAD = "walks ahead"
    PACE = "walks to and fro"
    STAY = "stays in place"
