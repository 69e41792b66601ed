"""glTF binary: two skinned, animated people and their things in one file, as 3D programs and browsers play them.

Each person is a node called by their role that carries 22 joints and 30 of fingers, and a body of :mod:`motion.body`
bound to them. One animation turns all joints and moves both roots. glTF's axes are ours: Y up, right-handed, metres.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from motion.clip import Duet
from motion.colours import linear
from motion.skeleton import SMPL22

from .files import check_smpl, write_files
from .glb_buffer import Buffer
from .glb_nodes import quaternions
from .glb_things import add_things
from .skinned import ABOVE, JOINTS, Skinned, skinned

_CHILDREN = [[joint for joint, above in enumerate(ABOVE) if above == parent] for parent in range(len(JOINTS))]
"""The joints below each."""


def write_glb(duet: Duet, path: str | Path) -> list[Path]:
    """Writes one .glb with both people, named by their roles, and one animation.

    Args:
        duet: on SMPL22.
        path: of the file.

    Returns:
        the path, in a list as for every format.

    Raises:
        InputError: for people who are not on SMPL22, or where the file cannot be written.
    """
    check_smpl(duet, "glTF")
    return write_files({Path(path): glb_bytes(duet)})


def glb_bytes(duet: Duet) -> bytes:
    """The file's bytes."""
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
    found = []
    for zone, name in enumerate(body.zones):
        if len(faces := body.faces[body.face_zones == zone]):
            colour = linear(person.colours[name])
            found.append(buffer.primitive(vertices, faces, f"{person.role}_{name}", [*colour], 0.8))
    return found
