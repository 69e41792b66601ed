"""Biovision BVH: any rig in, and our two people out.

BVH gives each joint a list of channels; rotations apply in the order in which they are listed
(``Zrotation Xrotation Yrotation`` is R = Rz·Rx·Ry) and position channels replace the joint's OFFSET.
Neither the unit nor the up axis is written in the file: the unit is found from the size of the body here,
the up axis in :mod:`webdemo.motion.retarget`.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from webdemo.motion.errors import InputError
from webdemo.motion.rigs import RigMotion

from .crowd import MAX_PEOPLE
from .files import check_duration, decode_text, read_bytes

Array = NDArray[np.floating]

MAX_JOINTS = 200
MAX_NUMBERS = 20_000_000
_LONGEST_HIERARCHY = 2**20
_PIECE = 2**20
_LONGEST_NAME = 80

_AXES = {"x": 0, "y": 1, "z": 2}
_UNITS = {1.0: "m", 0.01: "cm", 0.001: "mm", 0.0254: "inch"}
# A person's height over the longest chain below the hips (leg and foot) or above (spine and arm).
_HEIGHT_PER_CHAIN = 1.7
_PERSON_HEIGHT = (1.2, 2.2)


@dataclass
class _Joint:
    name: str
    parent: int
    line: int
    offset: tuple[float, float, float] = (0.0, 0.0, 0.0)
    channels: list[tuple[str, int]] = field(default_factory=list)  # ("position" | "rotation", axis)
    is_end: bool = False


def read_bvh(source: str | Path | bytes, *, name: str | None = None) -> RigMotion:
    """Reads a BVH file.

    Args:
        source: a path, or the file's bytes.
        name: what to call the file in messages; its own name by default.

    Returns:
        the rig and its motion, lengths in metres, axes as in the file.

    Raises:
        InputError: one sentence with the line and joint where the file is wrong.
    """
    rigs = read_bvh_people(source, name=name)
    if len(rigs) > 1:
        raise InputError(
            f"{rigs[0].name} holds {len(rigs)} people, a ROOT each: choose one on the page, or give one "
            "person a file."
        )
    return rigs[0]


def read_bvh_people(source: str | Path | bytes, *, name: str | None = None) -> tuple[RigMotion, ...]:
    """The same for a file of several people, a ROOT each; they share one unit and one world.

    Raises:
        InputError: as :func:`read_bvh`, and for more than six people.
    """
    data, label = read_bytes(source, name)
    text = decode_text(data, label, "a BVH file")
    del data
    if not re.search(r"^\s*HIERARCHY\b", text[:4096], re.IGNORECASE):
        raise InputError(f"{label} is not a BVH file: it does not begin with HIERARCHY.")
    line = re.compile(r"^[ \t]*MOTION[ \t]*\r?$", re.MULTILINE | re.IGNORECASE)
    motion = line.search(text, 0, min(len(text), _LONGEST_HIERARCHY))
    if motion is None:
        if len(text) > _LONGEST_HIERARCHY:
            raise InputError(f"{label} has no MOTION part within its first megabyte: is it of another kind?")
        raise InputError(f"{label} has no MOTION part, it may be cut short: export it again.")
    joints = _parse_hierarchy(text[: motion.start()], label)
    frame_time, values = _parse_motion(text, motion.end(), joints, label)
    return _to_rigs(joints, values, frame_time, label)


def _parse_hierarchy(text: str, label: str) -> list[_Joint]:
    joints: list[_Joint] = []
    stack: list[int] = []
    pending: int | None = None  # the joint whose "{" has not come yet
    for number, line in enumerate(text.splitlines(), 1):
        # Braces may share a line with other words.
        for piece in re.findall(r"[{}]|[^{}]+", line):
            words = piece.split()
            if not words:
                continue
            keyword = words[0].upper()
            where = f"{label}, line {number}"
            if keyword in ("ROOT", "JOINT", "END"):
                if keyword == "JOINT" and not stack:
                    raise InputError(f"{where}: JOINT {' '.join(words[1:])} hangs on nothing.")
                parent = stack[-1] if stack else -1
                if keyword == "END":
                    if parent < 0:
                        raise InputError(f"{where}: an End Site hangs on nothing.")
                    given = f"{joints[parent].name}_end"
                else:
                    given = " ".join(words[1:])[:_LONGEST_NAME]
                    if not given:
                        raise InputError(f"{where}: a joint has no name.")
                joints.append(_Joint(given, parent, number, is_end=keyword == "END"))
                pending = len(joints) - 1
                if sum(not joint.is_end for joint in joints) > MAX_JOINTS or len(joints) > 2 * MAX_JOINTS:
                    raise InputError(
                        f"{where}: more than {MAX_JOINTS} joints; export the body without extras."
                    )
            elif keyword == "{":
                if pending is None:
                    raise InputError(f"{where}: '{{' without a joint before it.")
                stack.append(pending)
                pending = None
            elif keyword == "}":
                if not stack:
                    raise InputError(f"{where}: one '}}' too many.")
                stack.pop()
            elif keyword == "OFFSET" and stack:
                joints[stack[-1]].offset = _three_numbers(words[1:], where, joints[stack[-1]].name)
            elif keyword == "CHANNELS" and stack:
                joints[stack[-1]].channels = _channels(words[1:], where, joints[stack[-1]].name)
            elif keyword != "HIERARCHY":
                raise InputError(f"{where}: {words[0][:40]!r} is not understood in the HIERARCHY part.")
    if stack or pending is not None:
        open_joint = joints[stack[-1] if stack else pending or 0]
        raise InputError(
            f"{label}: joint {open_joint.name} (line {open_joint.line}) is never closed by '}}'."
        )
    if not joints:
        raise InputError(f"{label} has no ROOT joint.")
    for first, stop in _trees(joints, label):
        names = [joint.name for joint in joints[first:stop]]
        for joint in joints[first:stop]:
            if names.count(joint.name) > 1 and not joint.is_end:
                raise InputError(
                    f"{label}, line {joint.line}: two joints are named {joint.name}: rename one."
                )
    return joints


def _trees(joints: list[_Joint], label: str) -> list[tuple[int, int]]:
    """(first, stop) joint of each person, who is a tree of joints; they follow one another."""
    roots = [index for index, joint in enumerate(joints) if joint.parent < 0]
    if len(roots) > MAX_PEOPLE:
        raise InputError(f"{label} holds {len(roots)} people: give {MAX_PEOPLE} or fewer a file.")
    return list(zip(roots, [*roots[1:], len(joints)], strict=True))


def _three_numbers(words: list[str], where: str, joint: str) -> tuple[float, float, float]:
    try:
        x, y, z = (float(word) for word in words)
    except ValueError:
        raise InputError(
            f"{where}: OFFSET of joint {joint} must be three numbers, not {' '.join(words)[:40]!r}."
        ) from None
    if not np.isfinite([x, y, z]).all() or max(abs(x), abs(y), abs(z)) > 1e6:
        raise InputError(f"{where}: OFFSET of joint {joint} is not a usable length.")
    return x, y, z


def _channels(words: list[str], where: str, joint: str) -> list[tuple[str, int]]:
    found = []
    for word in words[1:]:
        match = re.fullmatch(r"([XYZ])(position|rotation)", word, re.IGNORECASE)
        if not match:
            raise InputError(f"{where}: joint {joint} has an unknown channel {word[:40]!r}.")
        found.append((match[2].lower(), _AXES[match[1].lower()]))
    if not words or words[0] != str(len(found)) or len(set(found)) != len(found):
        raise InputError(
            f"{where}: CHANNELS of joint {joint} must be a count and that many different channels."
        )
    return found


def _parse_motion(text: str, start: int, joints: list[_Joint], label: str) -> tuple[float, Array]:
    head = re.compile(
        r"\s*Frames:[ \t]*(\S+)[ \t]*\r?\n\s*Frame[ \t]+Time:[ \t]*(\S+)[ \t]*(?:\r?\n|$)", re.IGNORECASE
    ).match(text, start)
    if not head:
        raise InputError(
            f"{label}: after MOTION there must be the lines 'Frames: N' and 'Frame Time: SECONDS'."
        )
    try:
        frames, frame_time = int(head[1][:20]), float(head[2].replace(",", "."))
    except ValueError:
        raise InputError(
            f"{label}: Frames {head[1][:20]!r} or Frame Time {head[2][:20]!r} is not a number."
        ) from None
    if frames < 1:
        raise InputError(f"{label} holds no frames: export it again.")
    if not 1e-4 < frame_time <= 1.0:
        raise InputError(f"{label}: a Frame Time of {frame_time:g} s is not possible, 0.0333 is usual.")
    check_duration(frames, 1 / frame_time, label)
    width = sum(len(joint.channels) for joint in joints)
    if width == 0:
        raise InputError(f"{label}: no joint has CHANNELS, so nothing moves: export it with its animation.")
    if frames * width > MAX_NUMBERS:
        raise InputError(f"{label} holds {frames * width:,} numbers, too many: lower its frame rate.")
    values = _numbers(text, head.end(), frames, width, joints, label)
    values = values.reshape(frames, width)
    if not np.abs(values).max() <= 1e7:
        frame, column = np.argwhere(~(np.abs(values) <= 1e7))[0]
        raise InputError(
            f"{label}: joint {_joint_of_column(joints, column)} has no usable number in frame {frame + 1}: "
            "remove that frame."
        )
    return frame_time, values


def _numbers(text: str, start: int, frames: int, width: int, joints: list[_Joint], label: str) -> Array:
    """(frames · width,) numbers from ``start`` on, read piece by piece so that no part is held twice."""
    wanted = frames * width
    short = (
        f"{label} is cut short: it says {frames} frames of {width} numbers but holds {{}} whole "
        "frames: export it again."
    )
    if wanted > (len(text) - start + 1) // 2:  # a digit and a space each
        raise InputError(short.format("fewer"))
    values = np.empty(wanted)
    count = 0
    while count < wanted and start < len(text):
        stop = _piece_end(text, start)
        piece = text[start:stop]
        try:  # of spaces alone numpy makes a number, too
            found = np.empty(0) if piece.isspace() else np.fromstring(piece, dtype=np.float64, sep=" ")
        except ValueError:
            raise InputError(_bad_word(text, start, stop, count, width, joints, label)) from None
        taken = min(len(found), wanted - count)
        values[count : count + taken] = found[:taken]
        count += taken
        start = stop
    if count < wanted:
        raise InputError(short.format(count // width))
    return values


def _piece_end(text: str, start: int) -> int:
    """Where a piece of about a megabyte ends: behind a line, or a word where lines are longer than that."""
    if start + _PIECE >= len(text):
        return len(text)
    for separator in ("\n", " "):
        found = text.rfind(separator, start, start + _PIECE)
        if found >= 0:
            return found + 1
    return start + _PIECE


def _bad_word(
    text: str, start: int, stop: int, count: int, width: int, joints: list[_Joint], label: str
) -> str:
    """What in a piece is no number, with its line; ``count`` numbers came before it."""
    number = text.count("\n", 0, start)
    for line in text[start:stop].split("\n"):
        number += 1
        for word in line.split():
            try:
                float(word)
            except ValueError:
                joint = _joint_of_column(joints, count % width)
                return f"{label}, line {number}: {word[:20]!r} ({joint}) is not a number: export it again."
            count += 1
    return f"{label}, line {number}: something here is not a number: export it again."


def _joint_of_column(joints: list[_Joint], column: int) -> str:
    for joint in joints:
        if column < len(joint.channels):
            return joint.name
        column -= len(joint.channels)
    return joints[-1].name


def _to_rigs(joints: list[_Joint], values: Array, frame_time: float, label: str) -> tuple[RigMotion, ...]:
    frames = len(values)
    offsets = np.array([joint.offset for joint in joints])
    rotations = np.empty((frames, len(joints), 3, 3), dtype=np.float32)
    world: dict[int, Array] = {}  # of joints that still have children to come
    positions = np.empty((frames, len(joints), 3))
    last_child = {joint.parent: index for index, joint in enumerate(joints)}
    column = 0
    for index, joint in enumerate(joints):
        local = np.broadcast_to(offsets[index], (frames, 3)).copy()
        rotation = np.broadcast_to(np.eye(3), (frames, 3, 3))
        for kind, axis in joint.channels:
            if kind == "position":
                local[:, axis] = values[:, column]
            else:
                rotation = rotation @ _axis_rotation(axis, np.radians(values[:, column]))
            column += 1
        rotations[:, index] = rotation
        if joint.parent < 0:
            world[index], positions[:, index] = rotation, local
        else:
            carrier = world[joint.parent]
            positions[:, index] = positions[:, joint.parent] + (carrier @ local[..., None])[..., 0]
            if index in last_child:
                world[index] = carrier @ rotation
            if last_child[joint.parent] == index:
                del world[joint.parent]
    trees = _trees(joints, label)
    scale = _metres_per_unit(positions, joints[: trees[0][1]], label)
    positions *= scale
    return tuple(
        RigMotion(
            tuple(joint.name for joint in joints[first:stop]),
            tuple(max(joint.parent - first, -1) for joint in joints[first:stop]),
            offsets[first:stop] * scale,
            positions[:, first:stop],
            rotations[:, first:stop],
            _frame_rate(frame_time),
            scale,
            label,
        )
        for first, stop in trees
    )


def _axis_rotation(axis: int, angle: Array) -> Array:
    """(T, 3, 3) rotations by ``angle`` radians about a coordinate axis."""
    matrix = np.zeros((len(angle), 3, 3))
    i, j = (axis + 1) % 3, (axis + 2) % 3
    cos, sin = np.cos(angle), np.sin(angle)
    matrix[:, axis, axis] = 1
    matrix[:, i, i], matrix[:, j, j], matrix[:, i, j], matrix[:, j, i] = cos, cos, -sin, sin
    return matrix


def _frame_rate(frame_time: float) -> float:
    """Frames a second; files round the frame time, so a rate within 0.05 % of a whole one is that one."""
    rate = 1.0 / frame_time
    return float(round(rate)) if abs(rate - round(rate)) < 5e-4 * rate else round(rate, 4)


def _metres_per_unit(positions: Array, joints: list[_Joint], label: str) -> float:
    """The file's unit in metres, from the longest chain of bones that leaves the tree's first fork.

    Bone lengths do not depend on the pose, so a crouching or lying person is measured as well as a
    standing one. Files in no unit at all (CMU's) are scaled to an average person.
    """
    parents = [joint.parent for joint in joints]
    bones = np.zeros(len(parents))
    for joint, parent in enumerate(parents):
        if parent >= 0:
            bones[joint] = np.median(np.linalg.norm(positions[:, joint] - positions[:, parent], axis=-1))
    fork = next((joint for joint in range(len(parents)) if parents.count(joint) > 1), 0)
    reach = np.full(len(parents), -np.inf)
    reach[fork] = 0.0
    for joint, parent in enumerate(parents):
        if joint > fork and parent >= 0:
            reach[joint] = reach[parent] + bones[joint]
    height = _HEIGHT_PER_CHAIN * float(reach.max())
    if not height > 0:
        raise InputError(f"{label}: all joints lie in one point, the skeleton has no size.")
    for unit in _UNITS:
        if _PERSON_HEIGHT[0] <= height * unit <= _PERSON_HEIGHT[1]:
            return unit
    return 1.7 / height
