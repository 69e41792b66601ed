"""glTF binary: two skinned, animated people in one file, as every 3D program and browser plays them.

Each person is a skeleton of 22 nodes with a skin of capsules, one a bone, bound rigidly to it. One animation
turns all joints and moves both roots. glTF's axes are ours: Y up, right-handed, metres.
"""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from webdemo.motion.clip import Clip, Duet
from webdemo.motion.errors import InputError
from webdemo.motion.skeleton import SMPL22

from .bvh_writer import fit_rig
from .files import write_files

if TYPE_CHECKING:
    import pygltflib

Array = NDArray[np.floating]

_COLOURS = ([0.12, 0.37, 0.66, 1.0], [0.77, 0.33, 0.04, 1.0])
# Capsule radii in metres by the joint in which the bone ends.
_RADII = {
    "hip": 0.075, "spine1": 0.1, "knee": 0.065, "spine2": 0.1, "ankle": 0.045, "spine3": 0.11, "foot": 0.035,
    "neck": 0.06, "collar": 0.06, "head": 0.05, "shoulder": 0.055, "elbow": 0.042, "wrist": 0.034,
}  # fmt: skip
_HEAD_RADIUS = 0.1


@dataclass
class _Buffer:
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

    Returns:
        the path, in a list as for every format.

    Raises:
        InputError: for people who are not on SMPL22, or where the file cannot be written.
    """
    if duet.skeleton.joint_names != SMPL22.joint_names:
        raise InputError(
            f"glTF needs a rest pose, which {duet.skeleton.name} has not: retarget to SMPL22 first."
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
    buffer = _Buffer(gltf)
    times = buffer.add((np.arange(duet.num_frames) / duet.fps).astype(np.float32), gl.SCALAR, bounds=True)
    for number, clip in enumerate(duet.people):
        _add_person(buffer, clip, duet.roles[number], _COLOURS[number], times)
    buffer.data += bytes(-len(buffer.data) % 4)
    gltf.buffers.append(gl.Buffer(byteLength=len(buffer.data)))
    gltf.set_binary_blob(bytes(buffer.data))
    return b"".join(gltf.save_to_bytes())


def _add_person(buffer: _Buffer, clip: Clip, role: str, colour: list[float], times: int) -> None:
    import pygltflib as gl

    gltf = buffer.gltf
    positions = clip.positions.astype(np.float64)
    rotations, offsets = fit_rig(positions, clip.rotations)
    first = len(gltf.nodes)
    for joint, name in enumerate(SMPL22.joint_names):
        children = [first + child for child in SMPL22.children[joint]]
        node = gl.Node(name=f"{role}_{name}", children=children)
        # Without its animation a person stands in T-pose where they begin.
        node.translation = (positions[0, 0] if joint == 0 else offsets[joint]).tolist()
        gltf.nodes.append(node)

    rest = np.zeros((SMPL22.num_joints, 3))
    for parent, joint in SMPL22.bones:
        rest[joint] = rest[parent] + offsets[joint]
    inverse = np.tile(np.eye(4, dtype=np.float32), (SMPL22.num_joints, 1, 1))
    inverse[:, 3, :3] = -rest  # glTF stores columns first
    matrices = buffer.add(inverse.reshape(-1, 16), gl.MAT4)
    joints = list(range(first, first + SMPL22.num_joints))
    gltf.skins.append(gl.Skin(name=role, joints=joints, skeleton=first, inverseBindMatrices=matrices))
    gltf.materials.append(
        gl.Material(
            name=role,
            pbrMetallicRoughness=gl.PbrMetallicRoughness(
                baseColorFactor=colour, metallicFactor=0.0, roughnessFactor=0.8
            ),
        )
    )
    gltf.meshes.append(gl.Mesh(name=role, primitives=[_body(buffer, rest)]))
    gltf.nodes.append(gl.Node(name=f"{role}_body", mesh=len(gltf.meshes) - 1, skin=len(gltf.skins) - 1))
    gltf.scenes[0].nodes += [first, len(gltf.nodes) - 1]

    animation = gltf.animations[0]

    def animate(node: int, what: str, values: Array, kind: str) -> None:
        output = buffer.add(values.astype(np.float32), kind)
        animation.samplers.append(gl.AnimationSampler(input=times, output=output, interpolation="LINEAR"))
        target = gl.AnimationChannelTarget(node=node, path=what)
        animation.channels.append(gl.AnimationChannel(sampler=len(animation.samplers) - 1, target=target))

    animate(first, "translation", positions[:, 0], gl.VEC3)
    for joint, children in enumerate(SMPL22.children):
        if children:  # leaves only carry the ends of bones
            animate(first + joint, "rotation", _quaternions(rotations[:, joint]), gl.VEC4)


def _quaternions(rotations: Array) -> Array:
    """(T, 4) x y z w of (T, 3, 3), without flips of sign between frames."""
    quaternions = Rotation.from_matrix(rotations).as_quat()
    flips = np.sum(quaternions[1:] * quaternions[:-1], axis=-1) < 0
    signs = np.where(np.concatenate([[0], np.cumsum(flips)]) % 2, -1.0, 1.0)
    return quaternions * signs[:, None]


def _body(buffer: _Buffer, rest: Array) -> pygltflib.Primitive:
    """A capsule a bone and a ball for the head in the rest pose (J, 3), each bound to where it starts."""
    import pygltflib as gl
    import trimesh

    parts: list[tuple[int, Array, Array, Array]] = []
    for parent, joint in SMPL22.bones:
        radius = _RADII[SMPL22.joint_names[joint].removeprefix("left_").removeprefix("right_")]
        bone = rest[joint] - rest[parent]
        length = float(np.linalg.norm(bone))
        vertices, normals, faces = _capsule(round(length, 4), radius)
        turn = trimesh.geometry.align_vectors([0, 0, 1], bone / max(length, 1e-9))[:3, :3]
        parts.append((parent, vertices @ turn.T + rest[parent], normals @ turn.T, faces))
    head = SMPL22.index("head")
    vertices, normals, faces = _ball()
    parts.append((SMPL22.parents[head], vertices + rest[head] + [0.0, 0.07, 0.02], normals, faces))

    vertices = np.concatenate([part[1] for part in parts]).astype(np.float32)
    normals = np.concatenate([part[2] for part in parts]).astype(np.float32)
    starts = np.cumsum([0, *(len(part[1]) for part in parts)])
    faces = np.concatenate([part[3] + start for part, start in zip(parts, starts, strict=False)])
    bound = np.zeros((len(vertices), 4), dtype=np.uint8)
    bound[:, 0] = np.repeat([part[0] for part in parts], np.diff(starts))
    weights = np.zeros((len(vertices), 4), dtype=np.float32)
    weights[:, 0] = 1.0
    attributes = gl.Attributes(
        POSITION=buffer.add(vertices, gl.VEC3, target=gl.ARRAY_BUFFER, bounds=True),
        NORMAL=buffer.add(normals, gl.VEC3, target=gl.ARRAY_BUFFER),
        JOINTS_0=buffer.add(bound, gl.VEC4, target=gl.ARRAY_BUFFER),
        WEIGHTS_0=buffer.add(weights, gl.VEC4, target=gl.ARRAY_BUFFER),
    )
    indices = buffer.add(faces.astype(np.uint16).reshape(-1), gl.SCALAR, target=gl.ELEMENT_ARRAY_BUFFER)
    return gl.Primitive(attributes=attributes, indices=indices, material=len(buffer.gltf.materials) - 1)


@lru_cache(maxsize=512)
def _capsule(length: float, radius: float) -> tuple[Array, Array, Array]:
    """Vertices, their normals and faces of a capsule along +Z, made once: bones keep their lengths."""
    import trimesh

    mesh = trimesh.creation.capsule(height=length, radius=radius, count=(12, 8))
    return np.array(mesh.vertices), np.array(mesh.vertex_normals), np.array(mesh.faces)


@lru_cache(maxsize=1)
def _ball() -> tuple[Array, Array, Array]:
    """The same of the head."""
    import trimesh

    mesh = trimesh.creation.icosphere(subdivisions=2, radius=_HEAD_RADIUS)
    return np.array(mesh.vertices), np.array(mesh.vertex_normals), np.array(mesh.faces)
