"""Bones and feet of a reaction that is made frame by frame: what :mod:`.cleanup` does, without the future."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from motion.cleaning import solve_two_bones
from motion.skeleton import LEGS
from motion.transforms import facing

from .cleanup import on_constant_bones

Array = NDArray[np.floating]

_STANDS, _LEAVES = 0.5, 0.35
"""Contact scores from which a foot stands, and below which it has left the floor."""
_LOW = 0.1
"""Metres: a toe that stands is not higher."""
_FADE = 0.8
"""Factor by which a correction decays each frame after the foot lifts."""
_FARTHEST = 0.12
"""Metres between a foot's place and the network's beyond which the foot steps instead of standing."""


class FollowingCleanup:
    """Constant bones and standing feet for one person, one frame after the other.

    A foot that begins to stand keeps its place, as corrected so far; when it leaves the floor the correction
    fades. No frame depends on a later one.
    """

    def __init__(self) -> None:
        self._shift = np.zeros((2, 3))
        self._place: list[Array | None] = [None, None]

    def __call__(self, frame: Array, contacts: Array) -> Array:
        """The frame as it is shown.

        Args:
            frame: (22, 3) metres as the network gave it, floor at 0.
            contacts: (4,) scores of left ankle, left toe, right ankle, right toe.

        Returns:
            (22, 3) metres.
        """
        result = on_constant_bones(np.asarray(frame, dtype=np.float64)[None])[0]
        forward = facing(result)
        for side, (hip, knee, ankle, toe) in enumerate(LEGS):
            foot = result[toe] - result[ankle]
            shift = self._correction(side, result[toe], float(contacts[2 * side : 2 * side + 2].max()))
            # Neither end of a foot goes below the floor.
            sunk = max(0.0, -(result[toe, 1] + shift[1]), 0.03 - (result[ankle, 1] + shift[1]))
            goal = result[ankle] + shift + np.array([0.0, sunk, 0.0])
            result[knee], result[ankle] = solve_two_bones(result[hip], result[knee], result[ankle], goal, forward)
            result[toe] = result[ankle] + foot
        return result

    def _correction(self, side: int, toe: Array, score: float) -> Array:
        """(3,) what the foot is moved by."""
        place = self._place[side]
        faded = _FADE * self._shift[side]
        if place is None and score > _STANDS and toe[1] < _LOW:
            place = toe + faded
        elif place is not None and (score < _LEAVES or np.linalg.norm(place - toe) > _FARTHEST):
            place = None
        self._place[side] = place
        self._shift[side] = faded if place is None else place - toe
        return self._shift[side]
