"""Holds: couples who dance in each other's arms, and pairs who spin round with both hands joined.

The network lets go of hands while people turn. There, the way of both and their hands are given.
"""

from __future__ import annotations

from enum import Enum

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.floating]


class Hold(Enum):
    """A hold, and the metres between the pelvises of those who are in it."""

    CLOSED = 0.6
    RING = 0.85
    PALMS = 0.95

    @property
    def turns(self) -> float:
        """Turns a second of the two around the middle between them."""
        return {Hold.CLOSED: 0.14, Hold.RING: 0.17, Hold.PALMS: 0.0}[self]

    @property
    def lean(self) -> float:
        """Radians by which the two lean towards each other."""
        return 0.25 if self is Hold.PALMS else 0.0


TWIRL = 0.42
"""Metres between the pelvises of two people while one turns under the other's arm."""
_OVER = 1.88
"""Height in metres of the hands over the person who turns under them."""
_BASIC, _BAR = 0.16, 2.0
"""Metres and seconds of a couple's basic step to and fro."""
_TOGETHER, _GROWS = 0.8, 0.6
"""Seconds in which the two come together before it, and in which it grows to its length."""


def raised(places: Array) -> Array:
    """The place of the two joined hands over two people (2, N, 2), one of whom turns under them: (N, 3) metres."""
    return np.insert(np.mean(places, axis=0), 1, _OVER, axis=-1)


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
    if kind is not Hold.CLOSED:
        wide, high, apart = (0.24, 1.05, 0.03) if kind is Hold.RING else (0.17, 1.3, 0.06)
        one, other = (middle + side * wide * left + high * up for side in (1, -1))
        gap = apart * ahead
        return np.stack([[one - gap, other - gap], [other + gap, one + gap]])
    hands = middle + 0.42 * left + 1.3 * up
    return np.stack(
        [
            [hands - 0.03 * ahead, b - 0.2 * left + 1.06 * up],  # a's right hand on b's back
            [a - 0.17 * left + 1.46 * up + 0.1 * ahead, hands + 0.03 * ahead],  # b's left on a's shoulder
        ]
    )


def danced(seconds: Array, angles: Array, sign: float) -> Array:
    """(N, 2) metres by which a couple in hold steps to and fro, along the line between them, as they turn.

    Args:
        seconds: (N,) since the beat began.
        angles: (N,) radians of one of them about the middle.
        sign: 1 for a and -1 for b, who go the same way.
    """
    ahead = sign * np.stack([np.sin(angles), np.cos(angles)], axis=1)
    since = np.clip(seconds - _TOGETHER, 0, None)[:, None]
    return np.clip(since / _GROWS, 0, 1) * _BASIC * np.sin(2 * np.pi * since / _BAR) * ahead
