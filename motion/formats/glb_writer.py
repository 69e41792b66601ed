"""glTF binary: two skinned, animated people and their things in one file, as 3D programs and browsers play them.

Each person is a node called by their role that carries 22 joints and 30 of fingers, and a body of :mod:`motion.body`
bound to them. One animation turns all joints and moves both roots. glTF's axes are ours: Y up, right-handed, metres.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from motion.body import vertex_normals
from motion.clip import Duet
from motion.kinematics import quaternions
from motion.looks import hex_of, linear
from motion.skeleton import SMPL22
from motion.things.thing import Thing

from .files import check_smpl
from .glb_file import packed
from .skinned import ABOVE, JOINTS, Skinned, skinned

_CHILDREN = [[joint for joint, above in enumerate(ABOVE) if above == parent] for parent in range(len(JOINTS))]
"""The joints below each."""


def glb_bytes(duet: Duet) -> bytes:
    """One .glb with both people, named by their roles, and one animation.

    Raises:
        InputError: for people who are not on SMPL22.
    """
    check_smpl(duet, "glTF")
    asset: dict[str, Any] = {"version": "2.0", "generator": "Pas de Deux"}
    if duet.manifest:
        asset["extras"] = {"manifest": json.loads(json.dumps(duet.manifest, default=str))}
    scene: dict[str, Any] = {"name": "duet", "nodes": []}
    buffer = Buffer({"asset": asset, "scene": 0, "scenes": [scene], "animations": [{"name": "duet"}]})
    times = buffer.clock(duet.num_frames, duet.fps)
    for person in skinned(duet):
        _add_person(buffer, person, times)
    add_things(buffer, duet.things, times)
    return buffer.packed()


def _add_person(buffer: Buffer, person: Skinned, times: int) -> None:
    role = person.role
    # A node of the person's own above the joints: programs make one armature of each, not one of both.
    holder = buffer.append("nodes", {"name": role})
    first = holder + 1
    buffer.document["nodes"][holder]["children"] = [first]
    turns = [quaternions(each) for each in np.swapaxes(person.turns, 0, 1)]
    for joint, name in enumerate(JOINTS):
        # Without its animation a person stands in T-pose where they begin.
        node = {"name": f"{role}_{name}", "translation": person.offsets[joint].tolist()}
        if _CHILDREN[joint]:
            node["children"] = [first + child for child in _CHILDREN[joint]]
        if joint >= SMPL22.num_joints:
            node["rotation"] = turns[joint][0].tolist()
        buffer.append("nodes", node)

    inverse = np.tile(np.eye(4), (len(JOINTS), 1, 1))
    inverse[:, :3, :3] = person.bound_turns
    inverse[:, :3, 3] = -np.einsum("jik,jk->ji", person.bound_turns, person.bound_places)
    columns = np.swapaxes(inverse, 1, 2).reshape(-1, 16).astype(np.float32)  # glTF stores columns first
    joints = list(range(first, first + len(JOINTS)))
    bound = {"name": role, "joints": joints, "skeleton": first, "inverseBindMatrices": buffer.add(columns)}
    skin = buffer.append("skins", bound)
    mesh = buffer.append("meshes", {"name": f"{role}_body", "primitives": _surface(buffer, person)})
    # A skinned mesh belongs at the top: what stands above it does not move it.
    shown = buffer.append("nodes", {"name": f"{role}_body", "mesh": mesh, "skin": skin})
    buffer.document["scenes"][0]["nodes"] += [holder, shown]

    buffer.animate(first, "translation", person.positions[:, 0], times)
    for joint, quats in enumerate(turns):
        if joint < SMPL22.num_joints or np.ptp(quats, axis=0).max() > 1e-6:  # a hand may keep its shape
            buffer.animate(first + joint, "rotation", quats, times)


def _surface(buffer: Buffer, person: Skinned) -> list[dict[str, Any]]:
    """The body's surface in its pose of binding: a primitive and a material for skin, top, shoes and so on."""
    body = person.body
    bones, weights = person.bones.astype(np.uint8), person.weights.astype(np.float32)
    vertices = buffer.vertices(body.vertices, body.faces, JOINTS_0=bones, WEIGHTS_0=weights)
    primitives = []
    for zone, name in enumerate(body.zones):
        if len(faces := body.faces[body.face_zones == zone]):
            colour = linear(person.colours[name])
            primitives.append(buffer.primitive(vertices, faces, f"{person.role}_{name}", [*colour], 0.8))
    return primitives


