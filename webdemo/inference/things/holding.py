"""Holds of things: the frames of palms, and what is held, kind by kind."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from motion import SMPL22, Duet
from motion.body import bone_rotations
from motion.things import Mesh
from motion.vectors import unit

Array = NDArray[np.floating]

SIDES = ("left", "right")
PALM, DEEP = 0.085, 0.025
"""Metres from the wrist to the middle of the palm, along the fingers and out of the palm."""
BEFORE_BODY = 0.17
"""Metres from the pelvis to the surface of the belly, and a little more."""
_UP = np.array([0.0, 1.0, 0.0])
_J = {name: index for index, name in enumerate(SMPL22.joint_names)}

Track = tuple[Array, Array]
"""Places (T, 3) and rotations (T, 3, 3)."""


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
        for person, world in enumerate(map(bone_rotations, positions)):
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

    def wrist_gap(self, person: int) -> Array:
        """(T,) metres between a person's palms."""
        return np.linalg.norm(self.palms[person, 0] - self.palms[person, 1], axis=-1)

    def better_side(self, person: int, start: int, stop: int, side: str = "") -> int:
        """The hand that holds something in some frames: the one named, or the clearly higher one, or the right."""
        if side in SIDES:
            return SIDES.index(side)
        heights = self.palms[person, :, start:stop, 1].mean(axis=1)
        return 0 if heights[0] > heights[1] + 0.12 else 1


def held(hands: Hands, person: int, side: int, kind: str, mesh: Mesh) -> Track:
    """The track of a thing in a person's hand, or before their trunk if it takes two hands."""
    if kind == "guitar":
        return _played(hands, person)
    if takes_both_hands(kind, mesh, own=kind == "own"):
        return _before(hands, person, mesh)
    palm, out = hands.palms[person, side], hands.out[person, side]
    fingers, thumbs = hands.fingers[person, side], hands.thumbs[person, side]
    if kind == "ball":
        both = hands.wrist_gap(person) < 0.42
        one = palm + (mesh.size[0] / 2 - 0.005) * out
        two = hands.palms[person].mean(axis=0)
        share = smoothed(both.astype(float), 7)[:, None]
        return (1 - share) * one + share * two, frame_of(fingers, thumbs)
    if kind in ("sword", "stick"):
        return palm, frame_of(0.75 * fingers + 0.65 * thumbs, out)
    if kind in ("phone", "book"):
        return palm + 0.004 * out, frame_of(fingers, fingers, out)
    if kind in ("flower", "ring"):
        return palm + 0.01 * out, frame_of(thumbs + 0.6 * _UP, fingers)
    if kind == "bag":
        return palm + 0.01 * out, frame_of(np.broadcast_to(_UP, palm.shape), fingers)
    # What has an upright stays upright, beside the palm that holds it.
    aside = 0.04 if kind == "cup" else 0.0
    return palm + aside * level(out), frame_of(np.broadcast_to(_UP, palm.shape), -level(out))


def takes_both_hands(kind: str, mesh: Mesh, *, own: bool) -> bool:
    """True for what is held before the body, and for a guitar."""
    if kind == "guitar" and not own:
        return True
    return kind == "box" or float(mesh.size.max()) > 1.3 or (own and float(mesh.size.min()) > 0.16)


def _before(hands: Hands, person: int, mesh: Mesh) -> Track:
    """Between both hands, never inside the trunk."""
    ahead = hands.ahead[person]
    middle = hands.palms[person].mean(axis=0)
    pelvis = hands.joint(person, "pelvis")
    least = BEFORE_BODY + mesh.size[2] / 2
    out = np.einsum("ti,ti->t", middle - pelvis, ahead)
    aside = middle - pelvis - out[:, None] * ahead
    aside[:, 1] = 0.0
    place = middle + np.maximum(least - out, 0.0)[:, None] * ahead - 0.5 * aside
    return place, frame_of(np.broadcast_to(_UP, place.shape), ahead, ahead)


def _played(hands: Hands, person: int) -> Track:
    """A guitar before the belly, its neck towards the left hand."""
    ahead = hands.ahead[person]
    left = np.cross(np.broadcast_to(_UP, ahead.shape), ahead)
    belly = hands.joint(person, "spine1") + 0.19 * ahead - 0.1 * left
    neck = hands.palms[person, 0] - belly
    neck = neck - np.einsum("ti,ti->t", neck, ahead)[:, None] * ahead
    along = unit(unit(neck) + 1.2 * left + 0.3 * _UP)
    return belly, frame_of(along, ahead, ahead)


def frame_of(up: Array, across: Array, front: Array | None = None) -> Array:
    """(T, 3, 3) rotations whose Y column is ``up``; Z is near ``front``, or else X is near ``across``."""
    y = unit(up)
    if front is not None:
        z = unit(front - np.einsum("ti,ti->t", front, y)[:, None] * y)
        return np.stack([np.cross(y, z), y, z], axis=-1)
    x = across - np.einsum("ti,ti->t", across, y)[:, None] * y
    x = unit(np.where(np.linalg.norm(x, axis=1, keepdims=True) > 1e-4, x, np.cross(y, y[:, [1, 2, 0]])))
    return np.stack([x, y, np.cross(x, y)], axis=-1)


def level(vectors: Array) -> Array:
    """Unit vectors without their height; +Z for one that points straight up or down."""
    flat = vectors * np.array([1.0, 0.0, 1.0])
    length = np.linalg.norm(flat, axis=-1, keepdims=True)
    return np.where(length > 1e-4, flat / np.maximum(length, 1e-4), np.array([0.0, 0.0, 1.0]))


def smoothed(values: Array, width: int) -> Array:
    """(T, …) the mean over an odd number of frames about each; the ends are repeated."""
    half = width // 2
    padded = np.pad(values, [(half, half), *[(0, 0)] * (values.ndim - 1)], mode="edge")
    total = np.cumsum(np.concatenate([np.zeros_like(padded[:1]), padded]), axis=0)
    return (total[width:] - total[:-width]) / width


def yaw_of(direction: Array) -> float:
    """Radians from +Z towards +X of a direction (3,)."""
    return float(np.arctan2(direction[0], direction[2]))
