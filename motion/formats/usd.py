"""OpenUSD as text (.usda): two skinned, animated people and their things, for Blender, Houdini, Maya, Unreal …

Each person is a scope called by their role with a UsdSkel root: a skeleton of 22 joints and 30 of fingers, its
animation, and a body of :mod:`motion.body` bound to it. The stage is in metres and Y up, and a time code is a frame.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from motion.clip import Duet
from motion.kinematics import quaternions
from motion.looks import hex_of, linear
from motion.things.thing import Thing
from motion.vectors import Array

from .files import check_smpl
from .glb_writer import ROUGH, names_of, unit_normals
from .skinned import ABOVE, JOINTS, Skinned, skinned

_AROUND = 0.4
"""Metres from the joints to the edge of the box that holds a body."""
_ONES = f"[{', '.join(['(1, 1, 1)'] * len(JOINTS))}]"


def usd_bytes(duet: Duet) -> bytes:
    """One .usda with both people, named by their roles.

    Raises:
        InputError: for people who are not on SMPL22.
    """
    check_smpl(duet, "USD")
    names = [identifier(role, "person") for role in duet.roles]
    if names[0].lower() == names[1].lower():
        names = [f"{name}_{letter}" for name, letter in zip(names, "ab", strict=True)]
    # A string's escapes are those of JSON.
    manifest = json.dumps(json.dumps(duet.manifest or {}, default=str))
    people = (_person(person, name) for person, name in zip(skinned(duet), names, strict=True))
    return f"""#usda 1.0
(
    customLayerData = {{
        string creator = "Pas de Deux"
        string manifest = {manifest}
    }}
    defaultPrim = "duet"
    endTimeCode = {duet.num_frames - 1}
    framesPerSecond = {duet.fps:g}
    metersPerUnit = 1
    startTimeCode = 0
    timeCodesPerSecond = {duet.fps:g}
    upAxis = "Y"
)

def Xform "duet" (
    kind = "assembly"
)
{{
{"".join(people)}{things_text(duet.things, names)}}}
""".encode()


def _person(person: Skinned, name: str) -> str:
    body, positions = person.body, person.positions
    # USD stores rows: points stand to the left of matrices.
    rest = np.tile(np.eye(4), (len(JOINTS), 1, 1))
    rest[:, 3, :3] = person.offsets
    bind = np.tile(np.eye(4), (len(JOINTS), 1, 1))
    bind[:, :3, :3] = person.bound_turns
    bind[:, 3, :3] = person.bound_places
    place = f"/duet/{name}/person"
    zones = {zone: np.flatnonzero(body.face_zones == number) for number, zone in enumerate(body.zones)}
    colours = {zone: person.colours[zone] for zone in zones}
    box = np.stack([positions.min(axis=(0, 1)) - _AROUND, positions.max(axis=(0, 1)) + _AROUND])
    return f"""    def Scope "{name}"
    {{
        def SkelRoot "person"
        {{
            float3[] extent = {rows(box)}

            def Skeleton "{name}" (
                prepend apiSchemas = ["SkelBindingAPI"]
            )
            {{
                uniform token[] joints = {_PATHS}
                uniform matrix4d[] bindTransforms = {matrices(bind)}
                uniform matrix4d[] restTransforms = {matrices(rest)}
                rel skel:animationSource = <{place}/{name}/animation>
{_animation(person)}
            }}

            def Mesh "{name}_body" (
                prepend apiSchemas = ["SkelBindingAPI", "MaterialBindingAPI"]
            )
            {{
                rel skel:skeleton = <{place}/{name}>{surface(body.vertices, body.faces)}{_skinning(person)}
{subsets(zones, place)}            }}
{materials(colours, place, 0.8)}        }}
    }}
"""


def _animation(person: Skinned) -> str:
    """The motion: quaternions real part first, and where each joint is against the one above it."""
    turns = np.stack([quaternions(person.turns[:, joint]) for joint in range(len(JOINTS))], axis=1)
    places = np.repeat(person.offsets[None], len(turns), axis=0)
    places[:, 0] = person.positions[:, 0]
    return f"""
                def SkelAnimation "animation"
                {{
                    uniform token[] joints = {_PATHS}
                    quatf[] rotations.timeSamples = {samples(turns[..., [3, 0, 1, 2]])}
                    half3[] scales = {_ONES}
                    float3[] translations.timeSamples = {samples(places)}
                }}"""


def _skinning(person: Skinned) -> str:
    """Each vertex of the body follows four joints."""
    weights = np.round(person.weights, 6)
    joints = np.where(weights > 0, person.bones, 0)
    four = '(\nelementSize = 4\ninterpolation = "vertex"\n)'
    return f"""
                int[] primvars:skel:jointIndices = {joints.reshape(-1).tolist()} {four}
                float[] primvars:skel:jointWeights = {weights.reshape(-1).tolist()} {four}
                matrix4d primvars:skel:geomBindTransform = {matrices(np.eye(4)[None])[1:-1]}"""


def _paths() -> Iterable[str]:
    """The joints as USD calls them: "pelvis/left_hip/left_knee"."""
    paths: list[str] = []
    for name, parent in zip(JOINTS, ABOVE, strict=True):
        paths.append(f"{paths[parent]}/{name}" if parent >= 0 else name)
    return paths


_PATHS = json.dumps(list(_paths()))


# ---- Numbers, names, surfaces and materials as OpenUSD's text has them ----------------------------------------------
def identifier(called: str, other: str) -> str:
    """A name as that of a prim: ASCII letters, digits and underscores, no digit first; ``other`` where none is left."""
    name = re.sub(r"\W+", "_", called, flags=re.ASCII).strip("_")[:40] or other
    return f"_{name}" if name[0].isdigit() else name


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
            color3f inputs:diffuseColor = {tuple(np.round(linear(colour), 5).tolist())}
            float inputs:roughness = {rough}
            token outputs:surface
        }}
    }}
"""
        for zone, colour in colours.items()
    )


# ---- Things in a .usda -----------------------------------------------------------------------------------------------
def things_text(things: Sequence[Thing], taken: Sequence[str]) -> str:
    """Prims of things for the root of the stage; ``taken`` are the names of the prims beside them."""
    used = [name.lower() for name in taken]
    prims = []
    for thing, called in zip(things, names_of(things), strict=True):
        name = identifier(called, "thing")
        while name.lower() in used:
            name += "_"
        used.append(name.lower())
        prims.append(_thing(thing, name))
    return "".join(prims)


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
