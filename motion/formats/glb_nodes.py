"""The nodes of a glTF file: where they stand at rest and while an animation moves them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import scipy  # its parts are loaded with their first use

from motion.kinematics import rotation_matrices
from motion.vectors import Array

from .glb_file import MOST_JOINTS, GlbFile, Stored

MOST_KEYS = 4_000_000
"""Key frames of all channels together; those that channels share count once."""
_NO_FIT = "its key frames do not fit their times"
_PATHS = {"translation": ("VEC3", 3), "rotation": ("VEC4", 4), "scale": ("VEC3", 3)}
_DEFAULTS = {"translation": (0.0, 0.0, 0.0), "rotation": (0.0, 0.0, 0.0, 1.0), "scale": (1.0, 1.0, 1.0)}


@dataclass(frozen=True, eq=False)
class Rig:
    """One person's joints in a file, parents first.

    Attributes:
        nodes: the joints' nodes.
        above: index of the nearest joint above each, -1 for none.
        skins: those that the joints are of; empty for a file without any.
    """

    nodes: tuple[int, ...]
    above: tuple[int, ...]
    skins: tuple[int, ...]


@dataclass(frozen=True, eq=False)
class Channel:
    """Key frames of one property of a node.

    Attributes:
        node: which moves.
        path: "translation", "rotation" or "scale".
        times: (K,) seconds, in order.
        values: (K, 3 or 4); (K, 3, 3 or 4) with their tangents for a spline.
        way: "LINEAR", "STEP" or "CUBICSPLINE".
    """

    node: int
    path: str
    times: Array = field(repr=False)
    values: Array = field(repr=False)
    way: str

    def at(self, moments: Array) -> Array:
        """(T, 3 or 4) at moments (T,) in seconds; before the first key and after the last it rests."""
        times = self.times
        keys = self.values[:, 1] if self.way == "CUBICSPLINE" else self.values
        if len(times) == 1:
            return np.repeat(keys, len(moments), axis=0)
        after = np.clip(np.searchsorted(times, moments, side="right"), 1, len(times) - 1)
        before = after - 1
        span = np.maximum(times[after] - times[before], 1e-9)
        share = np.clip((moments - times[before]) / span, 0.0, 1.0)[:, None]
        if self.way == "STEP":
            return np.where(share > 0.999, keys[after], keys[before])  # times are rounded
        one, other = keys[before], keys[after]
        if self.way == "CUBICSPLINE":
            leaving, arriving = self.values[before, 2] * span[:, None], self.values[after, 0] * span[:, None]
            square, cube = share**2, share**3
            return (
                (2 * cube - 3 * square + 1) * one
                + (cube - 2 * square + share) * leaving
                + (3 * square - 2 * cube) * other
                + (cube - square) * arriving
            )
        if self.path != "rotation":
            return one + share * (other - one)
        first, second = (scipy.spatial.transform.Rotation.from_quat(each) for each in (one, other))
        turned = scipy.spatial.transform.Rotation.from_rotvec(share * (first.inv() * second).as_rotvec())
        return (first * turned).as_quat()


def people(file: GlbFile, parents: Sequence[int]) -> list[Rig]:
    """The skeletons of a file: skins that share joints are one; without skins all nodes are."""
    skins = file.document.get("skins", [])
    groups: list[tuple[set[int], list[int]]] = []
    for number, skin in enumerate(skins):
        joints = set(file.skin_joints(skin))
        its = [group for group in groups if group[0] & joints]
        merged = joints.union(*(group[0] for group in its)), [n for group in its for n in group[1]] + [number]
        groups = [group for group in groups if group not in its] + [merged]
    if not groups:
        bare = {n for n, node in enumerate(file.document.get("nodes", [])) if node.get("mesh") is None}
        groups = [(bare, [])]
    if not groups[0][0] or any(len(joints) > MOST_JOINTS for joints, _ in groups):
        file.refuse(f"it has no joints, or more than {MOST_JOINTS}")
    found = []
    for joints, its_skins in groups:
        nearest = {-1: -1}  # for each node, the place of the joint that it is, or that is next above it
        ordered: list[int] = []
        above: list[int] = []
        for node in with_those_above(sorted(joints), parents):
            nearest[node] = nearest[parents[node]]
            if node in joints:
                above.append(nearest[node])
                nearest[node] = len(ordered)
                ordered.append(node)
        found.append(Rig(tuple(ordered), tuple(above), tuple(sorted(its_skins))))
    return found


def with_those_above(nodes: Sequence[int], parents: Sequence[int]) -> list[int]:
    """Nodes and all above them, those above first."""
    needed: dict[int, None] = {}
    for node in nodes:
        way = []
        while node >= 0 and node not in needed:
            way.append(node)
            node = parents[node]
        needed |= dict.fromkeys(reversed(way))
    return list(needed)


def bind_pose(file: GlbFile, rig: Rig) -> Array | None:
    """(J, 4, 4) the joints while the mesh is as it is stored, in the mesh's axes; None where a skin does not say."""
    found: dict[int, Array] = {}
    for number in rig.skins:
        skin = file.document["skins"][number]
        joints = file.skin_joints(skin)
        if skin.get("inverseBindMatrices") is None:
            return None
        found |= dict(zip(joints, file.bind_matrices(skin, len(joints)), strict=True))
    return np.stack([found[node] for node in rig.nodes]) if found else None


