"""A .glb as a viewer sees it: joints and surface of each skin in each frame, computed from the file alone."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pygltflib
from scipy.spatial.transform import Rotation

_KINDS = {pygltflib.FLOAT: "<f4", pygltflib.UNSIGNED_SHORT: "<u2", pygltflib.UNSIGNED_BYTE: "u1"}
_WIDTHS = {"SCALAR": 1, "VEC3": 3, "VEC4": 4, "MAT4": 16}


class Skinned:
    """The skins of a file with one animation.

    Args:
        path: a .glb whose animation samples all channels at the same times.
    """

    def __init__(self, path: Path) -> None:
        self.gltf = pygltflib.GLTF2().load(str(path))
        self.blob = self.gltf.binary_blob()
        self.animation = self.gltf.animations[0]
        self.times = self.array(self.animation.samplers[0].input)[:, 0]
        self.parents = {child: number for number, node in enumerate(self.gltf.nodes) for child in node.children or []}
        self.tracks = {
            (channel.target.node, channel.target.path): self.array(self.animation.samplers[channel.sampler].output)
            for channel in self.animation.channels
        }

    def array(self, accessor: int) -> np.ndarray:
        """(count, width) values of an accessor."""
        found = self.gltf.accessors[accessor]
        view = self.gltf.bufferViews[found.bufferView]
        raw = np.frombuffer(self.blob, _KINDS[found.componentType], found.count * _WIDTHS[found.type], view.byteOffset)
        return raw.reshape(found.count, -1)

    def world(self, node: int) -> np.ndarray:
        """(T, 4, 4) where a node stands in each frame."""
        count, plain = len(self.times), self.gltf.nodes[node]
        local = np.tile(np.eye(4), (count, 1, 1))
        local[:, :3, 3] = self.tracks.get((node, "translation"), plain.translation or (0, 0, 0))
        turn = self.tracks.get((node, "rotation"), plain.rotation and [plain.rotation])
        if turn is not None:
            local[:, :3, :3] = Rotation.from_quat(np.broadcast_to(turn, (count, 4))).as_matrix()
        return self.world(self.parents[node]) @ local if node in self.parents else local

    def joints(self, skin: int) -> np.ndarray:
        """(T, J, 4, 4) the joints of a skin in the order in which it names them."""
        return np.stack([self.world(node) for node in self.gltf.skins[skin].joints], axis=1)

    def surface(self, skin: int) -> tuple[np.ndarray, np.ndarray]:
        """(T, V, 3) the surface of a skin, and (V,) the joint that moves each vertex most."""
        (node,) = [node for node in self.gltf.nodes if node.skin == skin]
        attributes = self.gltf.meshes[node.mesh].primitives[0].attributes
        inverse = self.array(self.gltf.skins[skin].inverseBindMatrices).reshape(-1, 4, 4).swapaxes(1, 2)
        moves = self.joints(skin) @ inverse
        points = np.pad(self.array(attributes.POSITION), ((0, 0), (0, 1)), constant_values=1)
        bones, weights = self.array(attributes.JOINTS_0), self.array(attributes.WEIGHTS_0)
        placed = np.einsum("vk,tvkij,vj->tvi", weights, moves[:, bones], points)[..., :3]
        return placed, bones[np.arange(len(bones)), weights.argmax(axis=1)]
