"""A duet's joints with what the predicates derive from them: paths, headings, palms, heights."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property

import numpy as np
import scipy  # its parts are loaded with their first use
from numpy.typing import NDArray

from motion import SMPL22
from motion.metrics.interaction import palms
from motion.skeleton import SIDES
from motion.transforms import facing
from motion.vectors import FLAT, Array, runs, square_frame

_SMOOTH = 0.15
"""Seconds: standard deviation of the filter over root paths and headings, which takes out a step's sway."""
_A_CHILD = 0.87
"""Length of the thighs, as a share of an adult's, below which somebody is a child."""
_LIMBS = ("wrist", "elbow", "knee", "ankle")


def flat(vectors: Array, axis: Array) -> Array:
    """(…, T) metres of vectors (…, T, 3) along an axis over the floor, (T, 2)."""
    return np.sum(vectors[..., [0, 2]] * axis, axis=-1)


class Motion:
    """Two people on SMPL's 22 joints.

    Args:
        positions: (2, T, 22, 3) metres, Y up, floor at 0.
        fps: frames a second.
    """

    def __init__(self, positions: Array, fps: float = 30.0) -> None:
        if np.ndim(positions) != 4 or positions.shape[0] != 2 or positions.shape[2:] != (22, 3):
            raise ValueError(f"A duet has the shape (2, frames, 22, 3), not {np.shape(positions)}.")
        self.positions = np.asarray(positions, dtype=np.float64)
        self.fps = fps

    @property
    def frames(self) -> int:
        """Length in frames."""
        return self.positions.shape[1]

    def swapped(self) -> Motion:
        """The same motion with the two people exchanged."""
        return Motion(self.positions[::-1], self.fps)

    # ---- joints --------------------------------------------------------------------------------------
    def joint(self, who: int, name: str) -> Array:
        """(T, 3) path of a joint."""
        return self.positions[who, :, SMPL22.index(name)]

    def pair(self, who: int, part: str) -> Array:
        """(2, T, 3) paths of the left and the right joint of a part."""
        return np.stack([self.joint(who, f"{side}_{part}") for side in SIDES])

    @cached_property
    def palms(self) -> Array:
        """(2 people, 2 sides, T, 3) middles of the palms."""
        return palms(self.positions).swapaxes(1, 2)

    def hands(self, who: int, side: str = "any") -> Array:
        """(H, T, 3) wrists and palms of one hand or of both ("any")."""
        sides = [SIDES.index(side)] if side in SIDES else [0, 1]
        return np.concatenate([self.pair(who, "wrist")[sides], self.palms[who][sides]])

    # ---- paths over the floor --------------------------------------------------------------------------
    @cached_property
    def roots(self) -> Array:
        """(2, T, 2) smoothed paths of the pelvises over the floor (X, Z)."""
        return scipy.ndimage.gaussian_filter1d(
            self.positions[:, :, 0][..., [0, 2]], _SMOOTH * self.fps, axis=1, mode="nearest"
        )

    @cached_property
    def velocities(self) -> Array:
        """(2, T, 2) metres a second of the roots over the floor."""
        return np.gradient(self.roots, axis=1) * self.fps

    @cached_property
    def speeds(self) -> Array:
        """(2, T) metres a second."""
        return np.linalg.norm(self.velocities, axis=-1)

    @cached_property
    def distance(self) -> Array:
        """(T,) metres between the roots over the floor."""
        return np.linalg.norm(self.roots[1] - self.roots[0], axis=-1)

    def towards(self, who: int) -> Array:
        """(T, 2) unit vector over the floor from a person to the other."""
        line = self.roots[1 - who] - self.roots[who]
        return line / np.maximum(np.linalg.norm(line, axis=-1, keepdims=True), 1e-6)

    @cached_property
    def forward(self) -> Array:
        """(2, T, 2) unit vectors over the floor that the bodies face."""
        return facing(self.positions)[..., [0, 2]]

    @cached_property
    def headings(self) -> Array:
        """(2, T) headings in degrees, unwrapped and smoothed; they grow in a turn to the left."""
        forward = self.forward
        angles = np.unwrap(np.arctan2(forward[..., 0], forward[..., 1]), axis=1)
        return np.degrees(scipy.ndimage.gaussian_filter1d(angles, _SMOOTH * self.fps, axis=1, mode="nearest"))

    def off(self, who: int) -> Array:
        """(T,) degrees between where a person faces and where the other is, 0 to 180."""
        cos = np.sum(self.forward[who] * self.towards(who), axis=-1)
        return np.degrees(np.arccos(np.clip(cos, -1.0, 1.0)))

    def left(self, who: int) -> Array:
        """(T, 2) unit vectors over the floor to a person's left."""
        x, z = self.forward[who].T
        return np.stack([z, -x], axis=-1)

    def of_trunk(self, who: int, vectors: Array) -> Array:
        """Vectors (…, T, 3) in the frame of a person's trunk: to their left, up along it, and ahead."""
        left = np.insert(self.left(who), 1, 0.0, axis=-1)
        frame = square_frame(self.joint(who, "neck") - self.joint(who, "pelvis"), left)
        return np.einsum("...ti,tij->...tj", vectors, frame)

    def limbs(self, who: int, *, mirrored: bool = False) -> Array:
        """(T, 8, 3) m/s of wrists, elbows, knees and ankles in the body's own frame (left, up, ahead).

        ``mirrored`` exchanges the sides.
        """
        order = SIDES[::-1] if mirrored else SIDES
        points = np.stack([self.joint(who, f"{side}_{part}") for part in _LIMBS for side in order])
        points = points - self.joint(who, "pelvis") * FLAT
        left = flat(points, self.left(who)) * (-1 if mirrored else 1)
        local = np.stack([left, points[..., 1], flat(points, self.forward[who])], axis=-1)
        return (
            scipy.ndimage.gaussian_filter1d(np.gradient(local, axis=1), 0.1 * self.fps, axis=1).swapaxes(0, 1)
            * self.fps
        )

    # ---- heights ---------------------------------------------------------------------------------------
    def height(self, who: int) -> Array:
        """(T,) height of the pelvis as a share of its height in standing, which the leg's bones give."""
        hip, knee, ankle, foot = (self.pair(who, part)[:, 0] for part in ("hip", "knee", "ankle", "foot"))
        leg = np.linalg.norm(hip - knee, axis=-1) + np.linalg.norm(knee - ankle, axis=-1)
        standing = leg + np.linalg.norm(ankle - foot, axis=-1) * 0.4 + 0.09
        return self.positions[who, :, 0, 1] / standing.mean()

    def size(self, who: int) -> float:
        """Length of a child's thighs as a share of an adult's; 1 for everybody else."""
        thighs = np.linalg.norm(self.pair(who, "hip") - self.pair(who, "knee"), axis=-1).mean()
        size = float(thighs / SMPL22.bone_lengths[SMPL22.index("left_knee")])
        return size if size < _A_CHILD else 1.0

    def lean(self, who: int) -> Array:
        """(T,) degrees by which the trunk leans out of the vertical."""
        trunk = self.joint(who, "neck") - self.joint(who, "pelvis")
        return np.degrees(np.arctan2(np.linalg.norm(trunk[:, [0, 2]], axis=-1), trunk[:, 1]))

    def drop(self, who: int) -> Array:
        """(T,) metres by which the head is below where it mostly is (its 90th percentile)."""
        head = self.joint(who, "head")[:, 1]
        return np.percentile(head, 90) - head


