"""The hands of two people, and the moments at which things change hands: where these meet, swing, or are lowest."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import scipy  # its parts are loaded with their first use
from numpy.typing import NDArray

from motion import SMPL22, Duet
from motion.body import bone_rotations
from motion.skeleton import SIDES
from motion.vectors import FLAT, Array, unit

PALM, DEEP = 0.085, 0.025
"""Metres from the wrist to the middle of the palm, along the fingers and out of the palm."""
WITHIN = 0.6
"""Metres between two palms, at most, at which a thing passes from one to the other."""
BEYOND = 0.35
"""Metres in front of the pelvis at which a foot meets a ball: beyond the toes of a standing person."""
AROUND = 0.5
"""Seconds by which a moment may lie outside the frames of its act: a generated motion keeps no beat to the frame."""
_J = {name: index for index, name in enumerate(SMPL22.joint_names)}


@dataclass(frozen=True, eq=False)
class Hands:
    """The hands and the trunks of two people.

    Attributes:
        palms: (2, 2, T, 3) metres, by person and side, left first.
        fingers: (2, 2, T, 3) unit vectors along the fingers.
        out: (2, 2, T, 3) unit vectors out of the palms.
        thumbs: (2, 2, T, 3) unit vectors towards the thumbs.
        ahead: (2, T, 3) level unit vectors, the way each person's trunk faces.
        positions: (2, T, 22, 3) of the joints.
        fps: frames a second.
    """

    palms: Array = field(repr=False)
    fingers: Array = field(repr=False)
    out: Array = field(repr=False)
    thumbs: Array = field(repr=False)
    ahead: Array = field(repr=False)
    positions: Array = field(repr=False)
    fps: float

    @classmethod
    def of(cls, duet: Duet) -> Hands:
        """The hands of two people on SMPL22."""
        positions = duet.positions.astype(np.float64)
        shape = (2, 2, duet.num_frames, 3)
        palms, fingers, out, thumbs = (np.empty(shape) for _ in range(4))
        ahead = np.empty((2, duet.num_frames, 3))
        worlds = bone_rotations(positions.reshape(-1, *positions.shape[2:]))
        for person, world in enumerate(worlds.reshape(*positions.shape, 3)):
            ahead[person] = level(world[:, _J["spine3"]] @ np.array([0.0, 0.0, 1.0]))
            for side, name in enumerate(SIDES):
                turn = world[:, _J[f"{name}_wrist"]]
                fingers[person, side] = turn @ np.array([1.0 if name == "left" else -1.0, 0.0, 0.0])
                out[person, side] = turn @ np.array([0.0, -1.0, 0.0])
                thumbs[person, side] = turn @ np.array([0.0, 0.0, 1.0])
                wrist = positions[person, :, _J[f"{name}_wrist"]]
                palms[person, side] = wrist + PALM * fingers[person, side] + DEEP * out[person, side]
        return cls(palms, fingers, out, thumbs, ahead, positions, duet.fps)

    @property
    def frames(self) -> int:
        """Length of the motion."""
        return self.palms.shape[2]

    def joint(self, person: int, name: str) -> Array:
        """(T, 3) metres."""
        return self.positions[person, :, _J[name]]

    def better_side(self, person: int, start: int, stop: int, side: str = "") -> int:
        """The hand that holds something in some frames: the one named, or the clearly higher one, or the right."""
        if side in SIDES:
            return SIDES.index(side)
        heights = self.palms[person, :, start:stop, 1].mean(axis=1)
        return 0 if heights[0] > heights[1] + 0.12 else 1


# ---- moments ---------------------------------------------------------------------------------------------
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


def meeting(hands: Hands, giver: int, start: int, stop: int) -> Moment:
    """The moment at which a palm of one person comes nearest to one of the other."""
    part = _around(hands, start, stop)
    ours, theirs = hands.palms[giver][:, part], hands.palms[1 - giver][:, part]
    gaps = np.linalg.norm(ours[:, None] - theirs[None], axis=-1)
    mine, yours, frame = np.unravel_index(gaps.argmin(), gaps.shape)
    return Moment(part.start + int(frame), (int(mine), int(yours)), float(gaps.min()))


def release(hands: Hands, thrower: int, start: int, stop: int, towards: Array) -> Moment:
    """The moment at which a palm swings fastest along ``towards`` (3,)."""
    part = _around(hands, start, stop)
    return _fastest(np.gradient(hands.palms[thrower], axis=1)[:, part] * hands.fps @ unit(towards), part)


def kick(hands: Hands, person: int, start: int, stop: int) -> Moment:
    """The moment at which the ball of a person's foot swings ahead fastest, in front of the body if it gets there."""
    part = _around(hands, start, stop)
    feet = np.stack([hands.joint(person, f"{side}_foot") for side in SIDES])
    ahead = hands.ahead[person, part]
    speed = (np.gradient(feet, axis=1)[:, part] * hands.fps * ahead).sum(axis=-1)
    beyond = ((feet - hands.joint(person, "pelvis"))[:, part] * ahead).sum(axis=-1) > BEYOND
    return _fastest(speed, part, beyond if beyond.any() else None)


def lowest(hands: Hands, person: int, start: int, stop: int, side: int | None = None) -> Moment:
    """The moment at which a person's palm, of one side or any, is at its lowest; the middle of a rest there."""
    part = _around(hands, start, stop)
    sides = (0, 1) if side is None else (side,)
    heights = hands.palms[person][list(sides), part, 1]
    which, _ = np.unravel_index(heights.argmin(), heights.shape)
    low = np.flatnonzero(heights[which] < heights.min() + 0.03)
    hand = sides[int(which)]
    return Moment(part.start + int(low[len(low) // 2]), (hand, hand), float(heights.min()))


def _around(hands: Hands, start: int, stop: int) -> slice:
    """The frames of an act with a little around them."""
    around = round(AROUND * hands.fps)
    first = min(max(start - around, 0), hands.frames - 1)
    return slice(first, max(min(stop + around, hands.frames), first + 1))


def _fastest(speed: Array, part: slice, where: NDArray[np.bool_] | None = None) -> Moment:
    """The moment at which the speed (2, T) of the left or the right limb, smoothed, is greatest."""
    smooth = smoothed(speed.T, 3).T
    smooth = smooth if where is None else np.where(where, smooth, 0.0)
    side, frame = np.unravel_index(smooth.argmax(), smooth.shape)
    return Moment(part.start + int(frame), (int(side), int(side)), float(smooth.max()))


# ---- vectors ---------------------------------------------------------------------------------------------
def level(vectors: Array) -> Array:
    """Unit vectors without their height; +Z for one that points straight up or down."""
    flat = vectors * FLAT
    length = np.linalg.norm(flat, axis=-1, keepdims=True)
    return np.where(length > 1e-4, flat / np.maximum(length, 1e-4), np.array([0.0, 0.0, 1.0]))


def smoothed(values: Array, width: int) -> Array:
    """(T, …) the mean over an odd number of frames about each; the ends are repeated."""
    return scipy.ndimage.uniform_filter1d(values, width, axis=0, mode="nearest")
