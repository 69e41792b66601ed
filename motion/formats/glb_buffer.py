"""A glTF file that is being written: its description, and its numbers as they grow."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from motion.body import vertex_normals

from .glb_file import packed

Array = NDArray[Any]

_COMPONENTS = {"f": 5126, "H": 5123, "B": 5121}
_KINDS = {1: "SCALAR", 3: "VEC3", 4: "VEC4", 16: "MAT4"}
_CORNERS, _INDICES = 34962, 34963
"""glTF's numbers for what a part of the buffer is used for."""


class Buffer:
    """A description whose lists grow with its numbers.

    Args:
        document: the description, with one animation that has a name.
        blob: numbers that it has already.
    """

    def __init__(self, document: dict[str, Any], blob: bytes = b"") -> None:
        self.document, self.data = document, bytearray(blob)
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
