"""glTF binary: two skinned, animated people and their things in one file, as 3D programs and browsers play them.

Each person is a node called by their role that carries 22 joints and 30 of fingers, and a body of :mod:`motion.body`
bound to them. One animation turns all joints and moves both roots. glTF's axes are ours: Y up, right-handed, metres.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from motion.body import BODIES, Body, bone_rotations, load_body, vertex_normals
from motion.clip import Clip, Duet
from motion.colours import BODIES as COLOURS
from motion.colours import linear
from motion.errors import InputError
from motion.hands import angles
from motion.kinematics import local_rotations
from motion.skeleton import SMPL22

from .files import write_files
from .glb_nodes import quaternions
from .glb_things import add_things
from .hand_rig import FINGER_JOINTS, PARENTS, HandRig

if TYPE_CHECKING:
    import pygltflib

Array = NDArray[np.floating]

_CHILDREN = [
    [joint for joint, above in enumerate((*SMPL22.parents, *PARENTS)) if above == parent]
    for parent in range(SMPL22.num_joints + len(PARENTS))
]
"""The joints below each, of SMPL22's and the fingers'."""


@dataclass
class Buffer:
    """The binary part of the file as it grows, and its views and accessors."""

    gltf: pygltflib.GLTF2
    data: bytearray = field(default_factory=bytearray)

    def add(self, array: Array, kind: str, *, target: int | None = None, bounds: bool = False) -> int:
        """Appends an array and returns the number of its accessor."""
        import pygltflib as gl

        component = {"f": gl.FLOAT, "H": gl.UNSIGNED_SHORT, "B": gl.UNSIGNED_BYTE}[array.dtype.char]
        self.data += bytes(-len(self.data) % 4)
        view = gl.BufferView(buffer=0, byteOffset=len(self.data), byteLength=array.nbytes, target=target)
        self.data += np.ascontiguousarray(array).tobytes()
        self.gltf.bufferViews.append(view)
        accessor = gl.Accessor(
            bufferView=len(self.gltf.bufferViews) - 1, componentType=component, count=len(array), type=kind
        )
        if bounds:
            rows = array.reshape(len(array), -1)
            accessor.min, accessor.max = rows.min(axis=0).tolist(), rows.max(axis=0).tolist()
        self.gltf.accessors.append(accessor)
        return len(self.gltf.accessors) - 1


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
    if duet.skeleton.joint_names != SMPL22.joint_names:
        raise InputError(
            f"glTF needs a rest pose, and {duet.skeleton.name} has none: retarget to SMPL22 first."
        )
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
    for name, clip, role, zones in zip(BODIES, duet.people, duet.roles, COLOURS, strict=True):
        shapes = angles(duet.grips, BODIES.index(name), np.arange(float(duet.num_frames)), duet.fps)
        _add_person(buffer, clip, role, load_body(name), zones, times, shapes)
    add_things(buffer, duet.things, times)
    buffer.data += bytes(-len(buffer.data) % 4)
    gltf.buffers.append(gl.Buffer(byteLength=len(buffer.data)))
    gltf.set_binary_blob(bytes(buffer.data))
    return b"".join(gltf.save_to_bytes())


def _add_person(
    buffer: Buffer, clip: Clip, role: str, body: Body, colours: Mapping[str, str], times: int, shapes: Array
) -> None:
    import pygltflib as gl

    gltf = buffer.gltf
    positions = clip.positions.astype(np.float64)
    world = bone_rotations(positions)
    offsets = bone_offsets(positions, world)
    holder = len(gltf.nodes)
    first = holder + 1
    # A node of the person's own above the joints: programs make one armature of each, not one of both.
    gltf.nodes.append(gl.Node(name=role, children=[first]))
    for joint, name in enumerate(SMPL22.joint_names):
        children = [first + child for child in _CHILDREN[joint]]
        node = gl.Node(name=f"{role}_{name}", children=children)
        # Without its animation a person stands in T-pose where they begin.
        node.translation = (positions[0, 0] if joint == 0 else offsets[joint]).tolist()
        gltf.nodes.append(node)
    rig = HandRig.of(body)
    fingers = [quaternions(each) for each in np.swapaxes(rig.rotations(body, shapes), 0, 1)]
    for finger, name in enumerate(FINGER_JOINTS):
        children = [first + child for child in _CHILDREN[SMPL22.num_joints + finger]]
        node = gl.Node(name=f"{role}_{name}", children=children)
        node.translation, node.rotation = rig.offsets[finger].tolist(), fingers[finger][0].tolist()
        gltf.nodes.append(node)

    turns, places = np.concatenate([body.turns, rig.turns]), np.concatenate([body.joints, rig.joints])
    inverse = np.tile(np.eye(4), (len(turns), 1, 1))
    inverse[:, :3, :3] = turns
    inverse[:, :3, 3] = -np.einsum("jik,jk->ji", turns, places)
    columns = np.swapaxes(inverse, 1, 2).reshape(-1, 16).astype(np.float32)  # glTF stores columns first
    joints = list(range(first, first + len(turns)))
    gltf.skins.append(
        gl.Skin(name=role, joints=joints, skeleton=first, inverseBindMatrices=buffer.add(columns, gl.MAT4))
    )
    gltf.meshes.append(gl.Mesh(name=f"{role}_body", primitives=_surface(buffer, body, rig, role, colours)))
    # A skinned mesh belongs at the top: what stands above it does not move it.
    gltf.nodes.append(gl.Node(name=f"{role}_body", mesh=len(gltf.meshes) - 1, skin=len(gltf.skins) - 1))
    gltf.scenes[0].nodes += [holder, len(gltf.nodes) - 1]

    animation = gltf.animations[0]

    def animate(node: int, what: str, values: Array, kind: str) -> None:
        output = buffer.add(values.astype(np.float32), kind)
        animation.samplers.append(gl.AnimationSampler(input=times, output=output, interpolation="LINEAR"))
        target = gl.AnimationChannelTarget(node=node, path=what)
        animation.channels.append(gl.AnimationChannel(sampler=len(animation.samplers) - 1, target=target))

    animate(first, "translation", positions[:, 0], gl.VEC3)
    rotations = local_rotations(world)
    for joint in range(SMPL22.num_joints):
        animate(first + joint, "rotation", quaternions(rotations[:, joint]), gl.VEC4)
    for finger, quats in enumerate(fingers):
        if np.ptp(quats, axis=0).max() > 1e-6:  # a hand that keeps its shape needs no key frames
            animate(first + SMPL22.num_joints + finger, "rotation", quats, gl.VEC4)


def bone_offsets(positions: Array, world: Array) -> Array:
    """(22, 3) a person's own bones in T-pose, metres: the mean of each where it changes its length."""
    offsets = np.zeros((SMPL22.num_joints, 3))
    for parent, joint in SMPL22.bones:
        bones = (positions[:, joint] - positions[:, parent])[:, None] @ world[:, parent]
        offsets[joint] = bones[:, 0].mean(axis=0)
    return offsets


