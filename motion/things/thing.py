"""Things beside two people: a surface and its own track of places and rotations."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from motion.errors import InputError
from motion.vectors import Array

MOST_THINGS = 12
"""Things beside a motion, at most."""
MOST_VERTICES = 20_000
"""Vertices of one thing, at most: what the player can draw beside two bodies."""
MOST_FACES = 20_000
"""Triangles of one thing, at most."""


@dataclass(frozen=True, eq=False)
class Mesh:
    """The surface of a thing, in its own frame.

    Furniture stands on its origin and faces +Z; what hands hold has its origin where the hand is and points along +Y.
    A vertex belongs to smoothly joined triangles alone, so that a sharp edge has its vertices twice.

    Attributes:
        vertices: (V, 3) float32 metres.
        faces: (F, 3) vertex indices, counter-clockwise seen from outside.
        colours: (F, 3) uint8 sRGB of each triangle.
    """

    vertices: Array = field(repr=False)
    faces: NDArray[np.integer] = field(repr=False)
    colours: NDArray[np.uint8] = field(repr=False)

    def __post_init__(self) -> None:
        vertices = np.asarray(self.vertices, dtype=np.float32)
        faces, colours = np.asarray(self.faces, dtype=np.int64), np.asarray(self.colours, dtype=np.uint8)
        if vertices.ndim != 2 or vertices.shape[1] != 3 or not 3 <= len(vertices) <= MOST_VERTICES:
            raise InputError(f"A thing has 3 to {MOST_VERTICES:,} vertices (V, 3), not {vertices.shape}.")
        if faces.ndim != 2 or faces.shape[1] != 3 or not 1 <= len(faces) <= MOST_FACES:
            raise InputError(f"A thing has 1 to {MOST_FACES:,} triangles (F, 3), not {faces.shape}.")
        if colours.shape != faces.shape:
            raise InputError(f"A thing has one colour per triangle, not {colours.shape} for {faces.shape}.")
        if not np.isfinite(vertices).all() or faces.min() < 0 or faces.max() >= len(vertices):
            raise InputError("The surface of a thing is damaged: its vertices are not finite, or a corner is missing.")
        for name, value in (("vertices", vertices), ("faces", faces), ("colours", colours)):
            object.__setattr__(self, name, value)

    @property
    def size(self) -> Array:
        """(3,) metres along each of its axes."""
        return np.ptp(self.vertices, axis=0)

    def by_colour(self, most: int = 32) -> tuple[NDArray[np.uint8], NDArray[np.integer]]:
        """Its different colours (C, 3) and, for each triangle (F,), the number of its own.

        Where there are more than ``most``, near ones become one.
        """
        step, colours = 1, self.colours.astype(np.int64)
        while True:
            coarse = np.minimum(colours // step * step + step // 2, 255)
            palette, which = np.unique(coarse, axis=0, return_inverse=True)
            if len(palette) <= most:
                return palette.astype(np.uint8), which.reshape(-1)
            step *= 2

    def spots(self) -> Array:
        """(N, 4) a few places in its own frame and the square metres about each, for soft shadows."""
        corners = self.vertices[self.faces].astype(np.float64)
        area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
        middles = corners.mean(axis=1)
        cell = max(float(self.size.max()) / 4, 0.05)
        keys = np.floor(middles / cell).astype(np.int64)
        _, group = np.unique(keys, axis=0, return_inverse=True)
        group = group.reshape(-1)
        total = np.maximum(np.bincount(group, weights=area), 1e-12)
        places = [np.bincount(group, weights=area * middles[:, axis]) / total for axis in range(3)]
        return np.stack([*places, total], axis=1)


@dataclass(frozen=True, eq=False)
class Thing:
    """One thing and where it is in each frame.

    Attributes:
        kind: what it is, such as "chair"; one of :data:`motion.things.KINDS`.
        mesh: its surface.
        places: (T, 3) float32 metres of its origin, in the people's world.
        rotations: (T, 3, 3) float32.
        name: what the words call it; the kind by default.
    """

    kind: str
    mesh: Mesh
    places: Array = field(repr=False)
    rotations: Array = field(repr=False)
    name: str = ""

    def __post_init__(self) -> None:
        places = np.asarray(self.places, dtype=np.float32)
        rotations = np.asarray(self.rotations, dtype=np.float32)
        if places.ndim != 2 or places.shape[1] != 3 or rotations.shape != (len(places), 3, 3):
            raise InputError(
                f"The track of a thing is places (T, 3) and rotations (T, 3, 3), not {places.shape} and "
                f"{rotations.shape}."
            )
        square = np.swapaxes(rotations, 1, 2) @ rotations - np.eye(3, dtype=np.float32)
        turned = np.abs(square).max(initial=0.0) < 0.01 and (np.linalg.det(rotations) > 0).all()
        if not np.isfinite(places).all() or not turned:
            raise InputError("The track of a thing holds places that are not finite, or matrices that do not rotate.")
        object.__setattr__(self, "places", places)
        object.__setattr__(self, "rotations", rotations)
        object.__setattr__(self, "name", self.name or self.kind)

    @classmethod
    def at_rest(cls, kind: str, mesh: Mesh, place: Array, yaw: float | Array, frames: int, name: str = "") -> Thing:
        """A thing that stands still, turned by ``yaw`` radians about the vertical from +Z towards +X."""
        turned = np.array([[np.cos(yaw), 0.0, np.sin(yaw)], [0.0, 1.0, 0.0], [-np.sin(yaw), 0.0, np.cos(yaw)]])
        return cls(kind, mesh, np.tile(place, (frames, 1)), np.tile(turned, (frames, 1, 1)), name)

    @property
    def num_frames(self) -> int:
        """Length of its track in frames."""
        return len(self.places)

    @property
    def moves(self) -> bool:
        """True if it does not keep one place and rotation all along."""
        still = np.ptp(self.places, axis=0).max(initial=0.0) < 1e-5
        return not (still and np.ptp(self.rotations, axis=0).max(initial=0.0) < 1e-5)

    def cut(self, start: int = 0, stop: int | None = None) -> Thing:
        """Frames ``start`` to ``stop`` (exclusive) of its track."""
        return replace(self, places=self.places[start:stop], rotations=self.rotations[start:stop])

    def at(self, frame: float) -> Array:
        """(V, 3) metres, its surface at a frame, which may lie between two."""
        last = self.num_frames - 1
        now = float(np.clip(frame, 0, last))
        before = min(int(now), max(last - 1, 0))
        share = now - before
        after = min(before + 1, last)
        place = (1 - share) * self.places[before] + share * self.places[after]
        turned = (1 - share) * self.rotations[before] + share * self.rotations[after]
        u, _, v = np.linalg.svd(turned)  # the nearest rotation
        return self.mesh.vertices @ (u @ v).T + place
