"""Motion out of glTF binary files: an animated character, or several, of any rig."""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import scipy  # its parts are loaded with their first use

from motion.errors import InputError
from motion.kinematics import rotation_matrices
from motion.retarget import in_metres
from motion.rigs import RigMotion, match_joints
from motion.vectors import Array

from .files import MAX_NUMBERS, check_duration
from .glb_file import MOST_JOINTS, GlbFile, Stored, opened
from .recording import MAX_PEOPLE, Animation, Animations, check_animation, listed

_RATES = (10.0, 240.0)
_RATE = 30.0
_MOST = 60.0
_AT_ONCE = 400_000
"""Nodes that are placed at once, over all frames of a block."""
_FARTHEST = 1e6


def read_glb(
    source: str | Path | bytes, *, name: str | None = None, animation: Animation | None = None
) -> tuple[tuple[RigMotion, ...], Animations]:
    """The animated people in a .glb file, who share one clock, one unit and one world, and its animations.

    Key frames are read at the rate of the densest channel, at 60 a second at most; keys further apart than a tenth of
    a second are filled in at 30.

    Args:
        source: a path, or the file's bytes.
        name: what to call the file in messages; its own name by default.
        animation: the name or the number, from 1, of the one that is read of several; the first by default.

    Raises:
        InputError: one sentence that says what is wrong with the file and what to do.
    """
    with opened(source, name) as file:
        whole = _whole(file)
        nodes = [set(person.nodes) for person in whole]
        taken, animations = chosen(file, nodes, animation)
        moved = [channels(file, each, its) for each, its in zip(taken, nodes, strict=True)]
        moments, rate, every = _clock(file, moved, sum(len(person.nodes) for person in whole))
        places = [person.at(its, moments) for person, its in zip(whole, moved, strict=True)]
        rigs = [person.motion(its, rate / every, every) for person, its in zip(whole, places, strict=True)]
        return in_metres(rigs), animations


def animations_in(source: str | Path | bytes) -> Animations:
    """The animations that :func:`read_glb` finds in a file, without their key frames."""
    with opened(source, None) as file:
        return chosen(file, [person.nodes for person in _whole(file)], None)[1]


def _whole(file: GlbFile) -> list[_Person]:
    """The people in a file with animations, one at least and not too many."""
    parents = file.node_parents()
    if not file.document.get("animations"):
        raise InputError(f"{file.label} has no animation: export it with one.")
    rigs = people(file, parents)
    still = placed(file, with_those_above([node for rig in rigs for node in rig.nodes], parents), parents)
    bodies = [_Person(file, parents, rig, still) for rig in rigs]
    whole = [person for person in bodies if person.problem is None]
    if not whole:
        assert bodies[0].problem is not None
        raise bodies[0].problem
    if len(whole) > MAX_PEOPLE:
        file.refuse(f"it holds {len(whole)} people", f"export {MAX_PEOPLE} at most")
    return whole


