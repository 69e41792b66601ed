"""Finger shapes: a small set of them, held for a while by a hand and blended over time.

A shape is 20 numbers a hand: how far each of the three joints of five fingers bends, in radians, and how far each
finger is closed towards the middle one, from 0 (spread as the body is bound) to 1. Hands are relaxed where nothing else
is said.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import astuple, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .errors import InputError
from .skeleton import SIDES
from .smoothing import smoothstep
from .vectors import Array, rotations_by

FINGERS = ("thumb", "index", "middle", "ring", "pinky")
NUMBERS = 20
"""Numbers of a shape: bends of 15 joints, then the closing of five fingers."""
BLEND = 0.22
"""Seconds over which fingers go from one shape to another."""
MOST_GRIPS = 400
"""Grips beside a motion, at most."""


_FILE = Path(__file__).resolve().parents[1] / "static" / "player" / "hands.json"
SHAPES: dict[str, Array] = {
    name: np.concatenate([np.deg2rad(np.array(shape["bends"], dtype=float)).ravel(), np.full(5, float(shape["close"]))])
    for name, shape in json.loads(_FILE.read_text(encoding="utf-8")).items()
}
"""The finger shapes that there are, (20,) each: bends in degrees, three a finger from the thumb on, in the file."""


@dataclass(frozen=True)
class Grip:
    """A shape that a hand holds for a while.

    Attributes:
        person: 0 for a, 1 for b.
        side: "left" or "right".
        shape: one of :data:`SHAPES`.
        start, stop: the first frame and the one after the last; fingers move for 0.22 s about both.
    """

    person: int
    side: str
    shape: str
    start: int
    stop: int

    def __post_init__(self) -> None:
        if self.person not in (0, 1) or self.side not in SIDES or self.shape not in SHAPES:
            raise InputError(f"A grip is of person 0 or 1, of the left or right hand, and one of {', '.join(SHAPES)}.")
        if not (type(self.start) is int and type(self.stop) is int and 0 <= self.start < self.stop):
            raise InputError("A grip has a first frame and one after its last, from 0 on.")


def grips_of(values: Any) -> tuple[Grip, ...]:
    """Grips from plain JSON; raises InputError for anything else."""
    if not isinstance(values, list) or len(values) > MOST_GRIPS:
        raise InputError(f"Grips are a list of at most {MOST_GRIPS}.")
    if not all(isinstance(row, list) and len(row) == 5 and type(row[0]) is int for row in values):
        raise InputError("A grip is a list of person, side, shape, first frame and last frame.")
    if not all(isinstance(row[1], str) and isinstance(row[2], str) for row in values):
        raise InputError("The side and the shape of a grip are text.")
    return tuple(Grip(*row) for row in values)


def cut(grips: Iterable[Grip], start: int, stop: int) -> tuple[Grip, ...]:
    """The grips of some frames, counted from the first of these."""
    kept = [g for g in grips if g.start < stop and g.stop > start]
    return tuple(Grip(g.person, g.side, g.shape, max(g.start - start, 0), min(g.stop, stop) - start) for g in kept)


def angles(grips: Iterable[Grip], person: int, times: Array, fps: float) -> Array:
    """(T, 2, 20) the shapes of a person's hands, left first, at frames ``times`` (T,), which may lie between two."""
    shapes = np.tile(SHAPES["relaxed"], (len(times), 2, 1))
    for grip in grips:
        if grip.person == person:
            side = SIDES.index(grip.side)
            share = strength(grip, np.asarray(times, dtype=float), fps)[:, None]
            shapes[:, side] += share * (SHAPES[grip.shape] - shapes[:, side])
    return shapes


def strength(grip: Grip, times: Array, fps: float) -> Array:
    """(T,) from 0, the hand is as before, to 1, it has the shape of the grip."""
    half = BLEND * fps / 2
    rise = (times - grip.start + half) / (2 * half)
    if grip.start == 0:
        rise = np.ones_like(times)
    return smoothstep(np.minimum(rise, (grip.stop + half - times) / (2 * half)))