# ---- Stretches of time -----------------------------------------------------------------------------------------------
Mask = NDArray[np.bool_]

PAUSE = 0.2
"""Seconds for which something may stop holding and still count as going on."""


def stretches(mask: Mask, fps: float, *, pause: float = PAUSE) -> list[tuple[int, int]]:
    """(first frame, one past the last) of a mask's runs; runs less than ``pause`` seconds apart are one."""
    spans: list[tuple[int, int]] = []
    for start, stop in runs(np.asarray(mask)):
        if spans and start - spans[-1][1] < pause * fps:
            spans[-1] = (spans[-1][0], stop)
        else:
            spans.append((start, stop))
    return spans


def keep(mask: Mask, fps: float, holds: Callable[[int, int], bool], *, pause: float = PAUSE) -> Mask:
    """The stretches of a mask of which ``holds(start, stop)`` is true, pauses filled in."""
    kept = np.zeros(len(mask), dtype=bool)
    for start, stop in stretches(mask, fps, pause=pause):
        if holds(start, stop):
            kept[start:stop] = True
    return kept


def longest(mask: Mask, fps: float) -> float:
    """Seconds of the longest stretch."""
    return max((stop - start for start, stop in stretches(mask, fps)), default=0) / fps


# ---- The words of the rules that say what happens at each frame, by name, and how they combine ----------------------
PREDICATES: dict[str, Callable[..., Mask]] = {}
"""The predicates by the name that rules use."""


def predicate(function: Callable[..., Mask]) -> Callable[..., Mask]:
    """Adds a predicate to the vocabulary."""
    PREDICATES[function.__name__] = function
    return function


@predicate
def both(m: Motion, *masks: Mask) -> Mask:
    """All of them at once."""
    return np.logical_and.reduce(masks)


@predicate
def either(m: Motion, *masks: Mask) -> Mask:
    """At least one of them."""
    return np.logical_or.reduce(masks)


@predicate
def without(m: Motion, mask: Mask) -> Mask:
    """The frames where a predicate does not hold."""
    return ~mask


@predicate
def begins(m: Motion, mask: Mask, seconds: float = 0.3) -> Mask:
    """The first ``seconds`` of every stretch: a state that is entered, as a beat of its own."""
    starts = np.zeros(m.frames, dtype=bool)
    for i, j in stretches(mask, m.fps):
        starts[i : min(j, i + round(seconds * m.fps))] = True
    return starts
