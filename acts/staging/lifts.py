"""Lifts: a person picks the other up, carries them in the arms, takes them on the back or drags them by the feet.

No scene of the training data has anybody off the floor on another person, so the whole body of the person carried is
given, and the carrier's hands.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from acts.shapes import Gesture
from motion import FPS
from motion.steering import STRIDE, Steps
from motion.transforms import heading_matrix
from motion.vectors import FLAT, Array, direction, floor_points

from .gestures import hands_of, wrist
from .places import Course, Way2D, eased
from .poses import ELBOWS, JOINT, LOWER, TRUNK, WRISTS, all_but, upright
from .recordings import carried
from .score import Lift
from .window import OFTEN, KnownFrames, Stretch

RISES = 16
"""Frames that picking a person up takes, and setting them down."""
LONG = 75
"""Frames: after a longer lift the person is set down again before the beat ends, where they are not carried on."""
WAITS = 12
"""Frames for which a person stands before they are picked up, where that is what comes first."""
LADEN = 11
"""Frames of a step by a person who carries the other in their arms or on their back."""
SPIN, SETTLED, EASED = 90, 3, 0.3
"""Frames of a whole turn with somebody in the air, frames in the air before and after it, and the share of the turn in
which it gets up its speed."""
_FAR = 0.45
"""Metres beyond a lift's own distance: from farther away nobody is picked up."""
_STAYS = 0.3
"""Metres within which a person keeps their place before they are picked up."""
_STANDS = 0.003
"""Metres or radians a frame below which a body stands."""
_CARRIER = [*LOWER, *(joint for joint in TRUNK if joint not in LOWER), *WRISTS]


def takes_hold(carry: str) -> float:
    """Metres between the pelvises at which one takes hold of the other."""
    return 1.0 if carry == "drags" else 0.45


def stepping(course: Course, stride: int, first: int, last: int) -> Array:
    """Poses (N, 22, 3) from the first frame to before the last of somebody on a course, one foot after the other.

    Args:
        course: of the person.
        stride: frames of a step.
        first, last: frames of the course.
    """
    steps = Steps(stride)
    speed, turned = floor_points(np.gradient(course.places, axis=0)), np.gradient(course.headings)
    poses = []
    for t in range(first, last):
        pose = upright(course.places[t], float(course.headings[t]))
        pose -= pose[0] * FLAT - floor_points(course.places[t])
        moving = bool(np.linalg.norm(speed[t]) > _STANDS or abs(turned[t]) > _STANDS)
        poses.append(steps(pose, moving=moving, ahead=stride / 2 * speed[t]))
    return np.stack(poses)


