"""The binary part of a glTF file that is being written."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    import pygltflib

Array = NDArray[np.floating]


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

    def animate(self, node: int, path: str, values: Array, times: int) -> None:
        """Lets the file's first animation move a node's ``path``: values (T, 3 or 4) at the accessor ``times``."""
        import pygltflib as gl

        animation = self.gltf.animations[0]
        output = self.add(values.astype(np.float32), f"VEC{values.shape[1]}")
        animation.samplers.append(gl.AnimationSampler(input=times, output=output, interpolation="LINEAR"))
        target = gl.AnimationChannelTarget(node=node, path=path)
        animation.channels.append(gl.AnimationChannel(sampler=len(animation.samplers) - 1, target=target))
