"""Two performers on one stage, the beats they have played, and the finished scene."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from motion.transforms import canonicalize
from motion.vectors import wrapped

from ..compose import FPS, Array, look_at, realise
from ..cues import STILL, Beat
from ..library import Library
from ..touches import Touches
from .performer import Performer, Rng, bearing

Effect = Callable[[Array, Array], tuple[Array, Array, Touches]]


@dataclass
class _Timed:
    effect: Effect
    start: int
    stop: int
    swap: bool


class Play:
    """A scene in the making.

    Args:
        spots: ((x, z), heading) of a and b at first.
    """

    def __init__(
        self,
        rng: Rng,
        library: Library,
        spots: tuple[tuple[tuple[float, float], float], tuple[tuple[float, float], float]],
        styles: tuple[str | None, str | None] = (None, None),
    ) -> None:
        self.rng, self.library = rng, library
        self.people = tuple(
            Performer(rng, library, *spot, style=style) for spot, style in zip(spots, styles, strict=True)
        )
        self.beats: list[Beat] = []
        self.effects: list[_Timed] = []
        self.looks: list[tuple[int, int, int, float]] = []
        self.wish: tuple[str, str] | None = None
        self.brisk = False

    def wanted(self, options: Sequence[str], role: int = 0) -> str:
        """One of ``options``; the act wished of the first person (0) or of the other (1), if it is one of them."""
        if self.wish and self.wish[role] in options:
            return self.wish[role]
        return options[int(self.rng.integers(len(options)))]

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

    def note(self, acts: tuple[str, str], start: int, *, i: int = 0, **known: Any) -> Beat:
        """Writes a beat down that began at ``start`` and ends now; acts, sides, styles are of i and the other."""
        beat = Beat(acts, start, self.sync(), **known)
        beat = replace(beat, first=0) if i == 0 else beat.swapped()
        self.beats.append(beat)
        return beat

    def note_span(self, acts: tuple[str, str], start: int, end: int, *, i: int = 0, **known: Any) -> None:
        """Writes down a beat that is already over."""
        beat = Beat(acts, start, end, **known)
        self.beats.append(beat if i == 0 else beat.swapped())

    def beats_before(self, start: int, end: int, i: int) -> None:
        """Writes down that the other has come to i's side."""
        self.note_span(("join-side", STILL), start, end, i=1 - i, relation="while", minor=True)

    def effect(self, start: int, stop: int, effect: Effect, *, i: int = 0) -> None:
        """Has ``effect`` change the positions of (person i, the other) from ``start`` to ``stop``."""
        self.effects.append(_Timed(effect, max(start, 0), stop, i == 1))

    def look(self, i: int, start: int, stop: int, amount: float) -> None:
        """Sets how much person ``i`` looks at the other between two frames (0.7 by default)."""
        self.looks.append((i, start, stop, amount))

    def snapshot(self) -> tuple[Any, ...]:
        """The state that :meth:`restore` goes back to."""
        kept = (list(self.beats), list(self.effects), list(self.looks))
        return [person.state() for person in self.people], *kept

    def restore(self, state: tuple[Any, ...]) -> None:
        """Goes back to a state that ``state`` gave."""
        people, self.beats, self.effects, self.looks = state[0], *map(list, state[1:])
        for person, one in zip(self.people, people, strict=True):
            person.restore(one)

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
        for timed in self.effects:
            window = slice(timed.start, min(timed.stop, frames))
            if window.stop - window.start < 8:
                continue
            order = (1, 0) if timed.swap else (0, 1)
            one, other, found = timed.effect(*(bodies[k][window] for k in order))
            for k, part in zip(order, (one, other), strict=True):
                bodies[k] = bodies[k].copy()
                bodies[k][window] = part
            for own, to, first, last in found:
                first, last = first + window.start, min(last + window.start, most - 1, frames - 1)
                if first <= last:
                    names = (own, to) if not timed.swap else (to, own)
                    touches.append({"a": names[0], "b": names[1], "start": int(first), "end": int(last)})
        positions = canonicalize(np.stack(bodies)[:, :most])
        positions[..., 1] -= np.percentile(positions[..., 1].min(axis=2), 10, axis=1)[:, None, None]
        return positions, touches

    def sources(self) -> tuple[str, ...]:
        """Names of the clips that both people were made from."""
        return tuple(sorted({source for person in self.people for source in person.motion.sources}))


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


Make = Callable[[Play, int], Done]


@dataclass(frozen=True)
class Act:
    """One thing that a person can do.

    Attributes:
        make: (play, person) -> how it was done.
        needs: source actions it is made of.
        weight: how often it is drawn.
        room: metres that must be free in front.
    """

    make: Make
    needs: tuple[str, ...]
    weight: float = 1.0
    room: float = 0.9