@dataclass(frozen=True)
class Carrying:
    """A lift in its beat.

    Attributes:
        lift: as the words name it.
        stretch: the beat, with the ways of both people.
        gesture: of the person carried, whose hands then do not hold on.
    """

    lift: Lift
    stretch: Stretch
    gesture: Gesture | None = None

    @property
    def carrier(self) -> int:
        """0 or 1."""
        return "ab".index(self.lift.carrier)

    @property
    def off(self) -> tuple[int, int]:
        """The first frame of the beat at which the feet are off the floor, and the one after the last."""
        frames, first = self.stretch.frames, 0
        if self.stretch.start or self.lift.comes or self.lift.carry == "up":
            own, other = (self.stretch.course(person) for person in (0, 1))
            apart = np.linalg.norm(own.places - other.places, axis=1)
            near = self._meets(apart)
            waits = 0 if self.stretch.start else max(WAITS - near, 0)
            first = min(near + waits + RISES if apart[near] < takes_hold(self.lift.carry) + _FAR else frames, frames)
        down = (self.lift.carry == "up" or self.lift.down) and frames - first > LONG
        return first, frames - (3 if self.lift.down else 2) * RISES if down else frames

    def _meets(self, apart: Array) -> int:
        """The frame from which two who are so far apart (T,) are near enough."""
        return int(np.flatnonzero(apart < max(takes_hold(self.lift.carry), float(apart.min())) + 0.05)[0])

    @cached_property
    def course(self) -> Course:
        """The carrier's course; where the two turn round, it is once one is in the air, as fast as people turn so."""
        course = self.stretch.course(self.carrier)
        if not self.lift.spins:
            return course
        other = self.stretch.course(1 - self.carrier)
        met = self._meets(np.linalg.norm(course.places - other.places, axis=1))
        first, last = (edge + shift for edge, shift in zip(self.off, (SETTLED, -SETTLED), strict=True))
        turn = course.headings[-1] - course.headings[met]
        takes = min(max(last - first, 1), round(abs(turn) / (2 * np.pi) * SPIN))
        done = eased(np.arange(1, takes + 1) / takes, EASED)
        share = np.interp(np.arange(len(course.headings)), np.arange(takes) + first, done, left=0.0)
        headings = np.where(np.arange(len(share)) < met, course.headings, course.headings[met] + share * turn)
        return replace(course, headings=headings)

    @property
    def _waits(self) -> bool:
        """True where a story begins with somebody on their feet who is picked up where they stand."""
        places = self.stretch.course(1 - self.carrier).places[: max(self.off[0] - RISES, 1)]
        return not self.stretch.start and float(np.ptp(places, axis=0).max()) < _STAYS

    def before(self) -> dict[int, Way2D]:
        """The ways until shortly before the feet leave the floor; from then on, poses say where people are."""
        ways, until = {}, self.off[0] - RISES // 2
        for person, way in self.stretch.ways.items():
            kept = np.asarray(way.frames) < (until if person != self.carrier else self.off[0])
            if person != self.carrier and self._waits:
                kept &= np.asarray(way.frames) > 0  # where they begin on their feet
            if kept.any():
                own = ways[person] = way.only(kept)
                if person == self.carrier and own.headings is not None:
                    turned = np.where(np.isfinite(own.headings), self.course.headings[list(own.frames)], own.headings)
                    ways[person] = replace(own, headings=turned)
        return ways

    def parts(self) -> list[KnownFrames]:
        """The body of the person carried, and the carrier's pelvis, trunk and hands."""
        course, parts = self.course, []
        first, last = self.off
        held = [*range(first, last, OFTEN), *range(max(first, last - 1), last)]  # none in a beat that is too short
        at = self.stretch.shown(np.unique(np.array(held, dtype=int)))
        if len(at):
            walking = stepping(course, STRIDE if self.lift.spins else LADEN, *self.off)[at - first]
            theirs, own = carried(self.lift.carry, course.places[at], course.headings[at])
            sinks = walking[:, :1] - own[:, :1]
            own += sinks
            theirs += 0.0 if self.lift.carry == "drags" else sinks
            own[:, LOWER] = walking[:, LOWER]
            self._gesture(theirs, at, course)
            elbows = ELBOWS if self.lift.carry == "arms" else ()
            parts.append(self.stretch.known(1 - self.carrier, at, theirs, [*all_but(ELBOWS), *elbows]))
            parts.append(self.stretch.known(self.carrier, at, own, [*_CARRIER, *elbows]))
        feet = [(frame, pose) for frame, pose in self._on_feet() if self.stretch.shows(frame)]
        if feet:
            frames, poses = zip(*feet, strict=True)
            parts.append(self.stretch.known(1 - self.carrier, frames, np.stack(poses), LOWER))
        return parts

    def _gesture(self, theirs: Array, at: NDArray[np.integer], course: Course) -> None:
        """Has the hands of the person carried, whose poses (N, 22, 3) are theirs, make their gesture."""
        if self.gesture is None or self.lift.carry != "up":
            return
        turns = heading_matrix(course.headings[at] + np.pi)
        ahead = np.tile([0.0, 0.0, 1.0], (len(at), 1))
        for side in hands_of(self.gesture):
            places = wrist(self.gesture.gesture, side, at / FPS, ahead)
            theirs[:, JOINT[f"{side}_wrist"]] = theirs[:, 0] + np.einsum("nij,nj->ni", turns, places)

    def _on_feet(self) -> Iterator[tuple[int, Array]]:
        """Frames before and after the lift, and poses (22, 3) of the person carried then."""
        first, last = self.off
        other, frames, stand = 1 - self.carrier, self.stretch.frames, self.stretch.stand
        if first and self._waits:
            for frame in range(0, max(first - RISES, 1), OFTEN if first < LONG else LONG):
                yield frame, upright(stand.places[other], float(stand.headings[other]))
        if last < frames:
            own = self.course
            angle, back = float(own.headings[-1]), self.lift.carry == "back"  # from which somebody slides down behind
            place = own.places[-1] + takes_hold(self.lift.carry) * direction(angle + np.pi * back)
            for frame in range(frames - RISES, frames, OFTEN):
                yield frame, upright(place, angle if back else angle + np.pi)
