"""Skinned characters out of glTF binary files.

Only what a character needs is read: the nodes, one skin and the triangles bound to it. Materials, pictures, morph
targets and animations are not looked at.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .glb_file import GlbFile, in_order, opened

Array = NDArray[np.floating]

MOST_VERTICES = 300_000
MOST_TRIANGLES = 600_000


@dataclass(frozen=True, eq=False)
class Character:
    """A surface that hangs on the joints of a rig, in the rig's own unit and axes.

    Attributes:
        name: of the file.
        joint_names: one a joint.
        parents: index of each joint's parent among the joints, -1 for a root; parents come first.
        joints: (J, 3) places of the joints in the pose of binding.
        vertices: (V, 3) in the pose of binding.
        faces: (F, 3) vertex indices.
        slots: (V, 4) joints that move each vertex.
        weights: (V, 4) their shares, which sum to 1.
    """

    name: str
    joint_names: tuple[str, ...]
    parents: tuple[int, ...]
    joints: Array = field(repr=False)
    vertices: Array = field(repr=False)
    faces: NDArray[np.integer] = field(repr=False)
    slots: NDArray[np.integer] = field(repr=False)
    weights: Array = field(repr=False)


def read_character(source: str | Path | bytes, *, name: str | None = None) -> Character:
    """The skinned character in a .glb file: the skin with the most triangles and all that is bound to it.

    Args:
        source: a path, or the file's bytes.
        name: what to call the file in messages; its own name by default.

    Raises:
        InputError: one sentence that says what is wrong with the file and what to do.
    """
    with opened(source, name, "used as a character") as file:
        return _character(file)


def _character(file: GlbFile) -> Character:
    """The skin with the most triangles, and all meshes bound to it."""
    parents = file.node_parents()
    nodes, skins, meshes = (file.document.get(key, []) for key in ("nodes", "skins", "meshes"))
    bound: dict[int, list[Mapping[str, Any]]] = {}
    for node in nodes:
        if node.get("skin") is not None and node.get("mesh") is not None:
            skin = file.index(node["skin"], len(skins), "skin")
            bound.setdefault(skin, []).append(meshes[file.index(node["mesh"], len(meshes), "mesh")])
    if not bound:
        file.refuse("it has no mesh that is bound to a skeleton", "skin the mesh and export it with its armature")
    skin = max(bound, key=lambda each: _triangles(file, bound[each]))
    vertices, faces, slots, weights = _surface(file, bound[skin])
    joints = file.skin_joints(skins[skin])
    if slots[weights > 0].max(initial=0) >= len(joints):
        file.refuse("its mesh is bound to joints that are not there")
    places = file.bind_matrices(skins[skin], len(joints))[:, :3, 3]
    ordered, above = in_order(joints, parents)
    order = [joints.index(node) for node in ordered]
    renumbered = np.empty(len(joints), dtype=np.int64)
    renumbered[order] = np.arange(len(joints))
    names = tuple(file.joint_name(node) for node in ordered)
    slots = renumbered[np.where(weights > 0, slots, 0)]
    return Character(file.label, names, tuple(above), places[order], vertices, faces, slots, weights)


def _triangles(file: GlbFile, meshes: Sequence[Mapping[str, Any]]) -> int:
    """The number of skinned triangles of meshes, by what the file declares; nothing is decoded."""
    parts = [each for mesh in meshes for each in mesh["primitives"] if _is_skinned(each)]
    return sum(file.corners(part, MOST_TRIANGLES) for part in parts) // 3


def _is_skinned(primitive: Mapping[str, Any]) -> bool:
    held = primitive["attributes"]
    return primitive.get("mode", 4) == 4 and "JOINTS_0" in held and "WEIGHTS_0" in held


def _surface(file: GlbFile, meshes: Sequence[Mapping[str, Any]]) -> tuple[Array, NDArray, NDArray, Array]:
    """Vertices (V, 3), faces (F, 3), joints (V, 4) and weights (V, 4) of meshes as one."""
    parts: list[tuple[Array, NDArray, NDArray, Array]] = []
    count = triangles = 0
    for primitive in (each for mesh in meshes for each in mesh["primitives"]):
        held = primitive["attributes"]
        if not _is_skinned(primitive):
            continue
        left = MOST_VERTICES - count
        vertices = file.numbers(held["POSITION"], "VEC3", max(left, 0), "vertices").astype(np.float64)
        slots = file.numbers(held["JOINTS_0"], "VEC4", len(vertices), "joints of vertices").astype(np.int64)
        weights = file.numbers(held["WEIGHTS_0"], "VEC4", len(vertices), "weights").astype(np.float64)
        if not len(vertices) == len(slots) == len(weights) or (weights < 0).any() or (slots < 0).any():
            file.refuse("its weights do not fit its vertices")
        cells = file.triangles(primitive, len(vertices), MOST_TRIANGLES - triangles)
        total = weights.sum(axis=1, keepdims=True)
        weights = np.where(total > 0, weights / np.maximum(total, 1e-12), [1.0, 0.0, 0.0, 0.0])
        parts.append((vertices, cells + count, slots, weights))
        count, triangles = count + len(vertices), triangles + len(cells)
    if not triangles:
        file.refuse("it has no skinned triangles", "skin the mesh and export it with its armature")
    vertices, faces, slots, weights = (np.concatenate(each) for each in zip(*parts, strict=True))
    return vertices, faces, slots, weights
