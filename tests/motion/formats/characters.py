"""Small skinned characters as other programs would write them: a box a bone, in glTF binary."""

from __future__ import annotations

import json
import struct
from collections.abc import Sequence
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from motion import SMPL22

from .rigs import RIGS

_CORNERS = np.array([[x, y, z] for x in (-1, 1) for y in (0, 1) for z in (-1, 1)], dtype=float)
_FACES = np.array([int(corner) for corner in "013032467475045051237276026064157173"]).reshape(-1, 3)
THICK = 0.04
"""Half of a box's width in metres."""


def glb_character(
    rig: str = "mixamo",
    *,
    places: np.ndarray | None = None,
    unit: float = 1.0,
    turn: np.ndarray | None = None,
    fine: int = 1,
    **changes: Any,
) -> bytes:
    """A character of boxes.

    Args:
        rig: its names, of RIGS.
        places: (22, 3) metres of its joints in the pose of binding; the T-pose by default.
        unit: file units a metre.
        turn: (3, 3) what everything is turned by.
        fine: how many copies of the boxes.
        changes: entries of the file's description that replace those that are right.
    """
    places = SMPL22.rest_positions().astype(float) if places is None else places
    turn = np.eye(3) if turn is None else turn
    kept = [joint for joint, name in enumerate(SMPL22.joint_names) if name in RIGS[rig]]
    vertices, faces, slots = [], [], []
    for slot, joint in enumerate(kept):
        child = next((c for c in SMPL22.children[joint]), None)
        bone = np.array([0.0, 0.15, 0.0]) if child is None else places[child] - places[joint]
        up = bone / np.linalg.norm(bone)
        side = np.cross(up, [0.0, 0.0, 1.0] if abs(up[2]) < 0.9 else [1.0, 0.0, 0.0])
        side /= np.linalg.norm(side)
        frame = np.stack([THICK * side, bone, THICK * np.cross(side, up)])
        for _ in range(fine):
            faces.append(_FACES + 8 * len(vertices))
            vertices.append(places[joint] + _CORNERS @ frame)
            slots.append(np.tile([slot, 0, 0, 0], (8, 1)))
    inverse = np.tile(np.eye(4), (len(kept), 1, 1))
    for slot, joint in enumerate(kept):
        inverse[slot, :3, 3] = -unit * (turn @ places[joint])
    weights = np.tile([1.0, 0.0, 0.0, 0.0], (8 * len(vertices), 1))
    arrays = [
        (unit * np.concatenate(vertices) @ turn.T, "<f4", "VEC3"),
        (np.concatenate(slots), "<u1", "VEC4"),
        (weights, "<f4", "VEC4"),
        (np.concatenate(faces).reshape(-1, 1), "<u4", "SCALAR"),
        (inverse.swapaxes(1, 2).reshape(-1, 16), "<f4", "MAT4"),
    ]
    blob, views, accessors = b"", [], []
    for values, kind, shape in arrays:
        data = np.ascontiguousarray(values).astype(kind).tobytes()
        component = {"<f4": 5126, "<u1": 5121, "<u4": 5125}[kind]
        accessors.append({"bufferView": len(views), "componentType": component, "count": len(values), "type": shape})
        views.append({"buffer": 0, "byteOffset": len(blob), "byteLength": len(data)})
        blob += data + bytes(-len(data) % 4)
    nodes: list[dict[str, Any]] = []
    for joint in kept:
        below = [kept.index(other) for other in kept if _above(other, kept) == joint]
        start = places[above] if (above := _above(joint, kept)) >= 0 else np.zeros(3)
        offset = unit * turn @ (places[joint] - start)
        name = RIGS[rig][SMPL22.joint_names[joint]]
        nodes.append({"name": name, "children": below, "translation": offset.tolist()})
    nodes.append({"mesh": 0, "skin": 0})
    attributes = {"POSITION": 0, "JOINTS_0": 1, "WEIGHTS_0": 2}
    document: dict[str, Any] = {
        "asset": {"version": "2.0"},
        "nodes": nodes,
        "buffers": [{"byteLength": len(blob)}],
        "bufferViews": views,
        "accessors": accessors,
        "meshes": [{"primitives": [{"attributes": attributes, "indices": 3}]}],
        "skins": [{"joints": list(range(len(kept))), "inverseBindMatrices": 4}],
    }
    return packed(document | changes, blob)


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
    """An animated character of boxes on SMPL22's bones, as Blender writes Mixamo's: the armature turned and scaled.

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
    document, blob = unpacked(glb_character(places=rest, unit=unit, turn=turn))
    views, accessors = document["bufferViews"], document["accessors"]

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
    document |= {
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


def _above(joint: int, kept: list[int]) -> int:
    while (joint := SMPL22.parents[joint]) >= 0:
        if joint in kept:
            return joint
    return -1


def in_a_mirror(data: bytes) -> bytes:
    """The file with all its nodes under one that mirrors them."""
    document, blob = unpacked(data)
    top = [number for scene in document["scenes"] for number in scene["nodes"]]
    document["nodes"].append({"name": "mirror", "scale": [-1, 1, 1], "children": top})
    document["scenes"][0]["nodes"] = [len(document["nodes"]) - 1]
    return packed(document, blob)
