"""Motion out of glTF binary files: an animated character, or several, of any rig."""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from motion.errors import InputError
from motion.retarget import metres_per_unit
from motion.rigs import RigMotion, match_joints
from motion.vectors import Array

from .bvh_numbers import MAX_NUMBERS
from .files import check_duration
from .glb_file import GlbFile, opened
from .glb_nodes import Channel, Rig, bind_pose, channels, moves, people, placed, with_those_above
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
        scale = np.float32(metres_per_unit(whole[0].motion(places[0], rate)))
        for its in places:
            its *= scale
        return tuple(
            person.motion(its, rate / every, float(scale), every) for person, its in zip(whole, places, strict=True)
        ), animations


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
    found = [_Person(file, parents, rig, still) for rig in rigs]
    whole = [person for person in found if person.problem is None]
    if not whole:
        assert found[0].problem is not None
        raise found[0].problem
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

    def motion(self, positions: Array, fps: float, scale: float = 1.0, every: int = 1) -> RigMotion:
        """Its joints where they are (T, J, 3), with the pose of binding as their rest pose."""
        bound = bind_pose(self.file, self.rig)
        across = np.array([-1.0 if self.mirrored else 1.0, 1.0, 1.0])
        rest = positions[0] if bound is None else bound[:, :3, 3] * across
        above = np.array(self.rig.above)
        found = RigMotion(
            self.names,
            self.rig.above,
            rest - np.where(above[:, None] < 0, 0.0, rest[np.maximum(above, 0)]),
            positions,
            fps,
            scale,
            self.file.label,
            every=every,
            mirrored=self.mirrored,
        )
        lengths = np.linalg.norm(found.offsets[above >= 0], axis=-1).sum()
        longer = found.bone_lengths.sum() / lengths if lengths > 1e-9 else 1.0
        return replace(found, offsets=found.offsets * longer)

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
    found = Animations(file.label, tuple(map(_shown, names)), tuple(numbers))
    return [known[number] for number in taken], found


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
