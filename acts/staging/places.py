"""Places and headings of people over the floor, and curves between them.

The floor is seen from above, in metres of the scene's world; headings are radians from +Z towards +X.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.floating]


@dataclass(frozen=True)
class Standing:
    """The places of two people who stand.

    Attributes:
        places: (2, 2) x and z in metres.
        headings: (2,) radians.
        speeds: (2, 2) metres a second.
    """

    places: Array
    headings: Array
    speeds: Array = field(default_factory=lambda: np.zeros((2, 2)))

    def gap(self) -> float:
        """Metres between them."""
        return float(np.linalg.norm(self.places[0] - self.places[1]))

    def towards(self, who: int) -> Array:
        """The direction (2,) from one to the other; ahead, where they stand on one spot."""
        line = self.places[1 - who] - self.places[who]
        length = float(np.linalg.norm(line))
        return line / length if length > 0.05 else direction(float(self.headings[who]))


@dataclass(frozen=True, eq=False)
class Way2D:
    """The places and headings of one person at some frames of a beat.

    Attributes:
        person: 0 for a, 1 for b.
        frames: N frames of the beat, in order.
        places: (N, 2) metres.
        headings: (N,) radians; None where they may look where they like.
    """

    person: int
    frames: Sequence[int]
    places: Array
    headings: Array | None


@dataclass(frozen=True, eq=False)
class Course:
    """A person's places and headings through a beat.

    Attributes:
        places: (T, 2) x and z in metres.
        headings: (T,) radians.
    """

    places: Array
    headings: Array

    @classmethod
    def stays(cls, place: Array, angle: float, frames: int) -> Course:
        """Of a person who stays where they are."""
        return cls(np.tile(np.asarray(place, dtype=float), (frames, 1)), np.full(frames, angle))

    @classmethod
    def of(cls, way: Way2D, angle: float, frames: int) -> Course:
        """Of somebody on a way; where it leaves them free to look, they look as before."""
        time = np.arange(frames)
        places = np.stack([np.interp(time, way.frames, way.places[:, axis]) for axis in (0, 1)], axis=1)
        known = np.array([]) if way.headings is None else np.flatnonzero(np.isfinite(way.headings))
        if way.headings is None or not len(known):
            return cls(places, np.full(frames, angle))
        at = np.asarray(way.frames)[known]
        return cls(places, np.interp(time, at, np.unwrap(way.headings[known])))


def eased(time: Array, share: float) -> Array:
    """Progress 0 to 1 that takes a share of the time to get up its speed, and as much to slow down."""
    share = min(share, 0.5)
    speed = np.clip(np.minimum(time / share, (1 - time) / share + 1e-3), 0.02, 1.0)
    done = np.cumsum(speed)
    return done / done[-1]


def smoothed(line: Array) -> Array:
    """Points on a curve that rounds the corners of a line (Chaikin's, four times)."""
    for _ in range(4):
        first, last = line[:1], line[-1:]
        near, far = 0.75 * line[:-1] + 0.25 * line[1:], 0.25 * line[:-1] + 0.75 * line[1:]
        line = np.concatenate([first, np.stack([near, far], axis=1).reshape(-1, 2), last])
    return line


def filled(values: Array, known: Array, first: float) -> Array:
    """The values with the last known one where they are not known."""
    at = np.maximum.accumulate(np.where(known, np.arange(len(values)), -1))
    return np.where(at >= 0, values[at.clip(0)], first)


def bearing(line: Array) -> float:
    """The heading in radians of a line (2,) over the floor, from +Z towards +X: what :func:`direction` takes."""
    return math.atan2(line[0], line[1])


def direction(heading: float) -> Array:
    """The unit vector (x, z) of a heading in radians from +Z towards +X."""
    return np.array([math.sin(heading), math.cos(heading)])
