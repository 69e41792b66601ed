"""Things as pictures need them: finer where painters sort by depth, and as compact JSON for the player."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from motion.body import in_base64
from motion.clip import Clip, Duet
from motion.hands import angles
from motion.kinematics import quaternions
from motion.looks import hex_of
from motion.things import FIXTURES
from motion.things.thing import Mesh, Thing
from motion.vectors import Array

_FINE = 0.14
"""Metres of an edge, at most, where triangles are drawn from the farthest to the nearest."""
_MOST_FINE = 6000
"""Triangles to which a surface is divided, at most."""


def divided(mesh: Mesh) -> Mesh:
    """A surface whose edges are at most 14 cm long, as far as that takes no more than 6,000 triangles."""
    vertices, faces, colours = mesh.vertices.astype(np.float64), mesh.faces, mesh.colours
    while True:
        ends = vertices[faces]
        lengths = np.linalg.norm(np.roll(ends, -1, axis=1) - ends, axis=2)  # of ab, bc, ca
        long = lengths.max(axis=1) > _FINE
        if not long.any() or len(faces) + long.sum() > _MOST_FINE:
            return Mesh(vertices, faces, colours)
        # Each is cut in two across its longest edge.
        first = lengths[long].argmax(axis=1)
        a, b, c = (faces[long, (first + turn) % 3] for turn in range(3))
        middle = len(vertices) + np.arange(long.sum())
        vertices = np.concatenate([vertices, (vertices[a] + vertices[b]) / 2])
        halves = (np.stack([a, middle, c], axis=1), np.stack([middle, b, c], axis=1))
        faces = np.concatenate([faces[~long], *halves])
        colours = np.concatenate([colours[~long], np.tile(colours[long], (2, 1))])


def hands_of(motion: Clip | Duet, person: int, frames: Array) -> Array | None:
    """(T, 2, 20) finger shapes of a person at frames (T,), which may lie between two; None where they are relaxed."""
    grips = motion.grips if isinstance(motion, Duet) else ()
    return angles(grips, person, frames, motion.fps) if grips else None


def shadow_spots(things: Sequence[Thing], frame: float) -> Array:
    """(N, 4) places in the world, and the square metres about each, that shade the floor at a frame."""
    places = []
    for thing in things:
        spots = thing.mesh.spots()
        index = int(np.clip(round(frame), 0, thing.num_frames - 1))
        places.append(np.c_[spots[:, :3] @ thing.rotations[index].T + thing.places[index], spots[:, 3]])
    return np.concatenate(places) if places else np.zeros((0, 4))


def thing_payload(thing: Thing) -> dict[str, Any]:
    """A thing as ``static/player/things.js`` reads it; one that stands still has a track of one frame."""
    mesh = thing.mesh
    palette, which = mesh.by_colour(255)
    frames = thing.num_frames if thing.moves else 1
    turns = quaternions(thing.rotations[:frames].astype(np.float64))
    return {
        "kind": thing.kind,
        "stands": thing.kind in FIXTURES,
        "frames": frames,
        "vertices": in_base64(mesh.vertices, "<f4"),
        "faces": in_base64(mesh.faces, "<u2"),
        "face_colours": in_base64(which, "u1"),
        "palette": [hex_of(colour) for colour in palette.tolist()],
        "spots": mesh.spots().round(4).tolist(),
        "places": in_base64(thing.places[:frames], "<f4"),
        "turns": in_base64(np.rint(32767 * turns), "<i2"),
    }
