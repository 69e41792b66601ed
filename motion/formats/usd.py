"""OpenUSD as text (.usda): two skinned, animated people and their things, for Blender, Houdini, Maya, Unreal …

Each person is a scope called by their role with a UsdSkel root: a skeleton of 22 joints and 30 of fingers, its
animation, and a body of :mod:`motion.body` bound to it. The stage is in metres and Y up, and a time code is a frame.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from pathlib import Path

import numpy as np

from motion.body import Body
from motion.clip import Duet
from motion.colours import linear

from .files import write_files
from .glb_nodes import quaternions
from .skinned import ABOVE, JOINTS, Skinned, check_rest_pose, skinned
from .usd_text import identifier, matrices, rows, samples, tuple_of
from .usd_things import things_text

_AROUND = 0.4
"""Metres from the joints to the edge of the box that holds a body."""
_ONES = f"[{', '.join(['(1, 1, 1)'] * len(JOINTS))}]"


def write_usd(duet: Duet, path: str | Path) -> list[Path]:
    """Writes one .usda with both people, named by their roles.

    Args:
        duet: on SMPL22.
        path: of the file.

    Returns:
        the path, in a list as for every format.

    Raises:
        InputError: for people who are not on SMPL22, or where the file cannot be written.
    """
    check_rest_pose(duet, "USD")
    return write_files({Path(path): usd_text(duet).encode()})


def usd_text(duet: Duet) -> str:
    """The file's text."""
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
"""


def _person(person: Skinned, name: str) -> str:
    body, positions = person.body, person.positions
    # USD stores rows: points stand to the left of matrices.
    rest = np.tile(np.eye(4), (len(JOINTS), 1, 1))
    rest[:, 3, :3] = person.offsets
    bind = np.tile(np.eye(4), (len(JOINTS), 1, 1))
    bind[:, :3, :3] = person.bound_turns
    bind[:, 3, :3] = person.bound_places
    place = f"/duet/{name}/person"
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
                rel skel:skeleton = <{place}/{name}>
{_surface(person)}
{_subsets(body, place)}            }}
{_materials(body, place, person.colours)}        }}
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


def _surface(person: Skinned) -> str:
    """The body as it is bound; each vertex follows four joints."""
    body, weights = person.body, np.round(person.weights, 6)
    joints = np.where(weights > 0, person.bones, 0)
    four = '(\nelementSize = 4\ninterpolation = "vertex"\n)'
    return f"""                uniform token subdivisionScheme = "none"
                float3[] extent = {rows(np.stack([body.vertices.min(axis=0), body.vertices.max(axis=0)]))}
                int[] faceVertexCounts = {[3] * len(body.faces)}
                int[] faceVertexIndices = {body.faces.reshape(-1).tolist()}
                point3f[] points = {rows(body.vertices)}
                int[] primvars:skel:jointIndices = {joints.reshape(-1).tolist()} {four}
                float[] primvars:skel:jointWeights = {weights.reshape(-1).tolist()} {four}
                matrix4d primvars:skel:geomBindTransform = {matrices(np.eye(4)[None])[1:-1]}"""


def _subsets(body: Body, place: str) -> str:
    """The faces of each zone, bound to its material."""
    return "".join(f"""
                def GeomSubset "{zone}" (
                    prepend apiSchemas = ["MaterialBindingAPI"]
                )
                {{
                    uniform token elementType = "face"
                    uniform token familyName = "materialBind"
                    int[] indices = {np.flatnonzero(body.face_zones == number).tolist()}
                    rel material:binding = <{place}/{zone}>
                }}
""" for number, zone in enumerate(body.zones))  # fmt: skip


def _materials(body: Body, place: str, colours: Mapping[str, str]) -> str:
    return "".join(f"""
            def Material "{zone}"
            {{
                token outputs:surface.connect = <{place}/{zone}/surface.outputs:surface>

                def Shader "surface"
                {{
                    uniform token info:id = "UsdPreviewSurface"
                    color3f inputs:diffuseColor = {tuple_of(np.round(linear(colours[zone]), 5))}
                    float inputs:roughness = 0.8
                    token outputs:surface
                }}
            }}
""" for zone in body.zones)  # fmt: skip


def _paths() -> Iterable[str]:
    """The joints as USD calls them: "pelvis/left_hip/left_knee"."""
    found: list[str] = []
    for name, parent in zip(JOINTS, ABOVE, strict=True):
        found.append(f"{found[parent]}/{name}" if parent >= 0 else name)
    return found


_PATHS = json.dumps(list(_paths()))
