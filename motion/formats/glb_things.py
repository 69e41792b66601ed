"""Things in a glTF file: a node with a mesh each, moved by the file's animation where they move."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from motion.colours import hex_of, linear
from motion.things.thing import Thing

from .glb_buffer import Buffer
from .glb_nodes import quaternions

ROUGH = 0.75


def names_of(things: Sequence[Thing]) -> list[str]:
    """A name for each, with a number where several are called the same."""
    found: list[str] = []
    for thing in things:
        count = sum(1 for other in found if other == thing.name or other.startswith(f"{thing.name} "))
        found.append(f"{thing.name} {count + 1}" if count else thing.name)
    return found


def add_things(buffer: Buffer, things: Sequence[Thing], times: int) -> None:
    """Adds things to the file's first scene and its animation.

    Args:
        buffer: of the file.
        things: beside the people.
        times: accessor of the seconds of the frames.
    """
    for thing, name in zip(things, names_of(things), strict=True):
        vertices = buffer.vertices(thing.mesh.vertices, thing.mesh.faces)
        colours, which = thing.mesh.by_colour()
        parts = [  # one for each colour
            buffer.primitive(vertices, thing.mesh.faces[which == number], f"{name}_{number + 1}", light, ROUGH)
            for number, light in enumerate([*linear(hex_of(colour))] for colour in colours.tolist())
        ]
        mesh = buffer.append("meshes", {"name": name, "primitives": parts})
        turns = quaternions(thing.rotations.astype(np.float64))
        places = {"translation": thing.places[0].tolist(), "rotation": turns[0].tolist()}
        node = buffer.append("nodes", {"name": name, "mesh": mesh, **places})
        buffer.document["scenes"][0]["nodes"].append(node)
        for path, values in (("translation", thing.places), ("rotation", turns)) if thing.moves else ():
            buffer.animate(node, path, values, times)
