"""glTF binary: two skinned, animated people and their things in one file, as 3D programs and browsers play them.

Each person is a node called by their role that carries 22 joints and 30 of fingers, and a body of :mod:`motion.body`
bound to them. One animation turns all joints and moves both roots. glTF's axes are ours: Y up, right-handed, metres.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from motion.body import vertex_normals
from motion.clip import Duet
from motion.colours import linear
from motion.skeleton import SMPL22

from .files import write_files
from .glb_buffer import Buffer
from .glb_nodes import quaternions
from .glb_things import add_things
from .skinned import ABOVE, JOINTS, Skinned, check_rest_pose, skinned

if TYPE_CHECKING:
    import pygltflib


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
    check_rest_pose(duet, "glTF")
    return write_files({Path(path): glb_bytes(duet)})


def glb_bytes(duet: Duet) -> bytes:
    """The file's bytes."""
    import pygltflib as gl

    gltf = gl.GLTF2(
        asset=gl.Asset(version="2.0", generator="Pas de Deux"),
        scene=0,
        scenes=[gl.Scene(name="duet", nodes=[])],
        animations=[gl.Animation(name="duet")],
    )
    if duet.manifest:
        gltf.asset.extras = {"manifest": json.loads(json.dumps(duet.manifest, default=str))}
    buffer = Buffer(gltf)
    times = buffer.add((np.arange(duet.num_frames) / duet.fps).astype(np.float32), gl.SCALAR, bounds=True)
    for person in skinned(duet):
        _add_person(buffer, person, times)
    add_things(buffer, duet.things, times)
    buffer.data += bytes(-len(buffer.data) % 4)
    gltf.buffers.append(gl.Buffer(byteLength=len(buffer.data)))
    gltf.set_binary_blob(bytes(buffer.data))
    return b"".join(gltf.save_to_bytes())


def _add_person(buffer: Buffer, person: Skinned, times: int) -> None:
    import pygltflib as gl

    gltf, role = buffer.gltf, person.role
    holder = len(gltf.nodes)
    first = holder + 1
    # A node of the person's own above the joints: programs make one armature of each, not one of both.
    gltf.nodes.append(gl.Node(name=role, children=[first]))
    turns = [quaternions(each) for each in np.swapaxes(person.turns, 0, 1)]
    for joint, name in enumerate(JOINTS):
        node = gl.Node(name=f"{role}_{name}", children=[first + child for child in _CHILDREN[joint]])
        # Without its animation a person stands in T-pose where they begin.
        node.translation = person.offsets[joint].tolist()
        if joint >= SMPL22.num_joints:
            node.rotation = turns[joint][0].tolist()
        gltf.nodes.append(node)

    inverse = np.tile(np.eye(4), (len(JOINTS), 1, 1))
    inverse[:, :3, :3] = person.bound_turns
    inverse[:, :3, 3] = -np.einsum("jik,jk->ji", person.bound_turns, person.bound_places)
    columns = np.swapaxes(inverse, 1, 2).reshape(-1, 16).astype(np.float32)  # glTF stores columns first
    joints = list(range(first, first + len(JOINTS)))
    gltf.skins.append(
        gl.Skin(name=role, joints=joints, skeleton=first, inverseBindMatrices=buffer.add(columns, gl.MAT4))
    )
    gltf.meshes.append(gl.Mesh(name=f"{role}_body", primitives=_surface(buffer, person)))
    # A skinned mesh belongs at the top: what stands above it does not move it.
    gltf.nodes.append(gl.Node(name=f"{role}_body", mesh=len(gltf.meshes) - 1, skin=len(gltf.skins) - 1))
    gltf.scenes[0].nodes += [holder, len(gltf.nodes) - 1]

    buffer.animate(first, "translation", person.positions[:, 0], times)
    for joint, quats in enumerate(turns):
        if joint < SMPL22.num_joints or np.ptp(quats, axis=0).max() > 1e-6:  # a hand may keep its shape
            buffer.animate(first + joint, "rotation", quats, times)


def _surface(buffer: Buffer, person: Skinned) -> list[pygltflib.Primitive]:
    """The body's surface in its pose of binding: a primitive and a material for skin, top, shoes and so on."""
    import pygltflib as gl

    body = person.body
    normals = vertex_normals(body.vertices, body.faces)
    normals[np.linalg.norm(normals, axis=1) < 0.5] = (0.0, 1.0, 0.0)  # of a vertex whose faces have no area
    attributes = gl.Attributes(
        POSITION=buffer.add(body.vertices.astype(np.float32), gl.VEC3, target=gl.ARRAY_BUFFER, bounds=True),
        NORMAL=buffer.add(normals.astype(np.float32), gl.VEC3, target=gl.ARRAY_BUFFER),
        JOINTS_0=buffer.add(person.bones.astype(np.uint8), gl.VEC4, target=gl.ARRAY_BUFFER),
        WEIGHTS_0=buffer.add(person.weights.astype(np.float32), gl.VEC4, target=gl.ARRAY_BUFFER),
    )
    found = []
    for zone, name in enumerate(body.zones):
        faces = body.faces[body.face_zones == zone]
        if not len(faces):
            continue
        colour = [*linear(person.colours[name]), 1.0]
        surface = gl.PbrMetallicRoughness(baseColorFactor=colour, metallicFactor=0.0, roughnessFactor=0.8)
        buffer.gltf.materials.append(gl.Material(name=f"{person.role}_{name}", pbrMetallicRoughness=surface))
        indices = buffer.add(faces.astype(np.uint16).reshape(-1), gl.SCALAR, target=gl.ELEMENT_ARRAY_BUFFER)
        material = len(buffer.gltf.materials) - 1
        found.append(gl.Primitive(attributes=attributes, indices=indices, material=material))
    return found
