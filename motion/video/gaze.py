"""The direction of a filmed face, from ears and nose: the only points of a head that the pose network finds."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from motion.vectors import FLAT

from .landmarks import INDEX

Array = NDArray[np.floating]

_NOSE, _EARS = INDEX["nose"], [INDEX["left_ear"], INDEX["right_ear"]]
_SEEN = 0.5
"""A nose that is seen less surely than this is turned away."""
_LEAST = 0.03
"""Metres from between the ears to the nose, over the floor, below which a face points nowhere."""


@dataclass(frozen=True, eq=False)
class Gaze:
    """The direction of a face over the floor.

    Attributes:
        ahead: (3,) unit vector in the world of the poses, with no part along Y; zero for a face that is not seen.
        camera: cosine of the angle between it and the way to the camera; -1 for a face that is not seen.
    """

    ahead: Array
    camera: float

    def towards(self, way: Array) -> float:
        """Cosine of the angle between the face and a way (3,) over the floor; 0 where one of them points nowhere."""
        length = float(np.linalg.norm(way * FLAT))
        return float(self.ahead @ way) / length if length > 1e-6 else 0.0


HIDDEN = Gaze(np.zeros(3), -1.0)
"""Of a face that is turned away from the camera."""


def gaze(points: Array, seen: Array, turn: Array) -> Gaze | None:
    """The gaze of one person; None where the points do not tell.

    Args:
        points: (33, 3) metres along the camera's axes, the camera at the origin.
        seen: (33,) how surely they are seen.
        turn: (3, 3) from the camera's axes to the world's.
    """
    if seen[_NOSE] < _SEEN:
        return HIDDEN
    middle = points[_EARS].mean(axis=0)
    ahead = (points[_NOSE] - middle) @ turn.T * FLAT
    length = float(np.linalg.norm(ahead))
    if not length > _LEAST:
        return None
    way = -middle @ turn.T * FLAT
    found = Gaze(ahead / length, 0.0)
    return Gaze(found.ahead, found.towards(way))
