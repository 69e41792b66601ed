"""The gestures of the hands: where each has its wrists, and how they move.

The network has rarely seen a gesture together with a way or a posture that is given, and some not at all, so hands are
given, also to people who only stand; :mod:`.arms` has the arm, and how a gesture becomes parts on the time line.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from acts.shapes import Gesture
from motion.vectors import Array

from .poses import JOINT, upright
from .score import SIDES

Place = tuple[float, float, float]


@dataclass(frozen=True, kw_only=True)
class Stroke:
    """The way of a hand of a person who faces +Z. It stays, goes to and fro, or round and round.

    Attributes:
        at: metres to the middle of its way for the left hand: outwards, up and ahead.
        from_shoulder: these are from the shoulder, as the arm is stretched out; otherwise from the pelvis.
        by: metres to either side of the middle, likewise.
        around: the same a quarter of a stroke later, of a hand that goes round.
        rate: strokes a second.
        in_turn: the right hand is half a stroke behind the left one.
        parallel: both hands go the same way; otherwise one is the other's mirror image.
        twice: it goes twice along ``around`` while it goes once along ``by``: a figure of eight.
        pole: outwards, up and ahead: where the elbow is beside the line from shoulder to wrist. By default it hangs.
        both: the gesture is always made by both hands.
        sinks: the hand sinks again before the beat ends; others are held as long as it lasts.
        uneven: the right of two hands is a little higher than the left.
        in_time: two people make it in one time.
        at_other: it is at the other's body.
    """

    at: Place = (0.0, 0.0, 0.0)
    from_shoulder: bool = False
    by: Place = (0.0, 0.0, 0.0)
    around: Place = (0.0, 0.0, 0.0)
    rate: float = 0.0
    in_turn: bool = False
    parallel: bool = False
    twice: bool = False
    pole: Place = (0.4, -1.0, -0.2)
    both: bool = False
    sinks: bool = False
    uneven: bool = False
    in_time: bool = False
    at_other: bool = False

    def way(self, out: float, seconds: Array) -> Array:
        """A wrist's way (N, 3) in metres; ``out`` is 1 for the left hand and -1 for the right."""
        late = np.pi if self.in_turn and out < 0 else 0.0
        phase = 2 * np.pi * self.rate * np.asarray(seconds) - late
        turned = np.sin((2 if self.twice else 1) * phase)
        moved = np.cos(phase)[:, None] * self.by + turned[:, None] * self.around
        mirror = np.array([out, 1.0, 1.0])
        return np.asarray(np.array(self.at) * mirror + moved * (1.0 if self.parallel else mirror))


