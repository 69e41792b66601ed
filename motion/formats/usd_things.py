"""Things in a .usda: an Xform with a mesh each, moved by time samples where they move."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from motion.colours import hex_of, linear
from motion.things.thing import Mesh, Thing

from .glb_buffer import unit_normals
from .glb_things import ROUGH, names_of
from .usd_text import identifier, matrices, rows, tuple_of


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
    return f"""
    def Xform "{name}"
    {{
        matrix4d {track}
        uniform token[] xformOpOrder = ["xformOp:transform"]

        def Mesh "{name}_mesh" (
            prepend apiSchemas = ["MaterialBindingAPI"]
        )
        {{
{_surface(thing.mesh, f"/duet/{name}")}        }}
{_materials(thing.mesh, f"/duet/{name}")}    }}
"""


def _surface(mesh: Mesh, place: str) -> str:
    _, which = mesh.by_colour()
    subsets = "".join(f"""
            def GeomSubset "colour_{number + 1}" (
                prepend apiSchemas = ["MaterialBindingAPI"]
            )
            {{
                uniform token elementType = "face"
                uniform token familyName = "materialBind"
                int[] indices = {np.flatnonzero(which == number).tolist()}
                rel material:binding = <{place}/colour_{number + 1}>
            }}
""" for number in range(int(which.max()) + 1))  # fmt: skip
    box = np.stack([mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)])
    return f"""            uniform token subdivisionScheme = "none"
            float3[] extent = {rows(box)}
            int[] faceVertexCounts = {[3] * len(mesh.faces)}
            int[] faceVertexIndices = {mesh.faces.reshape(-1).tolist()}
            point3f[] points = {rows(mesh.vertices)}
            normal3f[] normals = {rows(unit_normals(mesh.vertices, mesh.faces))} (
                interpolation = "vertex"
            )
{subsets}"""


def _materials(mesh: Mesh, place: str) -> str:
    colours, _ = mesh.by_colour()
    return "".join(f"""
        def Material "colour_{number + 1}"
        {{
            token outputs:surface.connect = <{place}/colour_{number + 1}/surface.outputs:surface>

            def Shader "surface"
            {{
                uniform token info:id = "UsdPreviewSurface"
                color3f inputs:diffuseColor = {tuple_of(np.round(linear(hex_of(colour)), 5))}
                float inputs:roughness = {ROUGH}
                token outputs:surface
            }}
        }}
""" for number, colour in enumerate(colours.tolist()))  # fmt: skip
