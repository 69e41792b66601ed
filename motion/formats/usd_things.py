"""Things in a .usda: an Xform with a mesh each, moved by time samples where they move."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from motion.colours import hex_of
from motion.things.thing import Thing

from .glb_buffer import unit_normals
from .glb_things import ROUGH, names_of
from .usd_text import identifier, materials, matrices, rows, subsets, surface


def things_text(things: Sequence[Thing], taken: Sequence[str]) -> str:
    """Prims of things for the root of the stage; ``taken`` are the names of the prims beside them."""
    used = [name.lower() for name in taken]
    found = []
    for thing, called in zip(things, names_of(things), strict=True):
        name = identifier(called, "thing")
        while name.lower() in used:
            name += "_"
        used.append(name.lower())
        found.append(_thing(thing, name))
    return "".join(found)


def _thing(thing: Thing, name: str) -> str:
    place = np.tile(np.eye(4), (thing.num_frames, 1, 1))  # USD stores rows: points stand to the left
    place[:, :3, :3] = np.swapaxes(thing.rotations, 1, 2)
    place[:, 3, :3] = thing.places
    if thing.moves:
        frames = "".join(f"{frame}: {matrices(each[None])[1:-1]},\n" for frame, each in enumerate(place))
        track = f"xformOp:transform.timeSamples = {{\n{frames}}}"
    else:
        track = f"xformOp:transform = {matrices(place[:1])[1:-1]}"
    mesh, prim = thing.mesh, f"/duet/{name}"
    colours, which = mesh.by_colour()
    shades = {f"colour_{number}": hex_of(colour) for number, colour in enumerate(colours.tolist(), 1)}
    zones = {zone: np.flatnonzero(which == number) for number, zone in enumerate(shades)}
    return f"""
    def Xform "{name}"
    {{
        matrix4d {track}
        uniform token[] xformOpOrder = ["xformOp:transform"]

        def Mesh "{name}_mesh" (
            prepend apiSchemas = ["MaterialBindingAPI"]
        )
        {{{surface(mesh.vertices, mesh.faces)}
            normal3f[] normals = {rows(unit_normals(mesh.vertices, mesh.faces))} (
                interpolation = "vertex"
            )
{subsets(zones, prim)}        }}
{materials(shades, prim, ROUGH)}    }}
"""