GESTURES: Mapping[str, Stroke] = {
    # Stretched out
    "high": Stroke(at=(0.1, 0.45, 0.08), from_shoulder=True, pole=(1.0, -0.3, 0.4), both=True, uneven=True),
    "up": Stroke(at=(0.1, 0.32, 0.16), from_shoulder=True, pole=(0.8, -0.8, 0.3), uneven=True),
    "ahead": Stroke(at=(0.02, -0.05, 0.45), from_shoulder=True, both=True, uneven=True),
    "spread": Stroke(at=(0.45, 0.0, 0.06), from_shoulder=True, uneven=True),
    "offers": Stroke(at=(-0.06, -0.2, 0.38), from_shoulder=True, pole=(0.25, -1.0, -0.2)),
    "waves": Stroke(
        at=(0.2, 0.18, 0.16),
        from_shoulder=True,
        around=(0.11, 0.0, 0.0),
        rate=1.2,
        parallel=True,
        pole=(0.5, -1.0, 0.0),
        sinks=True,
        uneven=True,
    ),
    "beckons": Stroke(at=(0.02, -0.06, 0.3), from_shoulder=True, around=(0.0, -0.048, 0.064), rate=1.1, sinks=True),
    "flaps": Stroke(at=(0.4, -0.06, 0.06), from_shoulder=True, around=(0.0, 0.22, 0.0), rate=1.2, in_time=True),
    "circles": Stroke(
        at=(0.14, 0.0, 0.0),
        from_shoulder=True,
        by=(0.0, 0.42, 0.0),
        around=(0.0, 0.0, 0.42),
        rate=1 / 1.3,
        in_time=True,
    ),
    "swings": Stroke(at=(0.06, 0.0, 0.0), from_shoulder=True, rate=1 / 1.4, in_time=True),
    # At the head; the fingertips of a salute are at the temple, the palm at an ear is higher than the wrist
    "salutes": Stroke(at=(0.03, 0.15, 0.15), from_shoulder=True, pole=(1.0, -0.25, 0.0), sinks=True),
    "phone": Stroke(at=(0.2, 0.54, 0.06), pole=(0.6, -1.0, 0.3)),
    "ears": Stroke(at=(0.2, 0.54, 0.06), pole=(0.9, -1.0, 0.2), both=True),
    "eyes": Stroke(at=(0.08, 0.58, 0.18), pole=(0.7, -1.0, 0.1), both=True),
    "photo": Stroke(at=(0.08, 0.58, 0.28), pole=(0.7, -1.0, 0.1), both=True),
    "head": Stroke(at=(0.12, 0.66, -0.05), pole=(1.0, 0.1, 0.3)),
    "mouth": Stroke(at=(0.07, 0.48, 0.17)),
    "fans": Stroke(at=(0.12, 0.42, 0.22), around=(0.1, 0.0, 0.0), rate=2.0, parallel=True),
    "brushes": Stroke(at=(0.08, 0.49, 0.2), by=(0.045, 0.0, 0.0), rate=2.2, pole=(0.8, -0.8, 0.0)),
    "eats": Stroke(at=(0.085, 0.31, 0.24), by=(0.01, -0.15, 0.06), rate=0.5),
    "combs": Stroke(at=(0.14, 0.6, 0.02), by=(0.0, 0.06, -0.05), rate=0.8, pole=(1.0, -0.4, 0.2)),
    # At the trunk
    "hips": Stroke(at=(0.21, 0.1, 0.0), pole=(1.0, 0.0, -0.5)),
    "chest": Stroke(at=(0.02, 0.36, 0.2), pole=(0.6, -1.0, -0.1)),
    "belly": Stroke(at=(0.04, 0.14, 0.2)),
    "behind": Stroke(at=(0.04, 0.02, -0.18), pole=(1.0, -0.2, -0.6)),
    "crossed": Stroke(at=(-0.1, 0.24, 0.17), by=(0.0, -0.05, 0.0), in_turn=True, pole=(0.6, -1.0, 0.0)),
    "beats": Stroke(at=(0.06, 0.37, 0.22), by=(0.0, 0.0, 0.07), rate=1.8, in_turn=True, pole=(1.0, -0.5, 0.0)),
    "bends": Stroke(at=(0.2, 0.42, 0.2), pole=(0.3, -1.0, 0.1)),
    # Before the body
    "claps": Stroke(at=(0.145, 0.28, 0.3), by=(0.07, 0.0, 0.0), rate=2.0, both=True, sinks=True),
    "prays": Stroke(at=(0.04, 0.36, 0.22), pole=(0.7, -1.0, -0.1), both=True),
    "shakes": Stroke(at=(0.28, 0.08, 0.12), around=(0.0, 0.05, 0.0), rate=3.0),
    "works": Stroke(at=(0.1, 0.16, 0.28), by=(0.06, 0.0, 0.0), around=(0.0, 0.0, 0.06), rate=0.9, parallel=True),
    "rubs": Stroke(at=(0.05, 0.24, 0.26), around=(0.0, 0.04, 0.0), rate=1.6, in_turn=True, both=True),
    "drums": Stroke(at=(0.17, 0.2, 0.34), by=(0.0, 0.09, 0.02), rate=2.0, in_turn=True, pole=(0.7, -1.0, -0.2)),
    "types": Stroke(at=(0.1, 0.24, 0.38), by=(0.01, 0.014, 0.0), rate=2.6, in_turn=True),
    "juggles": Stroke(at=(0.17, 0.22, 0.28), by=(0.07, 0.0, 0.0), around=(0.0, 0.11, 0.0), rate=1.3, in_turn=True),
    "dribbles": Stroke(at=(0.23, 0.16, 0.23), by=(0.0, 0.1, 0.0), rate=1.5),
    "conducts": Stroke(
        at=(0.24, 0.46, 0.32), by=(0.14, 0.0, 0.0), around=(0.0, 0.1, 0.02), rate=0.8, twice=True, pole=(0.9, -0.8, 0.0)
    ),
    "pumps": Stroke(at=(0.1, 0.24, 0.32), by=(0.0, 0.09, 0.02), rate=1.5),
    "knocks": Stroke(at=(0.1, 0.46, 0.4), by=(0.0, 0.01, 0.045), rate=2.4),
    "paints": Stroke(at=(0.12, 0.46, 0.4), by=(0.0, 0.2, 0.0), around=(0.05, 0.0, 0.0), rate=0.7),
    "hammers": Stroke(at=(0.13, 0.28, 0.32), by=(0.0, 0.14, -0.03), rate=1.3),
    "writes": Stroke(at=(0.06, 0.2, 0.34), by=(0.05, 0.0, 0.01), around=(0.0, 0.012, 0.0), rate=0.9),
    "carries": Stroke(at=(0.15, 0.14, 0.3)),
    # By where the other or the arm is; see wrist()
    "points": Stroke(at=(0.0, -0.05, 0.0), from_shoulder=True),
    "around": Stroke(at=(0.0, 0.32, -0.12), at_other=True),
    "linked": Stroke(at=(0.22, 0.0, 0.08), at_other=True),
    "lowers": Stroke(),
}
"""The gestures by their names in the lexicon."""
_TOWARDS = {"points": 0.47, "around": 0.4}
"""Metres by which the wrist is nearer to the other: that of an arm that is nearly straight, or around their back."""
_PENDULUM, _SWUNG = 0.44, 0.9
"""Metres from the shoulder to the wrist of an arm that swings, and radians by which it swings to either side."""


def hands_of(gesture: Gesture) -> tuple[str, ...]:
    """The hands that make a gesture, "left", "right" or both."""
    return SIDES if gesture.sides == "both" else (gesture.sides,)


def wrist(name: str, side: str, seconds: Array, towards: Array) -> Array:
    """A wrist's way beside the pelvis of a person who faces +Z.

    Args:
        name: of :data:`GESTURES`.
        side: "left" or "right".
        seconds: (N,) moments.
        towards: (N, 3) unit directions to the other person, as seen by the one who faces +Z.

    Returns:
        (N, 3) metres from the pelvis.
    """
    stands, stroke = upright(np.zeros(2), 0.0), GESTURES[name]
    if name == "lowers":
        return np.tile(stands[JOINT[f"{side}_wrist"]] - stands[0], (len(seconds), 1))
    way = stroke.way(1.0 if side == "left" else -1.0, seconds) + _TOWARDS.get(name, 0.0) * towards
    if name == "swings":
        angle = _SWUNG * np.sin(2 * np.pi * stroke.rate * np.asarray(seconds))
        way += _PENDULUM * np.stack([0.0 * angle, -np.cos(angle), np.sin(angle)], axis=1)
    return way + (stands[JOINT[f"{side}_shoulder"]] - stands[0] if stroke.from_shoulder else 0.0)
