"""Two performers, each with a timeline, on one stage, the beats they have played, and the finished scene."""

from __future__ import annotations

import copy
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from motion import FPS
from motion.transforms import canonicalize
from motion.vectors import bearing, wrapped

from ..compose import Array, Motion, blend_for, ease, facing_at, join, look_at, looped, place, realise, steer
from ..cues import STILL, Beat
from ..library import Library, Take, stride
from ..touches import Rng, Touches

Stand = tuple[tuple[float, float], float]
"""x and z in metres, and a heading in radians."""
SHUFFLE = 0.45
"""Metres up to which a person shifts by small steps on the spot instead of walking."""


@dataclass(frozen=True)
class Done:
    """A performed act.

    Attributes:
        start, stop: its frames on the person's timeline.
        side: the hand or foot that leads.
        style: the actor's manner.
    """

    start: int
    stop: int
    side: str | None = None
    style: str = "normal"


class Performer:
    """One person on the stage.

    Args:
        rng: where choices come from.
        library: the recordings.
        stand: where the person stands at first.
        style: the manner of walking, or None for any.

    Attributes:
        motion: all that was done so far.
    """

    def __init__(self, rng: Rng, library: Library, stand: Stand, style: str | None) -> None:
        self.rng, self.library, self.style = rng, library, style
        self._rest = library.idle(rng, 420)
        self._used = 4
        self._calm = True
        self.motion = place(self._rest[:4], *stand[0], stand[1])

    def __len__(self) -> int:
        return len(self.motion)

    @property
    def spot(self) -> Array:
        """(2,) x and z of the root at the last frame."""
        return self.motion.root[-1, [0, 2]]

    @property
    def angle(self) -> float:
        """Heading at the last frame, radians."""
        return facing_at(self.motion, len(self.motion) - 1)

    def _resting(self, frames: int) -> Motion:
        """The next ``frames`` frames of the person's own way of standing."""
        if self._used + frames > len(self._rest):
            self._used = 0
        self._rest = looped(self._rest, self._rest, frames, blend=20)
        part = self._rest[self._used : self._used + frames]
        self._used += frames
        return part

    def append(self, motion: Motion, *, turn: float = 0.0, blend: int | None = None) -> int:
        """Goes on with ``motion``; returns the frame at which it begins."""
        blend = min(blend or blend_for(self.motion, motion), len(motion) // 2, len(self.motion))
        self._calm = False
        start = len(self.motion) - blend
        self.motion = join(self.motion, motion, blend=blend, turn=turn)
        return max(start, 0)

    def hold(self, frames: int, *, turn: float = 0.0, shift: Array | None = None) -> None:
        """Stands for ``frames`` frames, turning by ``turn`` radians and moving by ``shift`` (x, z) metres."""
        if frames <= 0:
            return
        blend = min(10 if self._calm else blend_for(self.motion, self._rest), len(self.motion))
        piece = self._resting(frames + blend)
        course = np.concatenate([np.zeros(blend // 2), ease(frames), np.ones(blend - blend // 2)])
        if turn:
            piece = steer(piece, turn * course)
        before = len(self.motion)
        self.append(piece, blend=blend)
        self._calm = True
        if shift is not None:
            grown = np.append(np.zeros(before), ease(len(self.motion) - before))
            way = np.array([shift[0], 0.0, shift[1]])
            self.motion = replace(self.motion, root=self.motion.root + grown[:, None] * way)

    def hold_until(self, frame: int) -> None:
        """Stands until the timeline has ``frame`` frames."""
        self.hold(frame - len(self.motion))

    def turn(self, angle: float) -> None:
        """Turns on the spot by ``angle`` radians."""
        if abs(angle) > 0.05:
            self.hold(int(12 + 13 * abs(angle)), turn=angle)

    def go(self, target: Array, angle: float | None = None, *, action: str = "walk", stop: bool = True) -> Take:
        """Walks to ``target`` (x, z), turning on the way and, with ``angle``, to that heading at its end.

        Returns:
            the walk as it was drawn.
        """
        gap = target - self.spot
        distance = float(np.linalg.norm(gap))
        if distance < SHUFFLE:
            turn = 0.0 if angle is None else wrapped(angle - self.angle)
            self.hold(int(16 + 30 * distance + 12 * abs(turn)), turn=turn, shift=gap)
            return Take(self.motion[-1:], action, "normal")
        take, course = self._walk(gap, angle, action)
        self.append(course)
        if stop:
            self.hold(int(self.rng.integers(8, 16)))
            if angle is not None and abs(left := wrapped(angle - self.angle)) > 0.12:
                self.hold(int(10 + 14 * abs(left)), turn=left)
        return take

    def _walk(self, gap: Array, angle: float | None, action: str) -> tuple[Take, Motion]:
        """A walk that ends ``gap`` from here: turned, bent and scaled a little until it does."""
        distance = float(np.linalg.norm(gap))
        takes = [stride(self.rng, self.library, action, distance, style=self.style) for _ in range(3)]
        ways = [drawn.motion.root[-1] - drawn.motion.root[0] for drawn in takes]
        ratios = [distance / max(float(np.linalg.norm(way[[0, 2]])), 1e-3) for way in ways]
        ratio, take = min(zip(ratios, takes, strict=True), key=lambda one: abs(np.log(one[0])))
        walk = place(take.motion, 0.0, 0.0, self.angle)
        frames = len(walk)
        first = wrapped(bearing(gap) - self.angle)
        turning = int(np.clip(14 + 12 * abs(first), 14, frames * 0.7))
        rise = np.concatenate([ease(turning), np.ones(frames - turning)])
        slow = np.ones(frames)
        if abs(first) > 0.9:  # who turns far hardly gets on meanwhile
            slow[:turning] = 0.3 + 0.7 * ease(turning) ** 2
        fall = np.zeros(frames)
        last = 0.0
        if angle is not None:
            ending = min(18, frames // 2)
            fall[frames - ending :] = ease(ending)
            last = float(np.clip(wrapped(angle - bearing(gap)), -0.7, 0.7))
        gain, bend = float(np.clip(ratio, 0.7, 1.4)), first
        for _ in range(6):
            course = steer(walk, bend * rise + last * fall, slow * gain)
            end = (course.root[-1] - course.root[0])[[0, 2]]
            bend += wrapped(bearing(gap) - bearing(end))
            gain = float(np.clip(gain * distance / max(np.linalg.norm(end), 1e-3), 0.6, 1.5))
        return take, course

    def perform(self, take: Take, *, aim: float = 0.0) -> Done:
        """Does what was drawn; ``aim`` turns it away from the person's front."""
        return Done(self.append(take.motion, turn=-aim), len(self.motion), take.side, take.style)


# ---- two performers on one stage ---------------------------------------------------------------------


Effect = Callable[[Rng, Array, Array], tuple[Array, Array, Touches]]
"""A change of the positions of a person and the other (T, 22, 3), and where they touch then."""


class Play:
    """A scene in the making.

    Args:
        stands, styles: of a and b at first, and their manners of walking.
    """

    def __init__(
        self, rng: Rng, library: Library, stands: Sequence[Stand], styles: Sequence[str | None] = (None, None)
    ) -> None:
        self.rng, self.library = rng, library
        self.people = tuple(Performer(rng, library, *own) for own in zip(stands, styles, strict=True))
        self.beats: list[Beat] = []
        self.effects: list[tuple[Effect, Rng, slice, int]] = []
        self.looks: list[tuple[int, int, int, float]] = []
        self.brisk = False

    # ---- where they are ---------------------------------------------------------------------------------
    @property
    def frames(self) -> int:
        """Length so far in frames."""
        return max(map(len, self.people))

    @property
    def gap(self) -> float:
        """Metres between the two over the ground."""
        return float(np.linalg.norm(self.people[0].spot - self.people[1].spot))

    def off(self, i: int) -> float:
        """Radians by which person ``i`` is turned away from the other."""
        own, other = self.people[i], self.people[1 - i]
        return wrapped(bearing(other.spot - own.spot) - own.angle)

    def seconds(self, low: float, high: float) -> int:
        """A random duration in frames; three quarters of it where many beats must fit into the scene."""
        return int(self.rng.uniform(low, high) * FPS * (0.75 if self.brisk else 1.0))

    # ---- time -------------------------------------------------------------------------------------------
    def sync(self) -> int:
        """The shorter timeline waits for the longer; the common length."""
        for person in self.people:
            person.hold_until(self.frames)
        return self.frames

    def begin(self, i: int) -> tuple[int, Performer, Performer]:
        """The common length once nobody is behind, person i and the other."""
        return self.sync(), self.people[i], self.people[1 - i]

    def hold(self, frames: int) -> None:
        """Both stand for ``frames`` frames."""
        for person in self.people:
            person.hold(frames)

    def settle(self, i: int, spot: Array, way: float, cue: str = "") -> int:
        """Person i goes to a spot (x, z) and stands there, facing ``way``; the frame from which they do.

        The way there is a beat of its own by its ``cue``, if it is long enough.
        """
        begun, own, _ = self.begin(i)
        own.go(spot, way)
        self.sync()
        own.hold(10, turn=wrapped(way - own.angle), shift=spot - own.spot)
        if cue and self.sync() - begun > 35:
            self.note((cue, STILL), begun, i=i, minor=True)
        return self.sync()

    def back_off(self, i: int, low: float, high: float) -> Done:
        """Person i goes some metres backwards."""
        return self.people[i].perform(stride(self.rng, self.library, "walk-back", self.rng.uniform(low, high)))

    def note(self, acts: tuple[str, str], start: int, *, i: int = 0, end: int | None = None, **known: Any) -> None:
        """Writes a beat down that began at ``start``.

        Args:
            acts: the cues of person i and of the other; sides and styles are in the same order.
            end: the frame at which it is over; now, if it is not given, when the shorter timeline waits.
            known: other fields of :class:`Beat`; the two act at the same time where no relation is given.
        """
        beat = Beat(acts, start, self.sync() if end is None else end, **({"relation": "while"} | known))
        self.beats.append(beat if i == 0 else beat.swapped())

    def effect(self, start: int, stop: int, effect: Effect, *, i: int = 0) -> None:
        """Has ``effect`` change the positions of (person i, the other) from ``start`` to ``stop``."""
        rng = np.random.default_rng(self.rng.integers(2**32))
        self.effects.append((effect, rng, slice(max(start, 0), stop), i))

    def look(self, i: int, start: int, stop: int, amount: float) -> None:
        """Sets how much person ``i`` looks at the other between two frames (0.7 by default)."""
        self.looks.append((i, start, stop, amount))

    def copied(self) -> Play:
        """The same scene so far, to which a beat may be added that turns out too long."""
        other = copy.copy(self)
        other.people = tuple(copy.copy(person) for person in self.people)
        other.beats, other.effects, other.looks = list(self.beats), list(self.effects), list(self.looks)
        return other

    # ---- the end ----------------------------------------------------------------------------------------
    def finish(self, most: int) -> tuple[Array, list[dict[str, Any]]]:
        """(2, T, 22, 3) canonical positions and the touches of at most ``most`` frames."""
        frames = min(map(len, self.people))
        motions = [person.motion[:frames] for person in self.people]
        heads = [m.root + np.array([0.0, 0.65, 0.0]) for m in motions]
        bodies = []
        for i, motion in enumerate(motions):
            amount = np.full(frames, 0.7)
            for person, start, stop, value in self.looks:
                if person == i:
                    amount[start:stop] = value
            bodies.append(realise(look_at(motion, heads[1 - i], amount=amount)))
        touches: list[dict[str, Any]] = []
        for effect, rng, asked, i in self.effects:
            window = slice(asked.start, min(asked.stop, frames))
            if window.stop - window.start < 8:
                continue
            *changed, events = effect(rng, bodies[i][window], bodies[1 - i][window])
            for k, part in zip((i, 1 - i), changed, strict=True):
                bodies[k][window] = part
            for *joints, first, last in events:
                first, last = first + window.start, min(last + window.start, most - 1, frames - 1)
                if first <= last:
                    touches.append({"a": joints[i], "b": joints[1 - i], "start": int(first), "end": int(last)})
        positions = canonicalize(np.stack(bodies)[:, :most])
        positions[..., 1] -= np.percentile(positions[..., 1].min(axis=2), 10, axis=1)[:, None, None]
        return positions, touches


Make = Callable[[Play, int], Done]


@dataclass(frozen=True)
class Option:
    """An act of one person that may be drawn, or a beat that may come next.

    Attributes:
        make: (play, who acts or begins) -> for an act, how it was done.
        needs: source actions.
        weight: how often it is drawn.
        gap: metres between the two, at least and at most.
        off: radians by which who begins is turned away from the other, at least and at most.
    """

    make: Callable[[Play, int], Any]
    needs: tuple[str, ...]
    weight: float = 1.0
    gap: tuple[float, float] = (0.0, 4.5)
    off: tuple[float, float] = (0.0, np.pi)

    def fits(self, play: Play, i: int) -> bool:
        """True if it makes sense where the two stand now."""
        return self.gap[0] < play.gap < self.gap[1] and self.off[0] <= abs(play.off(i)) <= self.off[1]
