"""Places and headings of people over the floor, curves between them, and the track of one person through a beat.

The floor is seen from above, in metres of the scene's world; headings are radians from +Z towards +X.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from motion import FPS
from motion.vectors import Array, bearing, direction, travelled, wrapped


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

    def only(self, kept: NDArray[np.bool_]) -> Way2D:
        """The same at those of its frames (N,) that are kept."""
        headings = None if self.headings is None else self.headings[kept]
        return Way2D(self.person, np.asarray(self.frames)[kept].tolist(), self.places[kept], headings)


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
        places = between(way.places, way.frames, time)
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


def between(line: Array, known: Array | Sequence[int], at: Array | NDArray[np.integer]) -> Array:
    """The points (M, 2) of a line (N, 2), whose points are at ``known`` (N,) frames or metres, at others (M,)."""
    return np.stack([np.interp(at, known, line[:, axis]) for axis in (0, 1)], axis=1)


def smoothed(line: Array) -> Array:
    """Points on a curve that rounds the corners of a line (Chaikin's, four times)."""
    for _ in range(4):
        first, last = line[:1], line[-1:]
        near, far = 0.75 * line[:-1] + 0.25 * line[1:], 0.25 * line[:-1] + 0.75 * line[1:]
        line = np.concatenate([first, np.stack([near, far], axis=1).reshape(-1, 2), last])
    return line


def clear_of(line: Array, spot: Array) -> Array:
    """A line (N, 2) that goes round a thing at a spot (2,) where it would lead through it."""
    along = travelled(line)
    dense = between(line, along, np.linspace(0.0, along[-1], max(int(along[-1] / 0.05), 2)))
    out = dense - spot
    far = np.linalg.norm(out, axis=1)
    near = np.flatnonzero(far < ROUND)
    if not len(near) or far.min() > min(far[0], far[-1], ROUND) - 0.05:
        return line
    first, last = int(near[0]), int(near[-1])
    start = bearing(out[first])
    share = np.linspace(0.0, 1.0, 24)
    ends = far[first] + share * (far[last] - far[first])
    radii = ends + (ROUND - ends) * np.sin(np.pi * share) ** 0.5
    arc = spot + radii[:, None] * direction(start + share * wrapped(bearing(out[last]) - start))
    return np.concatenate([dense[:first], arc, dense[last + 1 :]])


def filled(values: Array, known: Array, first: float) -> Array:
    """The values with the last known one where they are not known."""
    at = np.maximum.accumulate(np.where(known, np.arange(len(values)), -1))
    return np.where(at >= 0, values[at.clip(0)], first)


# ---- tracks: the way of one person over the floor of a beat, laid out move by move --------------------
ROUND = 0.6
"""Metres from the middle of a seat or a table at which people go round it."""
AT_TABLE = 0.82
"""Metres from the pelvis to the middle of a table at which somebody sits."""
ABEAM = 0.3
"""Cosine of the angle between where somebody faces and where the other is, below which the other is not before them."""
HALT = 0.3
"""Seconds of its speed that a walk takes to stop."""
MOST = 3.2
"""Metres a second of the fastest run that is planned."""
TURNING = 0.9
"""Seconds of a half turn."""
EVENLY = 4
"""Frames between two given places or poses: at every knot of the network, which otherwise surges or wavers."""
EASE = 0.5
"""Seconds in which a walk gets up its speed, and slows down again."""
EVERY = 30
"""Frames between two given places of a person who stays."""
STEP = math.pi / 3
"""Radians of a turn between two given headings."""


@dataclass
class Track:
    """The planned way of one person, frame by frame.

    Attributes:
        place: (2,) x and z in metres where they are at ``frame``.
        heading: radians that they face there.
        places: (T, 2) metres, of the whole beat; NaN where they are free.
        headings: (T,) radians; NaN where they may face anywhere.
        frame: the first frame that is not laid out yet.
        going: (2,) unit direction of a walk side by side that they are on; zero if there was none.
        dense: frames of walks whose places are given.
        seats: places (2,) of seats and tables, round which walks lead.
    """

    place: Array
    heading: float
    places: Array
    headings: Array
    frame: int = 0
    going: Array = field(default_factory=lambda: np.zeros(2))
    dense: set[int] = field(default_factory=set)
    seats: Sequence[Array] = ()

    def walk(self, line: Array, seconds: float, *, heading: float | None = None) -> None:
        """Walks along points (N, 2) within some seconds; faces where it goes, or where ``heading`` says."""
        for seat in self.seats:
            line = clear_of(line, seat)
        frames = max(1, min(round(seconds * FPS), len(self.places) - self.frame))
        along = travelled(line)
        time = np.arange(1, frames + 1) / frames
        done = eased(time, EASE / max(seconds, 1e-6))
        share = min(EASE / max(seconds, 1e-6), 0.5)
        far = min(along[-1], MOST * frames / FPS * min(1.5 * (1 - share), 1.0))
        self.follow(between(line, along, done * far), heading, still=1e-4)

    def follow(self, places: Array, heading: Array | float | None = None, *, still: float = 2e-3) -> None:
        """Goes through places (N, 2), one a frame, and faces headings or where it goes, by more than ``still``."""
        stop = self.frame + len(places)
        steps = np.diff(np.concatenate([self.place[None], places]), axis=0)
        facing = filled(np.arctan2(steps[:, 0], steps[:, 1]), np.linalg.norm(steps, axis=1) > still, self.heading)
        if heading is not None:
            facing = np.unwrap(np.broadcast_to(self.heading + wrapped(np.asarray(heading) - self.heading), len(places)))
        self.places[self.frame : stop] = places
        self.dense.update(range(self.frame + EVENLY, stop, EVENLY))
        self.headings[self.frame : stop] = self._turned_into(np.unwrap(facing)) if heading is None else facing
        self.place, self.heading, self.frame = places[-1], float(self.headings[stop - 1]), stop

    def at(self, frame: int, start: Array) -> Array:
        """The place (2,) that is planned for a frame or was before it; ``start`` before any plan."""
        known = np.flatnonzero(np.isfinite(self.places[: frame + 1, 0]))
        return self.places[known[-1]].copy() if len(known) else np.array(start, dtype=float)

    def faces(self, frame: int, start: float) -> float:
        """The heading that is planned for a frame or was before it; ``start`` before any plan."""
        known = np.flatnonzero(np.isfinite(self.headings[: frame + 1]))
        return float(self.headings[known[-1]]) if len(known) else float(start)

    def _turned_into(self, facing: Array) -> Array:
        """Headings that begin at the person's own and are turned at a body's pace."""
        headings, now, most = np.empty(len(facing)), self.heading, math.pi / TURNING / FPS
        for i, wanted in enumerate(facing):
            now += float(np.clip(wrapped(wanted - now), -most, most))
            headings[i] = now
        return headings

    def turn(self, angle: float) -> None:
        """Turns on the spot by so many radians."""
        frames = max(1, min(round(abs(angle) / math.pi * TURNING * FPS), len(self.places) - self.frame))
        stop = self.frame + frames
        self.places[self.frame : stop] = self.place
        self.headings[self.frame : stop] = self.heading + angle * eased(np.arange(1, frames + 1) / frames, 0.4)
        self.heading, self.frame = self.heading + angle, stop

    def watch(self, other: Track) -> None:
        """Stays to the end of the beat, and turns to where the other goes."""
        line = other.places[self.frame :] - self.place
        bearings = np.arctan2(line[:, 0], line[:, 1])
        bearings = filled(bearings, np.isfinite(bearings), self.heading)
        self.headings[self.frame :] = self._turned_into(np.unwrap(bearings))
        self.places[self.frame :] = self.place
        self.heading, self.frame = float(self.headings[-1]), len(self.places)

    def stay(self, seconds: float | None = None, *, facing: bool = False) -> None:
        """Stays for some seconds, or to the end of the beat."""
        stop = len(self.places) if seconds is None else min(len(self.places), self.frame + round(seconds * FPS))
        self.places[self.frame : stop] = self.place
        if facing:
            self.headings[self.frame : stop] = self.heading
        self.frame = max(stop, self.frame)

    def halt(self, speed: Array) -> None:
        """Takes a step to stop, for a person who was walking at a speed (2,) when the beat began."""
        if not self.frame and np.linalg.norm(speed) > 0.3:
            self.frame = min(round(2 * HALT * FPS), len(self.places) - 1)
            self.place = self.place + HALT * speed

    def left(self) -> float:
        """Seconds until the beat ends."""
        return (len(self.places) - self.frame) / FPS


def sampled(who: int, track: Track, *, first: bool) -> Way2D | None:
    """The way at :data:`EVERY` frames, dense ones and the last that is planned; with ``first``, where it begins."""
    known = np.flatnonzero(np.isfinite(track.places[:, 0]))
    if not len(known):
        return None
    wanted = {
        *known[known % EVERY == EVERY - 1].tolist(),
        *(track.dense & set(known.tolist())),
        int(known[-1]),
        *([0] if first else []),
    }
    frames = [f for f in _with_turns(sorted(wanted), track.headings) if np.isfinite(track.places[f, 0])]
    headings = track.headings[frames]
    facing = np.isfinite(headings)
    return Way2D(who, frames, track.places[frames], np.where(facing, headings, np.nan) if facing.any() else None)


def _with_turns(frames: Sequence[int], headings: Array) -> list[int]:
    """The frames, with more of them where somebody turns: a network that is free there turns them within a few."""
    keys = list(frames)
    for first, last in itertools.pairwise([0, *frames]):
        turned = abs(headings[last] - headings[first])
        if turned > STEP:  # false where either heading is free
            gone = np.abs(headings[first : last + 1] - headings[first])
            each = turned / math.ceil(turned / STEP)
            keys += [first + int(np.argmax(gone >= share)) for share in np.arange(each, turned - 0.01, each)]
    return sorted(set(keys))
