"""Eyes of a body that turn to what is seen, as far as eyes do without the head.

``static/player/eyes.js`` does the same in the browser, number for number.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .easing import smoothstep

Array = NDArray[np.floating]

ZONES = ("eyes", "whites")
"""Zones of a body's surface that are eyes."""
_ASIDE, _UP = np.radians([26.0, 8.0])
"""Radians by which eyes turn to a side, and up or down, at most: their lids do not go with them."""
_SEES = np.radians([55.0, 85.0])
"""Radians beside where the face points up to which eyes turn to a place, and from which they look ahead."""


@dataclass(frozen=True, eq=False)
class Eyes:
    """The eyes of a body in its pose of binding, which faces +Z.

    Attributes:
        middles: (2, 3) metres, of the left and of the right eye.
        vertices: (E,) indices of the vertices of both.
        sides: (E,) 0 for a vertex of the left eye, 1 for one of the right.
    """

    middles: Array
    vertices: NDArray[np.integer]
    sides: NDArray[np.integer]

    @classmethod
    def of(cls, middles: Array, vertices: Array, faces: NDArray[np.integer]) -> Eyes:
        """The eyes with these middles, of a body's vertices (V, 3) and those of its faces that are eyes."""
        used = np.unique(faces)
        return cls(middles, used, (vertices[used, 0] < 0).astype(np.int64))

    def turns(self, places: Array) -> Array:
        """(T, 3, 3) rotation of both eyes to places (T, 3) in the frame of binding."""
        way = places - self.middles.mean(axis=0)
        yaw = np.arctan2(way[:, 0], way[:, 2])
        pitch = np.arctan2(way[:, 1], np.hypot(way[:, 0], way[:, 2]))
        share = 1 - smoothstep(np.abs(yaw), *_SEES)
        yaw, pitch = share * _ASIDE * np.tanh(yaw / _ASIDE), share * _UP * np.tanh(pitch / _UP)
        cy, sy, cp, sp, zero = np.cos(yaw), np.sin(yaw), np.cos(pitch), np.sin(pitch), 0 * yaw
        rows = [cy, -sy * sp, sy * cp, zero, cp, sp, -sy, -cy * sp, cy * cp]
        return np.stack(rows, axis=-1).reshape(-1, 3, 3)

    def shift(self, vertices: Array, places: Array) -> Array:
        """(T, E, 3) by how much the eyes' vertices move from the body's (V, 3) where they look at places (T, 3)."""
        out = vertices[self.vertices] - self.middles[self.sides]
        return np.asarray(out @ np.swapaxes(self.turns(places), -1, -2) - out)


def eye_zones(zones: tuple[str, ...]) -> list[int]:
    """Indices of the zones that are eyes."""
    return [number for number, zone in enumerate(zones) if zone in ZONES]
