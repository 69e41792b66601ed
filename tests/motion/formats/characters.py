"""Animated characters as other programs would write them, in glTF binary, without their surfaces."""

from __future__ import annotations

import json
import struct
from collections.abc import Sequence
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from motion import SMPL22

from .rigs import RIGS


def glb_motion(
    rotations: np.ndarray,
    root: np.ndarray,
    rig: str | dict[str, str] = "mixamo",
    *,
    fps: float = 30.0,
    unit: float = 1.0,
    turn: np.ndarray | None = None,
    start: float = 0.0,
    way: str = "LINEAR",
    skinned: bool = True,
    people: int = 1,
    axes: np.ndarray | None = None,
    **changes: Any,
) -> bytes:
    """An animated character on SMPL22's bones, as Blender writes Mixamo's: the armature turned and scaled.

    Args:
        rotations: (T, 22, 3, 3) local rotations.
        root: (T, 3) metres.
        rig: its names, of RIGS or by SMPL22's.
        fps: key frames a second.
        unit: the armature's own units a metre; its node scales them back.
        turn: (3, 3) by which the armature's own axes are turned; its node turns them back.
        start: seconds of the first key.
        way: how it is interpolated.
        skinned: whether there is a mesh; without one the joints are plain nodes.
        people: how many of them stand 2 m apart, each with a skeleton and an animation of their own.
        axes: (22, 3, 3) the joints' own axes in the pose of binding, which are those of the armature by default.
        changes: entries of the file's description that replace those that are right.
    """
    axes = np.tile(np.eye(3), (22, 1, 1)) if axes is None else axes
    names = RIGS[rig] if isinstance(rig, str) else rig
    turn = np.eye(3) if turn is None else turn
    rest = SMPL22.rest_positions().astype(float)
    blob, views, accessors = b"", [], []

    def add(values: np.ndarray, shape: str) -> int:
        nonlocal blob
        data = np.ascontiguousarray(values).astype("<f4").tobytes()
        views.append({"buffer": 0, "byteOffset": len(blob), "byteLength": len(data)})
        accessors.append({"bufferView": len(views) - 1, "componentType": 5126, "count": len(values), "type": shape})
        blob += data
        return len(accessors) - 1

    def spline(values: np.ndarray) -> np.ndarray:
        if way != "CUBICSPLINE":
            return values
        slope = fps * np.gradient(values, axis=0)
        return np.stack([slope, values, slope], axis=1).reshape(-1, values.shape[-1])

    inverse = np.tile(np.eye(4), (22, 1, 1))
    inverse[:, :3, :3] = axes.swapaxes(1, 2)
    inverse[:, :3, 3] = -unit * np.einsum("jba,jb->ja", axes, rest @ turn.T)
    bound = add(inverse.swapaxes(1, 2).reshape(-1, 16), "MAT4")
    count = len(SMPL22.joint_names)
    nodes: list[dict[str, Any]] = []
    animations, skins, top = [], [], []
    times = add(start + np.arange(len(root))[:, None] / fps, "SCALAR")
    for person in range(people):
        first, samplers, channels = len(nodes) + 1, [], []
        back = Rotation.from_matrix(turn.T).as_quat()
        top.append(first - 1)
        nodes.append(
            {
                "name": f"Armature{person}",
                "children": [first],
                "rotation": back.tolist(),
                "scale": [1 / unit] * 3,
                "translation": [2.0 * person, 0.0, 0.0],
            }
        )
        for joint, name in enumerate(SMPL22.joint_names):
            parent = SMPL22.parents[joint]
            offset = rest[joint] - (rest[parent] if parent >= 0 else 0.0)
            children = [first + child for child in SMPL22.children[joint]]
            nodes.append({"name": names[name], "children": children, "translation": (unit * turn @ offset).tolist()})
            # Rotations are about the armature's turned axes.
            turned = Rotation.from_matrix(turn @ rotations[:, joint] @ turn.T).as_quat()
            turned *= np.where(np.cumsum(np.r_[0, (turned[1:] * turned[:-1]).sum(-1) < 0]) % 2, -1, 1)[:, None]
            for path, values in (("rotation", turned), ("translation", unit * root @ turn.T)):
                if path == "rotation" or joint == 0:
                    output = add(spline(values), "VEC4" if path == "rotation" else "VEC3")
                    samplers.append({"input": times, "output": output, "interpolation": way})
                    target = {"node": first + joint, "path": path}
                    channels.append({"sampler": len(samplers) - 1, "target": target})
        animations.append({"name": f"walk {person}", "samplers": samplers, "channels": channels})
        if skinned:
            skins.append({"joints": list(range(first, first + count)), "inverseBindMatrices": bound})
            nodes.append({"mesh": 0, "skin": person})
            top.append(len(nodes) - 1)
    document: dict[str, Any] = {
        "asset": {"version": "2.0"},
        "bufferViews": views,
        "accessors": accessors,
        "meshes": [{"primitives": []}],
        "nodes": nodes,
        "animations": animations,
        "skins": skins,
        "scene": 0,
        "scenes": [{"nodes": top}],
        "buffers": [{"byteLength": len(blob)}],
    }
    if not skinned:
        del document["skins"], document["meshes"]
    return packed(document | changes, blob)


def glb_takes(rotations: np.ndarray, root: np.ndarray, names: Sequence[Any], **given: Any) -> bytes:
    """:func:`glb_motion` with an animation for each name; the limbs move in the first alone, the others glide."""
    document, blob = unpacked(glb_motion(rotations, root, **given))
    (walk,) = document["animations"]
    glide = {**walk, "channels": [c for c in walk["channels"] if c["target"]["path"] == "translation"]}
    takes = [walk, *[glide] * (len(names) - 1)]
    document["animations"] = [{**take, "name": name} for take, name in zip(takes, names, strict=True)]
    return packed(document, blob)


def unpacked(data: bytes) -> tuple[dict[str, Any], bytes]:
    """The two chunks of a file; the opposite of :func:`packed`."""
    length = struct.unpack_from("<I", data, 12)[0]
    return json.loads(data[20 : 20 + length]), data[28 + length :]


def packed(document: dict[str, Any], blob: bytes) -> bytes:
    """The two chunks of a file."""
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text + struct.pack("<II", len(blob), 0x004E4942) + blob
    return struct.pack("<III", 0x46546C67, 2, 12 + len(chunks)) + chunks


def in_a_mirror(data: bytes) -> bytes:
    """The file with all its nodes under one that mirrors them."""
    document, blob = unpacked(data)
    top = [number for scene in document["scenes"] for number in scene["nodes"]]
    document["nodes"].append({"name": "mirror", "scale": [-1, 1, 1], "children": top})
    document["scenes"][0]["nodes"] = [len(document["nodes"]) - 1]
    return packed(document, blob)
