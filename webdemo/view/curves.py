"""Default curves of the strip under the player: distances between two people."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from motion import Duet
from motion.metrics import hand_distance, pelvis_distance

Array = NDArray[np.floating]


@dataclass(frozen=True)
class Curve:
    """One value a frame.

    Attributes:
        key: what a program calls it.
        label: what the page calls it.
        unit: behind the value, such as ``"m"``.
        values: (T,).
    """

    key: str
    label: str
    unit: str
    values: Array


def distance_curves(duet: Duet) -> list[Curve]:
    """Distance in metres between the two roots over the floor plan, and between the nearest two hands."""
    return [
        Curve("pelvis_distance", "Apart", "m", pelvis_distance(duet)),
        Curve("hand_distance", "Hands", "m", hand_distance(duet)),
    ]
