"""A window: frames of a scene that are made in one run of the network, and the parts that it is given of them.

Parts are in the network's frame: metres, Y up, the floor at 0, 30 frames a second. No torch here.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from motion.transforms import Placement
from motion.vectors import Array, floor_points

from .places import HALT, Course, Standing, Way2D
from .poses import upright

Frames = NDArray[np.integer]

PAST = 48
"""Frames of the motion before a window that it sees (1.6 s)."""
AFTER = 36
"""Frames of the motion after a window that it sees, where there is one already."""
MOST_FRAMES = 300
"""Frames of a window with what it sees: the longest motion that the networks were trained on."""
TAIL = 8
"""Frames that are made behind a window and thrown away where another follows: the network is least sure of the last
ones, and its feet are fast there."""
OFTEN = 3
"""Frames between two poses of a body that moves: closer than the network's knots, of which others would waver."""
SETTLES, GETS_DOWN, REACHES = 24, 40, 12
"""Frames in which somebody changes to another stance, gets down or up, and brings a hand to what it holds."""
LATE = 0.4
"""Seconds by which somebody begins later than they could, at most."""
SHORT = 120
"""Frames of a beat in which they begin sooner."""


@dataclass(frozen=True, eq=False)
class KnownFrames:
    """The motion of a person at some frames, held exactly, or a draft of it.

    Attributes:
        person: 0 for a, 1 for b.
        frames: N different frames of the scene, in order.
        positions: (N, 22, 3) metres.
        joints: those that are given; () for all. All but the pelvis are given relative to it. Where only some are
            given, the network is held to them, and the finished motion comes close to them.
        kept: the finished motion has these joints as they are given: a foot that stamps is not planted again.
        soft: a network that reads drafts is shown these joints and how high the pelvis is, and held to the places.
        free: the same, and no network is ever held to the poses, however strict the plan is.
    """

    person: int
    frames: Sequence[int]
    positions: Array
    joints: Sequence[int] = ()
    kept: bool = False
    soft: bool = False
    free: bool = False


@dataclass(frozen=True, eq=False)
class KnownPath:
    """A person's places at some frames, and optionally their headings.

    Attributes:
        person: 0 for a, 1 for b.
        frames: N different frames of the scene, in order; between them the way is free.
        places: (N, 2) x and z of the pelvis in metres.
        headings: (N,) radians from +Z towards +X. The network is shown them; they are not held.
        turned: the headings are held, too, by the places of the hips.
    """

    person: int
    frames: Sequence[int]
    places: Array
    headings: Array | None = None
    turned: bool = False


Part = KnownFrames | KnownPath


@dataclass(frozen=True)
class Window:
    """Frames that are made in one run of the network.

    Attributes:
        beat: index of the beat.
        part: its number within the beat, from 0.
        start, stop: frames of the scene that it makes.
        after: frames behind it that are known.
    """

    beat: int
    part: int
    start: int
    stop: int
    after: int = 0

    @property
    def past(self) -> int:
        """Frames before it that it sees."""
        return min(PAST, self.start)

    def tail(self, last: int) -> int:
        """Frames that are made behind it and thrown away, in a scene whose last part ends before frame ``last``."""
        if self.after or self.stop == last:
            return 0
        return min(TAIL, MOST_FRAMES - self.past - (self.stop - self.start))