def _surface(
    buffer: Buffer, body: Body, rig: HandRig, role: str, colours: Mapping[str, str]
) -> list[pygltflib.Primitive]:
    """The body's surface in its pose of binding: a primitive and a material for skin, top, shoes and so on."""
    import pygltflib as gl

    normals = vertex_normals(body.vertices, body.faces)
    normals[np.linalg.norm(normals, axis=1) < 0.5] = (0.0, 1.0, 0.0)  # of a vertex whose faces have no area
    weights = rig.weights
    attributes = gl.Attributes(
        POSITION=buffer.add(body.vertices.astype(np.float32), gl.VEC3, target=gl.ARRAY_BUFFER, bounds=True),
        NORMAL=buffer.add(normals.astype(np.float32), gl.VEC3, target=gl.ARRAY_BUFFER),
        JOINTS_0=buffer.add(
            np.where(weights > 0, rig.bones, 0).astype(np.uint8), gl.VEC4, target=gl.ARRAY_BUFFER
        ),
        WEIGHTS_0=buffer.add(weights.astype(np.float32), gl.VEC4, target=gl.ARRAY_BUFFER),
    )
    found = []
    for zone, name in enumerate(body.zones):
        faces = body.faces[body.face_zones == zone]
        if not len(faces):
            continue
        colour = [*linear(colours[name]), 1.0]
        surface = gl.PbrMetallicRoughness(baseColorFactor=colour, metallicFactor=0.0, roughnessFactor=0.8)
        buffer.gltf.materials.append(gl.Material(name=f"{role}_{name}", pbrMetallicRoughness=surface))
        indices = buffer.add(faces.astype(np.uint16).reshape(-1), gl.SCALAR, target=gl.ELEMENT_ARRAY_BUFFER)
        material = len(buffer.gltf.materials) - 1
        found.append(gl.Primitive(attributes=attributes, indices=indices, material=material))
    return found
