"""What the strip under the player draws by default: distances between two people."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from webdemo.metrics import pelvis_distance, wrist_to_wrist
from webdemo.motion import Duet

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
    """Distance in metres between the two roots over the floor plan, and between the nearest two wrists."""
    return [
        Curve("pelvis_distance", "Apart", "m", pelvis_distance(duet)),
        Curve("wrist_distance", "Hands", "m", wrist_to_wrist(duet)),
    ]