class _Person:
    """One skeleton of a file, whose nodes at rest are given; ``problem`` says why it is not a person's."""

    def __init__(self, file: GlbFile, parents: Sequence[int], rig: Rig, still: dict[int, Array]) -> None:
        self.file, self.parents, self.rig = file, parents, rig
        self.nodes = with_those_above(rig.nodes, parents)
        self.names = tuple(file.joint_name(node) for node in rig.nodes)
        self.problem: InputError | None = None
        self.mirrored = bool(np.linalg.det(still[rig.nodes[0]][0, :3, :3]) < 0)
        rest = self._joints(still, 1)
        try:
            match_joints(self.motion(rest, _RATE))
        except InputError as error:
            self.problem = error

    def motion(self, positions: Array, fps: float, every: int = 1) -> RigMotion:
        """Its joints where they are (T, J, 3), with the pose of binding as their rest pose."""
        bound = bind_pose(self.file, self.rig)
        across = np.array([-1.0 if self.mirrored else 1.0, 1.0, 1.0])
        rest = positions[0] if bound is None else bound[:, :3, 3] * across
        above = np.array(self.rig.above)
        recorded = RigMotion(
            self.names,
            self.rig.above,
            rest - np.where(above[:, None] < 0, 0.0, rest[np.maximum(above, 0)]),
            positions,
            fps,
            name=self.file.label,
            every=every,
            mirrored=self.mirrored,
        )
        lengths = np.linalg.norm(recorded.offsets[above >= 0], axis=-1).sum()
        longer = recorded.bone_lengths.sum() / lengths if lengths > 1e-9 else 1.0
        return replace(recorded, offsets=recorded.offsets * longer)

    def at(self, moved: Sequence[Channel], moments: Array) -> Array:
        """(T, J, 3) float32 places of the joints at moments in seconds, in the file's unit."""
        block = max(1, _AT_ONCE // len(self.nodes))
        positions = np.empty((len(moments), len(self.names), 3), dtype=np.float32)
        for start in range(0, len(moments), block):
            part = moments[start : start + block]
            world = placed(self.file, self.nodes, self.parents, moved, part)
            positions[start : start + block] = self._joints(world, len(part))
        if not (positions.min() >= -_FARTHEST and positions.max() <= _FARTHEST):  # NaN is neither
            self.file.refuse("its joints fly away")
        return positions

    def _joints(self, world: dict[int, Array], frames: int) -> Array:
        places = [np.broadcast_to(world[node][:, :3, 3], (frames, 3)) for node in self.rig.nodes]
        return np.stack(places, axis=1)


def _clock(file: GlbFile, moved: Sequence[Sequence[Channel]], nodes: int) -> tuple[Array, float, int]:
    """The moments that are read, in seconds, the file's frames a second, and of how many of them one is read."""
    known = [each for its in moved for each in its]
    begin = min(float(each.times[0]) for each in known)
    seconds = max(float(each.times[-1]) for each in known) - begin
    rate = _rate(known)
    every = max(1, math.ceil(rate / _MOST - 1e-6))
    check_duration(round(seconds * rate) + 1, rate, file.label)
    count = int(seconds * rate / every + 1e-3) + 1
    if 3 * count * nodes > MAX_NUMBERS:
        file.refuse(f"it holds {nodes} nodes in {count:,} frames", "cut the motion or lower its frame rate")
    return begin + np.arange(count) * every / rate, rate, every


def _rate(moved: Sequence[Channel]) -> float:
    """Frames a second of the densest channel."""
    clocks = {id(each.times): each.times for each in moved if len(each.times) > 2}  # channels share them
    steps = [float(np.median(np.diff(times))) for times in clocks.values()]
    step = min((each for each in steps if each > 0), default=1.0)
    rate = 1.0 / step
    if not _RATES[0] <= rate <= _RATES[1]:
        return _RATE if rate < _RATES[0] else _RATES[1]
    return float(round(rate)) if abs(rate - round(rate)) < 5e-3 * rate else round(rate, 4)


# ---- The nodes: where they stand at rest and while an animation moves them -------------------------------------------
MOST_KEYS = 4_000_000
"""Key frames of all channels together; those that channels share count once."""
_NO_FIT = "its key frames do not fit their times"
_PATHS = {"translation": "VEC3", "rotation": "VEC4", "scale": "VEC3"}
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
    rigs = []
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
        rigs.append(Rig(tuple(ordered), tuple(above), tuple(sorted(its_skins))))
    return rigs


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
    matrices: dict[int, Array] = {}
    for number in rig.skins:
        skin = file.document["skins"][number]
        joints = file.skin_joints(skin)
        if skin.get("inverseBindMatrices") is None:
            return None
        matrices |= dict(zip(joints, file.bind_matrices(skin, len(joints)), strict=True))
    return np.stack([matrices[node] for node in rig.nodes]) if matrices else None


def moves(animation: Any, nodes: set[int]) -> bool:
    """True if an animation has channels of these nodes."""
    targets = (channel["target"] for channel in animation["channels"])
    return any(target.get("path") in _PATHS and target.get("node") in nodes for target in targets)


def channels(file: GlbFile, animation: Any, nodes: set[int]) -> list[Channel]:
    """The channels of an animation that move these nodes, at most one for each property.

    All key frames are counted before the first is decoded, and those that several channels share are decoded once.
    """
    listed = _stored_channels(file, animation, nodes)
    stored = {part for *_, times, values in listed for part in (times, values)}
    if sum(values.rows for values in {values for *_, values in listed}) >= MOST_KEYS:
        file.refuse(f"it has more than {MOST_KEYS:,} key frames", "lower its frame rate")
    if sum(part.size for part in stored) > len(file.blob):
        file.refuse("its key frames overlap")
    tables = {part: file.decoded(part, "key frames").astype(np.float64, copy=False) for part in stored}
    clocks = {times: tables[times][:, 0] for *_, times, _ in listed}
    if any((np.diff(times) < 0).any() or times[0] < 0 for times in clocks.values()):
        file.refuse(_NO_FIT)
    splines = {
        values: tables[values].reshape(-1, 3, tables[values].shape[1])
        for _, _, way, _, values in listed
        if way == "CUBICSPLINE"
    }
    return [
        Channel(node, path, clocks[times], (splines if way == "CUBICSPLINE" else tables)[values], way)
        for node, path, way, times, values in listed
    ]


def _stored_channels(file: GlbFile, animation: Any, nodes: set[int]) -> list[tuple[int, str, str, Stored, Stored]]:
    """Node, path, way, times and values of each channel, not decoded yet."""
    count = len(file.document.get("nodes", []))
    samplers = animation["samplers"]
    channels: dict[tuple[int, str], tuple[int, str, str, Stored, Stored]] = {}
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
        values = file.stored(sampler["output"], _PATHS[path], 3 * MOST_KEYS, "key frames")
        if values.rows != (3 if way == "CUBICSPLINE" else 1) * times.rows:
            file.refuse(_NO_FIT)
        channels[node, path] = (node, path, way, times, values)
    return list(channels.values())


def _numbers(file: GlbFile, values: Any, count: int) -> Array:
    numbers = np.array(values, dtype=np.float64)
    if numbers.shape != (count,) or not np.isfinite(numbers).all() or np.abs(numbers).max() > 1e9:
        file.refuse("a node in it stands nowhere")
    return numbers


def matrices(parts: dict[str, Array]) -> Array:
    """(T, 4, 4) of translations (T or 1, 3), rotations (T or 1, 4) and scales (T or 1, 3)."""
    frames = max(len(part) for part in parts.values())
    local = np.zeros((frames, 4, 4))
    local[:, :3, :3] = rotation_matrices(parts["rotation"]) * parts["scale"][:, None]
    local[:, :3, 3] = parts["translation"]
    local[:, 3, 3] = 1.0
    return local


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


# ---- Which animation is read -----------------------------------------------------------------------------------------
_LONGEST = 40
"""Characters of a name that are shown."""


def chosen(
    file: GlbFile, people: Sequence[Collection[int]], animation: Animation | None
) -> tuple[list[Any], Animations]:
    """One animation for each person, and what there was to choose from.

    A person whom the chosen animation does not move keeps the first of their own.

    Args:
        file: whose animations.
        people: the nodes that each person moves by.
        animation: its name, or its number among those that move a person; the first by default.

    Raises:
        InputError: where a person has none, or there is none of this name or number.
    """
    known = file.document["animations"]
    joints = [set(nodes) for nodes in people]
    moved = [{who for who, nodes in enumerate(joints) if moves(each, nodes)} for each in known]
    theirs = [number for number, who in enumerate(moved) if who]
    if set().union(*moved) < set(range(len(people))):
        raise InputError(f"{file.label} has an animation, but it moves no joint of the skeleton: export it again.")
    names = [known[number].get("name") for number in theirs]
    first = theirs[0 if animation is None else _found(names, animation, file.label)]
    taken = [
        first if who in moved[first] else next(number for number in theirs if who in moved[number])
        for who in range(len(people))
    ]
    numbers = sorted({theirs.index(number) + 1 for number in taken})
    animations = Animations(file.label, tuple(map(_shown, names)), tuple(numbers))
    return [known[number] for number in taken], animations


def _found(names: Sequence[Any], animation: Animation, label: str) -> int:
    """The index of an animation by its name, or else by its number."""
    check_animation(animation)
    if isinstance(animation, str):
        asked = animation.strip()
        for same in (str, str.casefold):
            for index, name in enumerate(names):
                if isinstance(name, str) and same(name.strip()) == same(asked):
                    return index
        animation = int(asked) if asked.isdecimal() and len(asked) < 9 else 0
    if not 1 <= animation <= len(names):
        those = listed([_shown(name) for name in names], range(1, len(names) + 1), "or")
        raise InputError(f"{label} has no such animation: choose {those}.")
    return animation - 1


def _shown(name: Any) -> str:
    """A name on one line, without characters that cannot be seen, cut where it is too long."""
    if not isinstance(name, str):
        return ""
    seen = "".join(each if each.isprintable() else " " for each in name[: 10 * _LONGEST])
    seen = " ".join(seen.split())
    return seen if len(seen) <= _LONGEST else f"{seen[: _LONGEST - 1].rstrip()}…"