def moves(animation: Any, nodes: set[int]) -> bool:
    """True if an animation has channels of these nodes."""
    targets = (channel["target"] for channel in animation["channels"])
    return any(target.get("path") in _PATHS and target.get("node") in nodes for target in targets)


def channels(file: GlbFile, animation: Any, nodes: set[int]) -> list[Channel]:
    """The channels of an animation that move these nodes, at most one for each property.

    All key frames are counted before the first is decoded, and those that several channels share are decoded once.
    """
    found = _stored_channels(file, animation, nodes)
    stored = {part for *_, times, values in found for part in (times, values)}
    if sum(values.rows for values in {values for *_, values in found}) >= MOST_KEYS:
        file.refuse(f"it has more than {MOST_KEYS:,} key frames", "lower its frame rate")
    if sum(part.size for part in stored) > len(file.blob):
        file.refuse("its key frames overlap")
    tables = {part: file.decoded(part, "key frames").astype(np.float64, copy=False) for part in stored}
    clocks = {times: tables[times][:, 0] for *_, times, _ in found}
    if any((np.diff(times) < 0).any() or times[0] < 0 for times in clocks.values()):
        file.refuse(_NO_FIT)
    splines = {
        values: tables[values].reshape(-1, 3, tables[values].shape[1])
        for _, _, way, _, values in found
        if way == "CUBICSPLINE"
    }
    return [
        Channel(node, path, clocks[times], (splines if way == "CUBICSPLINE" else tables)[values], way)
        for node, path, way, times, values in found
    ]


def _stored_channels(file: GlbFile, animation: Any, nodes: set[int]) -> list[tuple[int, str, str, Stored, Stored]]:
    """Node, path, way, times and values of each channel, not decoded yet."""
    count = len(file.document.get("nodes", []))
    samplers = animation["samplers"]
    found: dict[tuple[int, str], tuple[int, str, str, Stored, Stored]] = {}
    for channel in animation["channels"]:
        target = channel["target"]
        if target.get("node") is None or target.get("path") not in _PATHS:
            continue
        node, path = file.index(target["node"], count, "node"), target["path"]
        if node not in nodes:
            continue
        sampler = samplers[file.index(channel["sampler"], len(samplers), "sampler")]
        way = sampler.get("interpolation", "LINEAR")
        if way not in ("LINEAR", "STEP", "CUBICSPLINE"):
            file.refuse(f"it moves in a way {way!r:.20} that is not known")
        times = file.stored(sampler["input"], "SCALAR", MOST_KEYS, "key frames")
        values = file.stored(sampler["output"], _PATHS[path][0], 3 * MOST_KEYS, "key frames")
        if values.rows != (3 if way == "CUBICSPLINE" else 1) * times.rows:
            file.refuse(_NO_FIT)
        found[node, path] = (node, path, way, times, values)
    return list(found.values())


def _numbers(file: GlbFile, values: Any, count: int) -> Array:
    found = np.array(values, dtype=np.float64)
    if found.shape != (count,) or not np.isfinite(found).all() or np.abs(found).max() > 1e9:
        file.refuse("a node in it stands nowhere")
    return found


def matrices(parts: dict[str, Array]) -> Array:
    """(T, 4, 4) of translations (T or 1, 3), rotations (T or 1, 4) and scales (T or 1, 3)."""
    frames = max(len(part) for part in parts.values())
    found = np.zeros((frames, 4, 4))
    found[:, :3, :3] = rotation_matrices(parts["rotation"]) * parts["scale"][:, None]
    found[:, :3, 3] = parts["translation"]
    found[:, 3, 3] = 1.0
    return found


def placed(
    file: GlbFile,
    nodes: Sequence[int],
    parents: Sequence[int],
    moved: Sequence[Channel] = (),
    moments: Array | None = None,
) -> dict[int, Array]:
    """World matrices (T, 4, 4) of nodes with those above them, at moments in seconds; (1, 4, 4) at rest.

    Args:
        file: whose nodes.
        nodes: as :func:`with_those_above` gives them.
        parents: of each node of the file.
        moved: channels of these nodes.
        moments: (T,) seconds.
    """
    world: dict[int, Array] = {}
    courses: dict[tuple[int, int, str, str], Array] = {}  # what channels share is worked out once
    by_node: dict[int, list[Channel]] = {}
    for each in moved:
        by_node.setdefault(each.node, []).append(each)
    for node in nodes:
        stored = file.document["nodes"][node]
        parts = {path: _numbers(file, stored.get(path, rest), len(rest))[None] for path, rest in _DEFAULTS.items()}
        if moments is not None:
            for each in by_node.get(node, ()):
                course = (id(each.times), id(each.values), each.path, each.way)
                if course not in courses:
                    courses[course] = each.at(moments)
                parts[each.path] = courses[course]
        local = matrices(parts)
        if stored.get("matrix") is not None:  # no animation moves such a node
            local = _numbers(file, stored["matrix"], 16).reshape(1, 4, 4).swapaxes(1, 2)
            local[:, 3] = (0.0, 0.0, 0.0, 1.0)
        world[node] = world[parents[node]] @ local if parents[node] >= 0 else local
    return world
