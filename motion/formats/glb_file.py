"""glTF binary files, read as if sent by an enemy.

Every count, size, index and depth is checked before anything is made of it; addresses of other files, compressed and
sparse data are refused.
"""

from __future__ import annotations

import json
import struct
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple, NoReturn

import numpy as np
from numpy.typing import NDArray

from motion.errors import InputError

from .files import read_bytes, read_json

MOST_JOINTS = 512
MOST_NODES = 5_000
DEEPEST = 500
"""Nodes above a node."""
MOST_SKINS = 200
"""Skins of a file: a character has one for each of its meshes."""
MOST_ITEMS = 20_000
"""Entries of each list of the file."""
_MAGIC, _JSON, _BIN = 0x46546C67, 0x4E4F534A, 0x004E4942
_TYPES = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
_FARTHEST = 1e6
_HARMLESS = (
    "KHR_materials",
    "KHR_texture",
    "EXT_texture",
    "KHR_lights",
    "KHR_draco_mesh_compression",
    "KHR_mesh_quantization",
)
"""Beginnings of the names of extensions that change only how things look and how meshes are stored."""
_LISTS = ("nodes", "meshes", "skins", "animations", "accessors", "bufferViews", "buffers")


@contextmanager
def opened(source: str | Path | bytes, name: str | None) -> Iterator[GlbFile]:
    """A file whose parts are read in the block; what is wrong with it is one sentence there as well.

    Args:
        source: a path, or the file's bytes.
        name: what to call the file in messages; its own name by default.

    Raises:
        InputError: one sentence that says what is wrong with the file and what to do.
    """
    data, label = read_bytes(source, name, remedy="reduce its mesh or leave out its pictures")
    try:
        yield GlbFile(data, label)
    except (KeyError, IndexError, TypeError, ValueError, OverflowError, RecursionError, AttributeError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"{label} is damaged: export it again as glTF binary (.glb).") from None


class Stored(NamedTuple):
    """The place of rows of numbers in a file.

    Attributes:
        kind: "SCALAR", "VEC3", …
        rows: how many.
        component: glTF's number for the kind of each number.
        start: byte of the first row.
        stride: bytes from one row to the next.
        normalized: whole numbers stand for fractions.
    """

    kind: str
    rows: int
    component: int
    start: int
    stride: int
    normalized: bool

    @property
    def size(self) -> int:
        """Bytes of the numbers themselves."""
        return self.rows * _WIDTHS[self.kind] * np.dtype(_TYPES[self.component]).itemsize


