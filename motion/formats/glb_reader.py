"""Skinned characters out of glTF binary files, read as if sent by an enemy.

Only what a character needs is read: the nodes, one skin and the triangles bound to it. Every count, size, index and
depth is checked before anything is made of it; addresses of other files, compressed and sparse data are refused.
Materials, pictures, morph targets and animations are not looked at.
"""

from __future__ import annotations

import json
import struct
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from motion.errors import InputError

from .files import read_bytes

Array = NDArray[np.floating]

MOST_VERTICES = 300_000
MOST_TRIANGLES = 600_000
MOST_JOINTS = 512
MOST_NODES = 5_000
MOST_ITEMS = 20_000
"""Entries of each list of the file."""
LARGEST_JSON = 4 * 2**20
_MAGIC, _JSON, _BIN = 0x46546C67, 0x4E4F534A, 0x004E4942
_TYPES = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
_FARTHEST = 1e6


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
    data, label = read_bytes(source, name)
    try:
        return _File(data, label).character()
    except (
        KeyError,
        IndexError,
        TypeError,
        ValueError,
        OverflowError,
        RecursionError,
        AttributeError,
    ) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"{label} is damaged: export it again as glTF binary (.glb).") from None


class _File:
    """The parts of a file that have been checked."""

    def __init__(self, data: bytes, label: str) -> None:
        self.label = label
        self.told, self.blob = self._chunks(data)
        for key in ("nodes", "meshes", "skins", "accessors", "bufferViews", "buffers"):
            if not isinstance(self.told.get(key, []), list) or len(self.told.get(key, [])) > MOST_ITEMS:
                self.refuse(f"its list of {key} is too long or none")
        if required := self.told.get("extensionsRequired"):
            kinds = ", ".join(str(each)[:40] for each in list(required)[:3])
            self.refuse(f"it needs {kinds}", "export it without compression or other extensions")

    def refuse(
        self, what: str, remedy: str = "export it again as glTF binary (.glb) with its skin"
    ) -> NoReturn:
        """Raises the sentence."""
        raise InputError(f"{self.label} cannot be used as a character because {what}: {remedy}.")

    def _chunks(self, data: bytes) -> tuple[dict[str, Any], bytes]:
        if len(data) < 20 or struct.unpack_from("<I", data)[0] != _MAGIC:
            raise InputError(f"{self.label} is no glTF binary file: export the character as .glb.")
        if (version := struct.unpack_from("<I", data, 4)[0]) != 2:
            self.refuse(f"it is of glTF version {version}", "export it as glTF 2.0")
        found: dict[int, bytes] = {}
        at = 12
        while at + 8 <= len(data):
            length, kind = struct.unpack_from("<II", data, at)
            if length > len(data) - at - 8:
                self.refuse("it is cut off")
            found.setdefault(kind, data[at + 8 : at + 8 + length])
            at += 8 + length + (-length % 4)
        if len(found.get(_JSON, b"")) > LARGEST_JSON:
            self.refuse(
                f"its description has more than {LARGEST_JSON // 2**20} MB", "export the character alone"
            )
        told = json.loads(found.get(_JSON, b"").decode("utf-8"))
        if not isinstance(told, dict):
            self.refuse("its description is none")
        return told, found.get(_BIN, b"")

    # ---- numbers -----------------------------------------------------------------------------------

    def index(self, value: Any, length: int, what: str) -> int:
        """A checked index into a list of this length."""
        if type(value) is not int or not 0 <= value < length:
            self.refuse(f"{what} {value!r:.20} is not there")
        return value

    def numbers(self, accessor: Any, kind: str, most: int, what: str) -> NDArray:
        """The rows of an accessor of this kind, at most so many."""
        stored = self.told["accessors"][self.index(accessor, len(self.told["accessors"]), "accessor")]
        if stored.get("sparse") is not None or stored.get("type") != kind or "bufferView" not in stored:
            self.refuse(f"its {what} are stored in a way that is not read here")
        count, component = stored["count"], stored["componentType"]
        if type(count) is not int or not 0 < count <= most:
            self.refuse(
                f"it has {count!r:.20} {what}, and {most:,} are the limit",
                "reduce the mesh or the skeleton first",
            )
        if component not in _TYPES:
            self.refuse(f"its {what} are of an unknown kind")
        views = self.told["bufferViews"]
        view = views[self.index(stored["bufferView"], len(views), "buffer view")]
        if view.get("buffer", 0) != 0 or self.told["buffers"][0].get("uri") is not None:
            self.refuse("it keeps its data in other files", "export it as one .glb file")
        dtype = np.dtype(_TYPES[component])
        row = dtype.itemsize * _WIDTHS[kind]
        start = self._size(view.get("byteOffset", 0)) + self._size(stored.get("byteOffset", 0))
        stride = self._size(view.get("byteStride", 0)) or row
        end = self._size(view.get("byteOffset", 0)) + self._size(view["byteLength"])
        if not row <= stride <= 252 or start + stride * (count - 1) + row > min(end, len(self.blob)):
            self.refuse(f"its {what} lie outside of the file")
        rows = np.ndarray((count, _WIDTHS[kind]), dtype, self.blob, start, (stride, dtype.itemsize))
        if dtype.kind == "f" and not (np.isfinite(rows).all() and np.abs(rows).max() < _FARTHEST):
            self.refuse(f"its {what} are not finite or very far away")
        if dtype.kind != "f" and stored.get("normalized"):
            return rows / float(np.iinfo(dtype).max)
        return rows.copy()

    def _size(self, value: Any) -> int:
        if type(value) is not int or not 0 <= value < 2**31:
            self.refuse("a size in it is no size")
        return value

    # ---- nodes and skins ---------------------------------------------------------------------------

    def _node_parents(self) -> list[int]:
        """Index of each node's parent, -1 for none; a node has one parent and is not above itself."""
        nodes = self.told.get("nodes", [])
        if len(nodes) > MOST_NODES:
            self.refuse(
                f"it has {len(nodes):,} nodes", f"export the character alone, with {MOST_NODES:,} at most"
            )
        parents = [-1] * len(nodes)
        for number, node in enumerate(nodes):
            for child in node.get("children", []):
                if parents[self.index(child, len(nodes), "node")] >= 0:
                    self.refuse("a node in it has two parents")
                parents[child] = number
        for number in range(len(nodes)):
            seen, at = 0, number
            while at >= 0:
                seen, at = seen + 1, parents[at]
                if seen > len(nodes):
                    self.refuse("its nodes go round in a circle")
        return parents

    def character(self) -> Character:
        """The skin with the most triangles, and all meshes bound to it."""
        parents = self._node_parents()
        nodes, skins, meshes = (self.told.get(key, []) for key in ("nodes", "skins", "meshes"))
        bound: dict[int, list[Mapping[str, Any]]] = {}
        for node in nodes:
            if node.get("skin") is not None and node.get("mesh") is not None:
                skin = self.index(node["skin"], len(skins), "skin")
                bound.setdefault(skin, []).append(meshes[self.index(node["mesh"], len(meshes), "mesh")])
        if not bound:
            self.refuse(
                "it has no mesh that is bound to a skeleton", "skin the mesh and export it with its armature"
            )
        found = [(skin, self._surface(each)) for skin, each in bound.items()]
        skin, (vertices, faces, slots, weights) = max(found, key=lambda each: len(each[1][1]))
        joints = skins[skin]["joints"]
        if (
            not isinstance(joints, list)
            or not 0 < len(joints) <= MOST_JOINTS
            or len(set(joints)) < len(joints)
        ):
            self.refuse(f"its skin has no joints, or more than {MOST_JOINTS}")
        joints = [self.index(joint, len(nodes), "joint") for joint in joints]
        if slots[weights > 0].max(initial=0) >= len(joints):
            self.refuse("its mesh is bound to joints that are not there")
        places = self._places(skins[skin], joints)
        order = sorted(range(len(joints)), key=lambda i: _depth(parents, joints[i]))
        rank = {joints[old]: new for new, old in enumerate(order)}
        above = [_above(parents, joints[old], rank) for old in order]
        renumbered = np.empty(len(joints), dtype=np.int64)
        renumbered[order] = np.arange(len(joints))
        names = tuple(str(nodes[joints[old]].get("name", f"joint_{old}"))[:100] for old in order)
        slots = renumbered[np.where(weights > 0, slots, 0)]
        return Character(self.label, names, tuple(above), places[order], vertices, faces, slots, weights)

    def _places(self, skin: Mapping[str, Any], joints: Sequence[int]) -> Array:
        """(J, 3) where the joints are when the mesh is as it is stored."""
        if skin.get("inverseBindMatrices") is None:
            self.refuse("its skin has no bind pose")
        stored = self.numbers(skin["inverseBindMatrices"], "MAT4", MOST_JOINTS, "bind matrices")
        if len(stored) < len(joints):
            self.refuse("some of its joints have no bind matrix")
        inverse = stored[: len(joints)].astype(np.float64).reshape(-1, 4, 4).swapaxes(1, 2)
        if not (np.abs(np.linalg.det(inverse[:, :3, :3])) > 1e-12).all():
            self.refuse("its bind matrices cannot be inverted")
        return np.linalg.inv(inverse)[:, :3, 3]

    def _surface(self, meshes: Sequence[Mapping[str, Any]]) -> tuple[Array, NDArray, NDArray, Array]:
        """Vertices (V, 3), faces (F, 3), joints (V, 4) and weights (V, 4) of meshes as one."""
        parts: list[tuple[Array, NDArray, NDArray, Array]] = []
        count = triangles = 0
        for primitive in (each for mesh in meshes for each in mesh["primitives"]):
            held = primitive["attributes"]
            if primitive.get("mode", 4) != 4 or "JOINTS_0" not in held or "WEIGHTS_0" not in held:
                continue
            left = MOST_VERTICES - count
            vertices = self.numbers(held["POSITION"], "VEC3", max(left, 0), "vertices").astype(np.float64)
            slots = self.numbers(held["JOINTS_0"], "VEC4", len(vertices), "joints of vertices").astype(
                np.int64
            )
            weights = self.numbers(held["WEIGHTS_0"], "VEC4", len(vertices), "weights").astype(np.float64)
            if not len(vertices) == len(slots) == len(weights) or (weights < 0).any() or (slots < 0).any():
                self.refuse("its weights do not fit its vertices")
            if primitive.get("indices") is not None:
                corners = self.numbers(
                    primitive["indices"], "SCALAR", 3 * (MOST_TRIANGLES - triangles), "corners of triangles"
                ).astype(np.int64)[:, 0]
            else:
                corners = np.arange(len(vertices))
            if len(corners) % 3 or corners.max(initial=0) >= len(vertices) or corners.min(initial=0) < 0:
                self.refuse("its triangles have corners that are not there")
            total = weights.sum(axis=1, keepdims=True)
            weights = np.where(total > 0, weights / np.maximum(total, 1e-12), [1.0, 0.0, 0.0, 0.0])
            parts.append((vertices, corners.reshape(-1, 3) + count, slots, weights))
            count, triangles = count + len(vertices), triangles + len(corners) // 3
        if not triangles:
            self.refuse("it has no skinned triangles", "skin the mesh and export it with its armature")
        vertices, faces, slots, weights = (np.concatenate(each) for each in zip(*parts, strict=True))
        return vertices, faces, slots, weights


def _depth(parents: Sequence[int], node: int) -> int:
    depth = 0
    while parents[node] >= 0:
        node, depth = parents[node], depth + 1
    return depth


def _above(parents: Sequence[int], node: int, rank: Mapping[int, int]) -> int:
    """The rank of the nearest joint above a node; -1 where there is none."""
    while (node := parents[node]) >= 0:
        if node in rank:
            return rank[node]
    return -1