@dataclass(frozen=True, eq=False)
class Stretch:
    """The frames of a beat, of which a window shows some; frames are counted from the beginning of the beat.

    Attributes:
        window: the window that is made.
        placement: from the scene's world to the network's frame.
        stand: where the people are when the beat begins.
        start, stop: the beat's first frame in the scene and the one after its last.
        ways: of people who go somewhere, by person.
    """

    window: Window
    placement: Placement
    stand: Standing
    start: int
    stop: int
    ways: Mapping[int, Way2D] = field(default_factory=dict)

    @property
    def frames(self) -> int:
        """The length of the beat."""
        return self.stop - self.start

    def course(self, person: int) -> Course:
        """The course of a person, 0 or 1; of somebody without a way, that of one who stays."""
        angle = float(self.stand.headings[person])
        if person in self.ways:
            return Course.of(self.ways[person], angle, self.frames)
        return Course.stays(self.stand.places[person], angle, self.frames)

    def halt(self, person: int) -> Array:
        """The place (x, z) at which a person comes to a halt."""
        return np.asarray(self.stand.places[person] + (HALT * self.stand.speeds[person] if self.start else 0.0))

    def shows(self, frame: int) -> bool:
        """True for a frame that falls into the window."""
        return self.window.start <= frame + self.start < self.window.stop

    def shown(self, frames: Frames) -> Frames:
        """Those of some frames (N,) that fall into the window."""
        return frames[(frames + self.start >= self.window.start) & (frames + self.start < self.window.stop)]

    def every(self, spacing: int, first: int = 0) -> Frames:
        """Frames of the beat in the window: so many apart, and the last one, from which the next beat goes on."""
        return self.shown(np.union1d(np.arange(first, self.frames, spacing), [self.frames - 1]))

    def in_window(self, frames: Frames | Sequence[int]) -> list[int]:
        """Frames as the window counts them."""
        return (np.asarray(frames) + self.start - self.window.start + self.window.past).tolist()

    def known(
        self, person: int, at: Frames | Sequence[int], poses: Array, joints: Sequence[int] = (), *, kept: bool = False
    ) -> KnownFrames:
        """A person's poses (N, 22, 3) in the scene's world at some frames, or some joints of them, as a part."""
        return KnownFrames(person, self.in_window(at), self.placement.to_network(poses), joints, kept)

    def draft(self, person: int, at: Frames, poses: Array, joints: Sequence[int] = ()) -> KnownFrames:
        """The same as a draft to which no network is held."""
        return replace(self.known(person, at, poses, joints), soft=True, free=True)

    def still(self, person: int, at: Frames, joints: Sequence[int]) -> KnownFrames:
        """Some joints of a person who stands upright on their course at frames (N,), as a part."""
        course = self.course(person)
        return self.known(person, at, upright(course.places[at], course.headings[at]), joints)

    def known_way(self, way: Way2D) -> list[Part]:
        """What falls into the window of a way."""
        frames = np.asarray(way.frames)
        inside = np.isin(frames, self.shown(frames))
        headings = np.full(len(frames), np.nan) if way.headings is None else way.headings
        at = np.asarray(self.in_window(frames[inside]), dtype=int)
        return known_paths(way.person, at, way.places[inside], headings[inside], self.placement)


def known_paths(
    person: int, frames: NDArray[np.integer], places: Array, headings: Array, placement: Placement
) -> list[Part]:
    """A way over the floor of the scene's world, as the network is given it.

    Args:
        person: 0 for a, 1 for b.
        frames: (N,) frames of the window, in order.
        places: (N, 2) x and z in metres.
        headings: (N,) radians from +Z towards +X; NaN where a person may face anywhere.
        placement: from the scene's world to the network's frame.
    """
    base = math.atan2(placement.turn[2, 0], placement.turn[0, 0])
    moved = placement.to_network(floor_points(places))[:, [0, 2]]
    known = np.isfinite(headings)
    return [
        KnownPath(person, frames[own].tolist(), moved[own], headings[own] - base if turned else None, turned)
        for turned, own in ((True, known), (False, ~known))
        if own.any()
    ]


def late_by(seed: int, person: int, frames: int) -> float:
    """Seconds by which a person begins later than they could: two people who wave do not wave as one."""
    later, *wait = np.random.default_rng(seed).uniform(0.0, 1.0, 3)
    drawn = 0.5 * float(wait[person]) + (0.5 if (later < 0.5) is (person == 0) else 0.0)
    return LATE * drawn * min(1.0, frames / SHORT)
