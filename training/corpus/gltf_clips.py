"""The animations of a glTF binary with one rig, as rigs in motion: how Mesh2Motion's clips are read."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
import pygltflib
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation, Slerp

from motion import InputError
from motion.rigs import RigMotion

Array = NDArray[np.floating]

_COMPONENTS = {5120: "i1", 5121: "u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_WIDTHS = {"SCALAR": 1, "VEC3": 3, "VEC4": 4, "MAT4": 16}
_MAX_SECONDS = 120.0


def read_animations(path: Path, *, fps: float = 30.0) -> dict[str, RigMotion]:
    """Every animation of a .glb by its name, sampled at ``fps``.

    Node transforms above the rig count, so places are in metres with Y up, as glTF has it. Rotations are
    interpolated on the sphere, places and sizes linearly; a step or spline sampler is read by its keys.

    Raises:
        InputError: where the file is no readable glTF binary with a skin and animations.
    """
    try:
        gltf = pygltflib.GLTF2().load_binary(str(path))
        blob = gltf.binary_blob()
        if gltf is None or blob is None or not gltf.skins:
            raise ValueError("no skin")
        return {
            animation.name or f"animation {number}": _rig(gltf, blob, animation, fps, path.name)
            for number, animation in enumerate(gltf.animations)
        }
    except (
        OSError,
        LookupError,
        ValueError,
        TypeError,
        AttributeError,
        RecursionError,
        struct.error,
    ) as error:
        raise InputError(
            f"{path.name} holds no animations of one rig ({error}): export a .glb with skin and animations."
        ) from error


def _values(gltf: pygltflib.GLTF2, blob: bytes, number: int) -> Array:
    accessor = gltf.accessors[number]
    view = gltf.bufferViews[accessor.bufferView]
    width = _WIDTHS[accessor.type]
    kind = np.dtype(_COMPONENTS[accessor.componentType])
    start = (view.byteOffset or 0) + (accessor.byteOffset or 0)
    if view.byteStride not in (None, 0, width * kind.itemsize):
        raise ValueError("interleaved values")
    values = np.frombuffer(blob, kind, accessor.count * width, start).reshape(accessor.count, width)
    if kind.kind != "f" and accessor.normalized:
        return np.maximum(values / np.iinfo(kind).max, -1.0)
    return values.astype(np.float64)


def _rig(
    gltf: pygltflib.GLTF2, blob: bytes, animation: pygltflib.Animation, fps: float, label: str
) -> RigMotion:
    moves: dict[int, dict[str, tuple[Array, Array]]] = {}
    end = 0.0
    for channel in animation.channels:
        sampler = animation.samplers[channel.sampler]
        times, values = _values(gltf, blob, sampler.input)[:, 0], _values(gltf, blob, sampler.output)
        if sampler.interpolation == "CUBICSPLINE":
            values = values[1::3]
        moves.setdefault(channel.target.node, {})[channel.target.path] = (times, values)
        end = max(end, float(times[-1]))
    if not 0 < end <= _MAX_SECONDS:
        raise ValueError(f"an animation of {end:.0f} s")
    grid = np.arange(0.0, end + 1e-6, 1 / fps)
    parents = {child: node for node, item in enumerate(gltf.nodes) for child in item.children or ()}
    worlds: dict[int, Array] = {}

    def world(node: int) -> Array:
        """(T, 4, 4) of a node."""
        if node not in worlds:
            local = _local(gltf.nodes[node], moves.get(node, {}), grid)
            worlds[node] = world(parents[node]) @ local if node in parents else local
        return worlds[node]

    joints = _in_order(list(gltf.skins[0].joints), parents)
    places = np.stack([world(joint)[:, :3, 3] for joint in joints], axis=1)
    inverse = _values(gltf, blob, gltf.skins[0].inverseBindMatrices).reshape(-1, 4, 4).swapaxes(-1, -2)
    bind = {
        joint: np.linalg.inv(matrix)[:3, 3]
        for joint, matrix in zip(gltf.skins[0].joints, inverse, strict=True)
    }
    up = [parents.get(joint) for joint in joints]
    chain = [joints.index(parent) if parent in joints else -1 for parent in up]
    rest = np.stack(
        [bind[j] - (bind[joints[p]] if p >= 0 else 0.0) for j, p in zip(joints, chain, strict=True)]
    )
    names = tuple(gltf.nodes[joint].name or f"node {joint}" for joint in joints)
    return RigMotion(names, tuple(chain), rest, places, None, fps, name=f"{label}: {animation.name}", up="y")


def _in_order(joints: list[int], parents: dict[int, int]) -> list[int]:
    """Parents before their children."""

    def depth(node: int) -> int:
        return 1 + depth(parents[node]) if node in parents else 0

    return sorted(joints, key=lambda joint: (depth(joint), joint))


def _local(node: pygltflib.Node, moves: dict[str, tuple[Array, Array]], grid: Array) -> Array:
    """(T, 4, 4) transform of a node against its parent."""
    place = _sampled(moves.get("translation"), node.translation or [0, 0, 0], grid)
    size = _sampled(moves.get("scale"), node.scale or [1, 1, 1], grid)
    if "rotation" in moves:
        times, values = moves["rotation"]
        turn = (
            Slerp(times, Rotation.from_quat(values))(np.clip(grid, times[0], times[-1])).as_matrix()
            if len(times) > 1
            else np.repeat(Rotation.from_quat(values[:1]).as_matrix(), len(grid), axis=0)
        )
    else:
        turn = np.repeat(Rotation.from_quat([node.rotation or [0, 0, 0, 1]]).as_matrix(), len(grid), axis=0)
    if node.matrix and node.translation is None and not moves:
        return np.repeat(
            np.array(node.matrix, dtype=float).reshape(1, 4, 4).swapaxes(-1, -2), len(grid), axis=0
        )
    local = np.zeros((len(grid), 4, 4))
    local[:, :3, :3] = turn * size[:, None, :]
    local[:, :3, 3] = place
    local[:, 3, 3] = 1.0
    return local


def _sampled(move: tuple[Array, Array] | None, rest: list[float], grid: Array) -> Array:
    if move is None:
        return np.repeat(np.array([rest], dtype=float), len(grid), axis=0)
    times, values = move
    return np.stack([np.interp(grid, times, column) for column in values.T], axis=-1)
