"""Brings two people within reach of each other, and finishes the scene after their touch."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from motion.transforms import canonicalize
from training.corpus.compose import Array, Motion, look_at, place, realise
from training.corpus.library import Library, pick
from training.corpus.scene import Scene
from training.corpus.stage import Rng, act, beside, forward, manner, oppose, pad, seconds, stride

from .gestures import about

STILL = (0.3, 1.0)
"""Seconds of waiting before and after an encounter."""


@dataclass(eq=False)
class Encounter:
    """Two people who stand within reach of each other from frame ``start`` to frame ``stop``."""

    a: Motion
    b: Motion
    start: int
    stop: int
    slots: dict[str, Any] = field(default_factory=dict)
    events: dict[str, Any] = field(default_factory=dict)

    @property
    def frames(self) -> int:
        """Length in frames."""
        return min(len(self.a), len(self.b))

    def bodies(self, *, gaze: tuple[float, float] = (0.8, 0.8)) -> tuple[Array, Array]:
        """(T, 22, 3) positions of the two, feet planted, eyes on each other as much as ``gaze`` says."""
        a, b = self.a[: self.frames], self.b[: self.frames]
        heads = [person.root + np.array([0.0, 0.65, 0.0]) for person in (a, b)]
        return realise(look_at(a, heads[1], amount=gaze[0])), realise(look_at(b, heads[0], amount=gaze[1]))


def come_together(
    rng: Rng,
    library: Library,
    distance: float,
    hold: tuple[float, float],
    *,
    near: float = 0.4,
    leave: float = 0.2,
) -> Encounter:
    """Two people face to face ``distance`` metres apart for ``hold`` seconds.

    Args:
        near: how often they stand there from the beginning; else one or both walk up.
        leave: how often one walks away afterwards.
    """
    length, tail = seconds(rng, *hold), seconds(rng, *STILL) + 14
    slots: dict[str, Any] = {}
    events: dict[str, Any] = {"facing": True}
    if rng.random() < near:
        start = seconds(rng, *STILL) + 4
        frames = start + length + tail
        a, b = library.idle(rng, frames), library.idle(rng, frames)
    else:
        style = manner(rng, library, "walk")
        steps = stride(rng, library, "walk", rng.uniform(0.9, 2.2), style=style).motion
        wait = pick(rng, (0, 0, seconds(rng, *STILL)))
        a, begins = act(rng, library, (wait, steps), tail=length + tail + 6)
        arrives = begins[0] + len(steps)
        both = rng.random() < 0.4
        if both:
            other = stride(rng, library, "walk", rng.uniform(0.9, 2.0), style=style).motion
            b, begins = act(rng, library, (0, other), tail=length + tail + 6)
            arrives = max(arrives, begins[0] + len(other))
            a, b = (pad(rng, library, person, arrives + length + tail) for person in (a, b))
        else:
            b = library.idle(rng, len(a))
        start = arrives
        slots = {"manner_a": style, "manner_b": style if both else None, "came": "ab" if both else "a"}
    stays = len(a)
    a, b = leave_after(rng, library, a, b, start + length, leave)
    slots["left"] = len(a) != stays
    b = oppose(rng, a, b, distance, frame_a=start + length // 3, frame_b=start + length // 3, aside=0.03)
    return Encounter(a, b, start, start + length, slots, events)


def leave_after(
    rng: Rng, library: Library, a: Motion, b: Motion, frame: int, chance: float
) -> tuple[Motion, Motion]:
    """Sometimes lets the first person turn and walk away after ``frame``; the other waits on."""
    if rng.random() >= chance or min(len(a), len(b)) < frame + 6:
        return a, b
    walk = about(rng, stride(rng, library, "walk", rng.uniform(1.0, 2.0)).motion)
    cut = a[: frame + 16]
    from_here, _ = act(rng, library, (0, cut), (None, walk), tail=8)
    return from_here, pad(rng, library, b, len(from_here))


def side_by_side(
    rng: Rng, library: Library, gap: float, hold: tuple[float, float], *, side: str
) -> Encounter:
    """Two people who look the same way, b ``gap`` metres to a's ``side``."""
    start = seconds(rng, 0.3, 1.0)
    length = seconds(rng, *hold)
    frames = start + length + seconds(rng, 0.6, 1.2)
    a, b = library.idle(rng, frames), library.idle(rng, frames)
    origin, angle = forward(a, start + length // 3)
    left = gap if side == "left" else -gap
    b = beside(
        b,
        origin,
        angle,
        float(rng.normal(0, 0.03)),
        left,
        float(rng.normal(0, 0.08)),
        frame=start + length // 3,
    )
    return Encounter(a, b, start, start + length)


def abreast(rng: Rng, library: Library, ahead: float, left: float, frames: int) -> Encounter:
    """Two people who walk in step, b ``ahead`` and ``left`` metres of a."""
    style = manner(rng, library, "walk")
    walk = stride(rng, library, "walk", frames / 25 + 0.8, style=style).motion
    lag = int(rng.integers(0, 5))
    a = place(walk[: len(walk) - lag], 0.0, 0.0, 0.0, along="travel")
    b = place(walk[lag:], left, ahead, 0.0, along="travel")
    frames = min(len(a), len(b), 240)
    return Encounter(a[:frames], b[:frames], 0, frames, {"manner_a": style, "manner_b": style})


def conclude(
    library: Library,
    family: str,
    encounter: Encounter,
    a: Array,
    b: Array,
    *,
    touches: Sequence[tuple[str, str, int, int]],
    side: str | None = None,
) -> Scene:
    """The finished scene from two people who have touched.

    Args:
        touches: (joint of a, joint of b, first frame, last frame) of what touches.
        side: the side that the captions name, where they do.
    """
    positions = canonicalize(np.stack([a, b]))
    positions[..., 1] -= np.percentile(positions[..., 1].min(axis=(0, 2)), 20)
    events = dict(encounter.events)
    last = positions.shape[1] - 1
    events["contact"] = [
        {"a": own, "b": other, "start": int(start), "end": int(min(end, last))}
        for own, other, start, end in touches
    ]
    if side is not None:
        events["side"] = {"a": side}
    said = {**encounter.slots, "side_a": side, "span": (encounter.start, min(encounter.stop, last + 1))}
    return Scene(
        positions.astype(np.float32),
        family,
        tuple(sorted(set(encounter.a.sources + encounter.b.sources))),
        library.split,
        events,
        said,
    )