# ---- A file that is being written -----------------------------------------------------------------------------------
Array = NDArray[Any]

_COMPONENTS = {"f": 5126, "H": 5123, "B": 5121}
_KINDS = {1: "SCALAR", 3: "VEC3", 4: "VEC4", 16: "MAT4"}
_CORNERS, _INDICES = 34962, 34963
"""glTF's numbers for what a part of the buffer is used for."""


class Buffer:
    """A description whose lists grow with its numbers.

    Args:
        document: the description, with one animation that has a name.
    """

    def __init__(self, document: dict[str, Any]) -> None:
        self.document, self.data = document, bytearray()
        document["animations"][0] |= {"samplers": [], "channels": []}

    def append(self, key: str, part: dict[str, Any]) -> int:
        """Adds a part to one of the lists, such as "nodes", and returns its number."""
        parts = self.document.setdefault(key, [])
        parts.append(part)
        return len(parts) - 1

    def add(self, array: Array, *, target: int | None = None, bounds: bool = False) -> int:
        """Appends an array (N,) or (N, k), and returns the number of its accessor."""
        self.data += bytes(-len(self.data) % 4)
        view = {"buffer": 0, "byteOffset": len(self.data), "byteLength": array.nbytes}
        rows = np.ascontiguousarray(array).reshape(len(array), -1)
        self.data += rows.tobytes()
        accessor = {
            "bufferView": self.append("bufferViews", view | ({"target": target} if target else {})),
            "componentType": _COMPONENTS[array.dtype.char],
            "count": len(array),
            "type": _KINDS[rows.shape[1]],
        }
        if bounds:
            accessor |= {"min": rows.min(axis=0).tolist(), "max": rows.max(axis=0).tolist()}
        return self.append("accessors", accessor)

    def clock(self, frames: int, fps: float) -> int:
        """The accessor of the seconds of so many frames."""
        return self.add((np.arange(frames) / fps).astype(np.float32), bounds=True)

    def animate(self, node: int, path: str, values: Array, times: int) -> None:
        """Lets the file's animation move a node's ``path``: values (T, 3 or 4) at the accessor ``times``."""
        animation, output = self.document["animations"][0], self.add(values.astype(np.float32))
        animation["samplers"].append({"input": times, "output": output, "interpolation": "LINEAR"})
        target = {"node": node, "path": path}
        animation["channels"].append({"sampler": len(animation["samplers"]) - 1, "target": target})

    def vertices(self, places: Array, faces: NDArray[np.integer], **more: Array) -> dict[str, int]:
        """Attributes of a surface: places (V, 3), their normals, and arrays of other names."""
        return {
            "POSITION": self.add(places.astype(np.float32), target=_CORNERS, bounds=True),
            "NORMAL": self.add(unit_normals(places, faces).astype(np.float32), target=_CORNERS),
            **{name: self.add(array, target=_CORNERS) for name, array in more.items()},
        }

    def primitive(
        self, vertices: dict[str, int], faces: NDArray[np.integer], name: str, colour: list[float], rough: float
    ) -> dict[str, Any]:
        """Triangles of these vertices, in a material of their own of a linear colour (r, g, b)."""
        surface = {"baseColorFactor": [*colour, 1.0], "metallicFactor": 0.0, "roughnessFactor": rough}
        return {
            "attributes": vertices,
            "indices": self.add(faces.astype(np.uint16).reshape(-1), target=_INDICES),
            "material": self.append("materials", {"name": name, "pbrMetallicRoughness": surface}),
        }

    def packed(self) -> bytes:
        """The file's bytes."""
        self.document["buffers"] = [{"byteLength": len(self.data)}]
        return packed(self.document, bytes(self.data))


def unit_normals(vertices: Array, faces: NDArray[np.integer]) -> Array:
    """(V, 3) normals of vertices (V, 3); upwards where all triangles of one have no area."""
    normals = vertex_normals(vertices.astype(np.float64), faces)
    normals[np.linalg.norm(normals, axis=1) < 0.5] = (0.0, 1.0, 0.0)
    return normals / np.linalg.norm(normals, axis=1, keepdims=True)


# ---- Things: a node with a mesh each, moved by the file's animation where they move ---------------------------------
ROUGH = 0.75


def names_of(things: Sequence[Thing]) -> list[str]:
    """A name for each, with a number where several are called the same."""
    names: list[str] = []
    for thing in things:
        count = sum(1 for other in names if other == thing.name or other.startswith(f"{thing.name} "))
        names.append(f"{thing.name} {count + 1}" if count else thing.name)
    return names


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
