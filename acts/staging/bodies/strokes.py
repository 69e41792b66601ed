"""Strokes: hands that do one thing over and over, as on a drum, at a keyboard or with a ball that bounces."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.floating]
Place = tuple[float, float, float]


@dataclass(frozen=True)
class Stroke:
    """A hand that goes to and fro, or round and round, beside the pelvis of a person who faces +Z.

    Attributes:
        at: metres to the middle of its way for the left hand: outwards, up and ahead.
        by: metres to either side of the middle, likewise.
        around: the same a quarter of a stroke later, of a hand that goes round.
        rate: strokes a second.
        in_turn: the right hand is half a stroke behind the left one.
        twice: it goes twice along ``around`` while it goes once along ``by``: a figure of eight.
    """

    at: Place
    by: Place = (0.0, 0.0, 0.0)
    around: Place = (0.0, 0.0, 0.0)
    rate: float = 1.0
    in_turn: bool = False
    twice: bool = False

    def way(self, out: float, seconds: Array) -> Array:
        """A wrist's way (N, 3) in metres beside the pelvis; ``out`` is 1 for the left hand and -1 for the right."""
        late = np.pi if self.in_turn and out < 0 else 0.0
        phase = 2 * np.pi * self.rate * np.asarray(seconds) - late
        turned = np.sin((2 if self.twice else 1) * phase)
        way = np.array(self.at) + np.cos(phase)[:, None] * self.by + turned[:, None] * self.around
        return np.asarray(way * [out, 1.0, 1.0])


STROKES: Mapping[str, Stroke] = {
    "drums": Stroke((0.17, 0.2, 0.34), by=(0.0, 0.09, 0.02), rate=2.0, in_turn=True),
    "types": Stroke((0.1, 0.24, 0.38), by=(0.01, 0.014, 0.0), rate=2.6, in_turn=True),
    "juggles": Stroke((0.17, 0.22, 0.28), by=(0.07, 0.0, 0.0), around=(0.0, 0.11, 0.0), rate=1.3, in_turn=True),
    "dribbles": Stroke((0.23, 0.16, 0.23), by=(0.0, 0.1, 0.0), rate=1.5),
    "conducts": Stroke((0.24, 0.46, 0.32), by=(0.14, 0.0, 0.0), around=(0.0, 0.1, 0.02), rate=0.8, twice=True),
    "pumps": Stroke((0.1, 0.24, 0.32), by=(0.0, 0.09, 0.02), rate=1.5),
    "knocks": Stroke((0.1, 0.46, 0.4), by=(0.0, 0.01, 0.045), rate=2.4),
    "paints": Stroke((0.12, 0.46, 0.4), by=(0.0, 0.2, 0.0), around=(0.05, 0.0, 0.0), rate=0.7),
    "brushes": Stroke((0.08, 0.49, 0.2), by=(0.045, 0.0, 0.0), rate=2.2),
    "hammers": Stroke((0.13, 0.28, 0.32), by=(0.0, 0.14, -0.03), rate=1.3),
    "eats": Stroke((0.085, 0.31, 0.24), by=(0.01, -0.15, 0.06), rate=0.5),
    "combs": Stroke((0.14, 0.6, 0.02), by=(0.0, 0.06, -0.05), rate=0.8),
    "writes": Stroke((0.06, 0.2, 0.34), by=(0.05, 0.0, 0.01), around=(0.0, 0.012, 0.0), rate=0.9),
    "beats": Stroke((0.06, 0.37, 0.22), by=(0.0, 0.0, 0.07), rate=1.8, in_turn=True),
    "bends": Stroke((0.2, 0.42, 0.2)),
    "carries": Stroke((0.15, 0.14, 0.3)),
}
"""By the names of gestures in the lexicon."""