@dataclass(frozen=True, eq=False)
class Fingers:
    """The binding of a body's hands.

    Attributes:
        joints: (2, 5, 3, 3) places in the pose of binding, by side, finger and joint from the palm out.
        flex: (2, 5, 3, 3) unit axes about which they bend.
        close: (2, 5) radians about the palm's normal that bring each finger in line with the middle one.
        normals: (2, 3) unit vectors out of the palms.
        vertices: (H,) those of the body that fingers move.
        bones: (H, 3) the joints that move each, numbered in the order of ``joints`` from 0 to 29.
        weights: (H, 3) their shares; what is missing to 1 stays with the palm.
    """

    joints: Array
    flex: Array
    close: Array
    normals: Array
    vertices: NDArray[np.integer]
    bones: NDArray[np.integer]
    weights: Array

    @classmethod
    def from_stored(cls, stored: Mapping[str, Any], numbers: Any) -> Fingers:
        """The fingers of a file of ``static/bodies``; ``numbers(text, kind, columns)`` decodes an array."""
        return cls(
            np.reshape(stored["joints"], (2, 5, 3, 3)),
            np.reshape(stored["flex"], (2, 5, 3, 3)),
            np.reshape(stored["close"], (2, 5)),
            np.reshape(stored["normals"], (2, 3)),
            numbers(stored["vertices"], "<u2", 1)[:, 0].astype(np.int64),
            numbers(stored["bones"], "u1", 3).astype(np.int64),
            numbers(stored["weights"], "u1", 3) / 255,
        )

    def local(self, shapes: Array) -> Array:
        """(T, 2, 5, 3, 3, 3) rotation of each joint against the one above it, for shapes (T, 2, 20)."""
        bends = shapes[..., :15].reshape(-1, 2, 5, 3)
        turns = rotations_by(bends[..., None] * self.flex)
        closing = shapes[..., 15:, None] * self.close[..., None] * self.normals[:, None]
        turns[:, :, :, 0] = rotations_by(closing) @ turns[:, :, :, 0]
        return turns

    def moves(self, shapes: Array) -> tuple[Array, Array]:
        """Rotations (T, 30, 3, 3) and places (T, 30, 3) of the joints in the pose of binding, for shapes (T, 2, 20)."""
        turns = self.local(shapes)
        places = np.empty((*turns.shape[:4], 3))
        places[:, :, :, 0] = self.joints[:, :, 0]
        for joint in (1, 2):
            bone = self.joints[:, :, joint] - self.joints[:, :, joint - 1]
            places[:, :, :, joint] = places[:, :, :, joint - 1] + (turns[:, :, :, joint - 1] @ bone[..., None])[..., 0]
            turns[:, :, :, joint] = turns[:, :, :, joint - 1] @ turns[:, :, :, joint]
        return turns.reshape(-1, 30, 3, 3), places.reshape(-1, 30, 3)

    def shift(self, vertices: Array, shapes: Array) -> Array:
        """(T, H, 3) metres by which shapes (T, 2, 20) move the vertices (V, 3) of the body in its pose of binding."""
        unique, which = np.unique(shapes.reshape(len(shapes), -1), axis=0, return_inverse=True)
        turns, places = self.moves(unique.reshape(-1, 2, NUMBERS))
        rest = vertices[self.vertices]
        joints = self.joints.reshape(30, 3)
        moved = np.zeros((len(unique), len(rest), 3))
        for slot in range(self.bones.shape[1]):
            bone, share = self.bones[:, slot], self.weights[:, slot, None]
            out = np.einsum("thij,hj->thi", turns[:, bone], rest - joints[bone]) + places[:, bone] - rest
            moved += share * out
        return moved[which.reshape(-1)]


def to_lists(grips: Sequence[Grip]) -> list[list[Any]]:
    """Grips as plain JSON: person, side, shape, start and stop of each."""
    return [list(astuple(grip)) for grip in grips]
