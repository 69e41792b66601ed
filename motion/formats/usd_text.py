"""Numbers, names, surfaces and materials as OpenUSD's text has them."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from motion.colours import linear

Array = NDArray[np.floating]


def identifier(called: str, other: str) -> str:
    """A name as that of a prim: ASCII letters, digits and underscores, no digit first; ``other`` where none is left."""
    name = re.sub(r"\W+", "_", called, flags=re.ASCII).strip("_")[:40] or other
    return f"_{name}" if name[0].isdigit() else name


def tuple_of(values: Any) -> str:
    """Numbers as a tuple."""
    return str(tuple(np.asarray(values).tolist()))


def rows(values: Array) -> str:
    """(N, k) numbers as an array of tuples."""
    return str(list(map(tuple, np.round(values.astype(np.float64), 6).tolist())))


def matrices(values: Array) -> str:
    """(N, 4, 4) as an array of tuples of rows."""
    return str([tuple(map(tuple, each)) for each in np.round(values, 7).tolist()])


def samples(values: Array) -> str:
    """(T, N, k) as an array of tuples for each frame."""
    frames = "".join(f"{frame}: {rows(each)},\n" for frame, each in enumerate(values))
    return f"{{\n{frames}}}"


def surface(vertices: Array, faces: NDArray[np.integer]) -> str:
    """Attributes of a mesh of triangles."""
    return f"""
    uniform token subdivisionScheme = "none"
    float3[] extent = {rows(np.stack([vertices.min(axis=0), vertices.max(axis=0)]))}
    int[] faceVertexCounts = {[3] * len(faces)}
    int[] faceVertexIndices = {faces.reshape(-1).tolist()}
    point3f[] points = {rows(vertices)}"""


def subsets(zones: Mapping[str, NDArray[np.integer]], place: str) -> str:
    """A mesh's triangles by zones, each bound to the material of the zone's name at a place."""
    return "".join(
        f"""
    def GeomSubset "{zone}" (
        prepend apiSchemas = ["MaterialBindingAPI"]
    )
    {{
        uniform token elementType = "face"
        uniform token familyName = "materialBind"
        int[] indices = {indices.tolist()}
        rel material:binding = <{place}/{zone}>
    }}
"""
        for zone, indices in zones.items()
    )


def materials(colours: Mapping[str, str], place: str, rough: float) -> str:
    """A material for each zone, of a hex colour, at a place."""
    return "".join(
        f"""
    def Material "{zone}"
    {{
        token outputs:surface.connect = <{place}/{zone}/surface.outputs:surface>

        def Shader "surface"
        {{
            uniform token info:id = "UsdPreviewSurface"
            color3f inputs:diffuseColor = {tuple_of(np.round(linear(colour), 5))}
            float inputs:roughness = {rough}
            token outputs:surface
        }}
    }}
"""
        for zone, colour in colours.items()
    )
