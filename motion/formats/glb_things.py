"""Things in a glTF file: a node with a mesh each, moved by the file's animation where they move."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from motion.body import vertex_normals
from motion.colours import hex_of, linear
from motion.things.thing import Mesh, Thing

from .glb_buffer import Buffer
from .glb_nodes import quaternions

if TYPE_CHECKING:
    import pygltflib

ROUGH = 0.75


def names_of(things: Sequence[Thing]) -> list[str]:
    """A name for each, with a number where several are called the same."""
    found: list[str] = []
    for thing in things:
        count = sum(1 for other in found if other == thing.name or other.startswith(f"{thing.name} "))
        found.append(f"{thing.name} {count + 1}" if count else thing.name)
    return found


def add_things(buffer: Buffer, things: Sequence[Thing], times: int) -> None:
    """Adds things to the file's first scene and its first animation.

    Args:
        buffer: of the file.
        things: beside the people.
        times: accessor of the seconds of the frames.
    """
    import pygltflib as gl

    gltf = buffer.gltf
    for thing, name in zip(things, names_of(things), strict=True):
        gltf.meshes.append(gl.Mesh(name=name, primitives=list(_primitives(buffer, thing.mesh, name))))
        turns = quaternions(thing.rotations.astype(np.float64))
        node = gl.Node(name=name, mesh=len(gltf.meshes) - 1)
        node.translation, node.rotation = thing.places[0].tolist(), turns[0].tolist()
        gltf.nodes.append(node)
        gltf.scenes[0].nodes.append(len(gltf.nodes) - 1)
        if not thing.moves:
            continue
        for path, values in (("translation", thing.places), ("rotation", turns)):
            buffer.animate(len(gltf.nodes) - 1, path, values, times)


def _primitives(buffer: Buffer, mesh: Mesh, name: str) -> Iterator[pygltflib.Primitive]:
    """A primitive and a material for each colour."""
    import pygltflib as gl

    normals = unit_normals(mesh)
    attributes = gl.Attributes(
        POSITION=buffer.add(mesh.vertices, gl.VEC3, target=gl.ARRAY_BUFFER, bounds=True),
        NORMAL=buffer.add(normals.astype(np.float32), gl.VEC3, target=gl.ARRAY_BUFFER),
    )
    colours, which = mesh.by_colour()
    for number, colour in enumerate(colours.tolist()):
        light = [*linear(hex_of(colour)), 1.0]
        surface = gl.PbrMetallicRoughness(baseColorFactor=light, metallicFactor=0.0, roughnessFactor=ROUGH)
        buffer.gltf.materials.append(gl.Material(name=f"{name}_{number + 1}", pbrMetallicRoughness=surface))
        corners = mesh.faces[which == number].astype(np.uint16).reshape(-1)
        indices = buffer.add(corners, gl.SCALAR, target=gl.ELEMENT_ARRAY_BUFFER)
        yield gl.Primitive(attributes=attributes, indices=indices, material=len(buffer.gltf.materials) - 1)


def unit_normals(mesh: Mesh) -> NDArray[np.floating]:
    """(V, 3) normals of a thing's vertices; upwards where all triangles of one have no area."""
    normals = vertex_normals(mesh.vertices.astype(np.float64), mesh.faces)
    normals[np.linalg.norm(normals, axis=1) < 0.5] = (0.0, 1.0, 0.0)
    return normals / np.linalg.norm(normals, axis=1, keepdims=True)
