"""The moments of a motion at which things change hands: where hands meet, swing, or are at their lowest."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .holding import SIDES, Hands, smoothed, unit

Array = NDArray[np.floating]

WITHIN = 0.6
"""Metres between two palms, at most, at which a thing passes from one to the other."""
BEYOND = 0.35
"""Metres in front of the pelvis at which a foot meets a ball: beyond the toes of a standing person."""
AROUND = 0.5
"""Seconds by which a moment may lie outside the frames of its act: what is made keeps no beat to the frame."""


@dataclass(frozen=True)
class Moment:
    """A frame at which something happens.

    Attributes:
        frame: of the motion.
        sides: of the hands that take part, 0 left and 1 right: the giver's first.
        metres: between these hands, or of the one hand over the floor; for a swing its speed in metres a second.
    """

    frame: int
    sides: tuple[int, int]
    metres: float


def window(hands: Hands, start: int, stop: int) -> slice:
    """The frames of an act with a little around them."""
    around = round(AROUND * hands.fps)
    first = min(max(start - around, 0), hands.frames - 1)
    return slice(first, max(min(stop + around, hands.frames), first + 1))


def meeting(hands: Hands, giver: int, start: int, stop: int) -> Moment:
    """The moment at which a palm of one person comes nearest to one of the other."""
    part = window(hands, start, stop)
    ours, theirs = hands.palms[giver][:, part], hands.palms[1 - giver][:, part]
    gaps = np.linalg.norm(ours[:, None] - theirs[None], axis=-1)
    mine, yours, frame = np.unravel_index(gaps.argmin(), gaps.shape)
    return Moment(part.start + int(frame), (int(mine), int(yours)), float(gaps.min()))


def release(hands: Hands, thrower: int, start: int, stop: int, towards: Array | None = None) -> Moment:
    """The moment at which a palm swings fastest, along ``towards`` (3,) if it is given."""
    part = window(hands, start, stop)
    speed = np.gradient(hands.palms[thrower], axis=1)[:, part] * hands.fps
    along = np.linalg.norm(speed, axis=-1) if towards is None else speed @ unit(towards)
    along = np.stack([smoothed(each, 3) for each in along])
    side, frame = np.unravel_index(along.argmax(), along.shape)
    return Moment(part.start + int(frame), (int(side), int(side)), float(along.max()))


def kick(hands: Hands, person: int, start: int, stop: int) -> Moment:
    """The moment at which the ball of a person's foot swings ahead fastest, in front of the body if it gets there."""
    part = window(hands, start, stop)
    feet = np.stack([hands.joint(person, f"{side}_foot") for side in SIDES])
    speed = np.gradient(feet, axis=1)[:, part] * hands.fps
    along = np.stack([smoothed(each, 3) for each in (speed * hands.ahead[person, part]).sum(axis=-1)])
    beyond = ((feet - hands.joint(person, "pelvis"))[:, part] * hands.ahead[person, part]).sum(axis=-1)
    along = np.where(beyond > BEYOND, along, 0.0) if (beyond > BEYOND).any() else along
    side, frame = np.unravel_index(along.argmax(), along.shape)
    return Moment(part.start + int(frame), (int(side), int(side)), float(along.max()))


def lowest(hands: Hands, person: int, start: int, stop: int, side: int | None = None) -> Moment:
    """The moment at which a person's palm, of one side or any, is at its lowest; the middle of a rest there."""
    part = window(hands, start, stop)
    sides = (0, 1) if side is None else (side,)
    heights = hands.palms[person][list(sides), part, 1]
    which, _ = np.unravel_index(heights.argmin(), heights.shape)
    low = np.flatnonzero(heights[which] < heights.min() + 0.03)
    found = sides[int(which)]
    return Moment(part.start + int(low[len(low) // 2]), (found, found), float(heights.min()))
