"""A beat on the floor and the window of it that is made: where its people are when, and what the network is given."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from motion.placement import Placement

from ..floor import Standing
from ..parts import KnownFrames
from ..sampled import Way2D
from ..window import Window

Array = NDArray[np.floating]
Frames = NDArray[np.integer]


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

    def given(
        self, person: int, frames: Frames | Sequence[int], poses: Array, joints: Sequence[int] = ()
    ) -> KnownFrames:
        """A person's poses (N, 22, 3) in the scene's world at some frames, or some joints of them, as given."""
        return KnownFrames(person, self.in_window(frames), self.placement.to_network(poses), joints)