class GlbFile:
    """The parts of a file that have been checked.

    Args:
        data: the whole file.
        label: what to call it in messages.

    Attributes:
        document: its description.
        blob: its numbers.
    """

    def __init__(self, data: bytes, label: str) -> None:
        self.label = label
        self.document, self.blob = self._chunks(data)
        for key in _LISTS:
            if not isinstance(self.document.get(key, []), list) or len(self.document.get(key, [])) > MOST_ITEMS:
                self.refuse(f"its list of {key} is too long or none")
        if len(self.document.get("skins", [])) > MOST_SKINS:
            self.refuse(
                f"it has {len(self.document['skins']):,} skins",
                f"export the character alone, with {MOST_SKINS} skins at most",
            )
        needed = [str(each)[:40] for each in list(self.document.get("extensionsRequired", []))]
        if needed := [each for each in needed if not each.startswith(_HARMLESS)]:
            self.refuse(f"it needs {', '.join(needed[:3])}", "export it without compression or other extensions")

    def refuse(self, what: str, remedy: str = "export it again as glTF binary (.glb) with its skin") -> NoReturn:
        """Raises the sentence."""
        raise InputError(f"{self.label} cannot be read as motion because {what}: {remedy}.")

    def _chunks(self, data: bytes) -> tuple[dict[str, Any], bytes]:
        if len(data) < 20 or struct.unpack_from("<I", data)[0] != _MAGIC:
            raise InputError(f"{self.label} is not a glTF binary file: export it as .glb.")
        if (version := struct.unpack_from("<I", data, 4)[0]) != 2:
            self.refuse(f"it is of glTF version {version}", "export it as glTF 2.0")
        chunks: dict[int, bytes] = {}
        at = 12
        while at + 8 <= len(data):
            length, kind = struct.unpack_from("<II", data, at)
            if length > len(data) - at - 8:
                self.refuse("it is cut off")
            chunks.setdefault(kind, data[at + 8 : at + 8 + length])
            at += 8 + length + (-length % 4)
        try:
            document = read_json(chunks.get(_JSON, b""))
        except ValueError as error:
            self.refuse(f"its description {error}", "export the character alone")
        if not isinstance(document, dict):
            self.refuse("its description is none")
        return document, chunks.get(_BIN, b"")

    # ---- numbers -----------------------------------------------------------------------------------

    def index(self, value: Any, length: int, what: str) -> int:
        """A checked index into a list of this length."""
        if type(value) is not int or not 0 <= value < length:
            self.refuse(f"{what} {value!r:.20} is not there")
        return value

    def stored(self, accessor: Any, kind: str, most: int, what: str) -> Stored:
        """The place of the rows of an accessor of this kind, at most so many; nothing is decoded yet."""
        entry = self.document["accessors"][self.index(accessor, len(self.document["accessors"]), "accessor")]
        if entry.get("sparse") is not None or entry.get("type") != kind or "bufferView" not in entry:
            self.refuse(f"its {what} are stored in a way that is not read here")
        count, component = entry["count"], entry["componentType"]
        if type(count) is not int or not 0 < count <= most:
            self.refuse(
                f"it has {count!r:.20} {what}, and {most:,} are the limit", "reduce the mesh or the skeleton first"
            )
        if component not in _TYPES:
            self.refuse(f"its {what} are of an unknown kind")
        views = self.document["bufferViews"]
        view = views[self.index(entry["bufferView"], len(views), "buffer view")]
        if view.get("buffer", 0) != 0 or self.document["buffers"][0].get("uri") is not None:
            self.refuse("it keeps its data in other files", "export it as one .glb file")
        row = np.dtype(_TYPES[component]).itemsize * _WIDTHS[kind]
        start = self._size(view.get("byteOffset", 0)) + self._size(entry.get("byteOffset", 0))
        stride = self._size(view.get("byteStride", 0)) or row
        end = self._size(view.get("byteOffset", 0)) + self._size(view["byteLength"])
        if not row <= stride <= 252 or start + stride * (count - 1) + row > min(end, len(self.blob)):
            self.refuse(f"its {what} lie outside of the file")
        return Stored(kind, count, component, start, stride, bool(entry.get("normalized")))

    def decoded(self, stored: Stored, what: str) -> NDArray:
        """(rows, width) the numbers that are stored there."""
        dtype = np.dtype(_TYPES[stored.component])
        shape = (stored.rows, _WIDTHS[stored.kind])
        rows = np.ndarray(shape, dtype, self.blob, stored.start, (stored.stride, dtype.itemsize))
        if dtype.kind == "f" and not (np.isfinite(rows).all() and np.abs(rows).max() < _FARTHEST):
            self.refuse(f"its {what} are not finite or very far away")
        if dtype.kind != "f" and stored.normalized:
            return rows / float(np.iinfo(dtype).max)
        return rows.copy()

    def _size(self, value: Any) -> int:
        if type(value) is not int or not 0 <= value < 2**31:
            self.refuse("a size in it is no size")
        return value

    # ---- nodes and skins ---------------------------------------------------------------------------

    def node_parents(self) -> list[int]:
        """Index of each node's parent, -1 for none; a node has one parent and is not above itself."""
        nodes = self.document.get("nodes", [])
        if len(nodes) > MOST_NODES:
            self.refuse(f"it has {len(nodes):,} nodes", f"export the character alone, with {MOST_NODES:,} at most")
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
                if seen > DEEPEST:
                    self.refuse(f"its nodes are more than {DEEPEST} deep, or go round in a circle")
        return parents

    def skin_joints(self, skin: Any) -> list[int]:
        """The checked nodes of a skin's joints."""
        joints = skin["joints"]
        if not isinstance(joints, list) or not 0 < len(joints) <= MOST_JOINTS or len(set(joints)) < len(joints):
            self.refuse(f"its skin has no joints, or more than {MOST_JOINTS}")
        return [self.index(joint, len(self.document["nodes"]), "joint") for joint in joints]

    def bind_matrices(self, skin: Any, count: int) -> NDArray[np.floating]:
        """(J, 4, 4) the joints of a skin when the mesh is as it is stored."""
        what = "bind matrices"
        stored = self.decoded(self.stored(skin["inverseBindMatrices"], "MAT4", MOST_JOINTS, what), what)
        if len(stored) < count:
            self.refuse("some of its joints have no bind matrix")
        inverse = stored[:count].astype(np.float64).reshape(-1, 4, 4).swapaxes(1, 2)
        if not (np.abs(np.linalg.det(inverse[:, :3, :3])) > 1e-12).all():
            self.refuse("its bind matrices cannot be inverted")
        matrices: NDArray[np.floating] = np.linalg.inv(inverse)
        return matrices

    def joint_name(self, node: int) -> str:
        """The name of a node: the bone that VRM says it is, its name, or one made of its number."""
        named = self._human_bones.get(node) or self.document["nodes"][node].get("name", f"joint_{node}")
        return str(named)[:100]

    @cached_property
    def _human_bones(self) -> dict[int, str]:
        """The bones of a VRM character or animation by their nodes: "leftUpperArm" …"""
        names: dict[int, str] = {}
        for kind in ("VRM", "VRMC_vrm", "VRMC_vrm_animation"):
            bones = self.document.get("extensions", {}).get(kind, {}).get("humanoid", {}).get("humanBones", {})
            if isinstance(bones, list):  # of VRM 0
                bones = {each["bone"]: each for each in bones}
            names |= {each["node"]: str(bone) for bone, each in bones.items()}
        return names


def packed(document: Mapping[str, Any], blob: bytes) -> bytes:
    """A file of a description and its numbers."""
    text = json.dumps(document, separators=(",", ":")).encode("utf-8")
    text += b" " * (-len(text) % 4)
    blob += bytes(-len(blob) % 4)
    size = 12 + 8 + len(text) + 8 + len(blob)
    head = struct.pack("<III", _MAGIC, 2, size) + struct.pack("<II", len(text), _JSON)
    return head + text + struct.pack("<II", len(blob), _BIN) + blob
