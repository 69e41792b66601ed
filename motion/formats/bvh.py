"""Biovision BVH: any rig in, and our two people out.

BVH gives each joint a list of channels; rotations apply in the order in which they are listed
(``Zrotation Xrotation Yrotation`` is R = Rz·Rx·Ry) and position channels replace the joint's OFFSET.
Neither the unit nor the up axis is written in the file: :mod:`motion.retarget` finds both from the body.

Frames are read and placed block after block: beside the file only the joints' places are held.
"""

from __future__ import annotations

import re
import warnings
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import scipy  # its parts are loaded with their first use
from numpy.typing import NDArray

from motion.clip import Clip
from motion.errors import InputError
from motion.retarget import in_metres
from motion.rigs import RigMotion
from motion.skeleton import SMPL22
from motion.vectors import Array

from .files import MAX_NUMBERS, check_duration, check_smpl, read_bytes, text_bytes
from .recording import MAX_PEOPLE
from .skinned import rigged

_LONGEST_HIERARCHY = 2**20
_ENOUGH = 50.0
"""Frames a second: what is left of a faster file that is no whole multiple of the wanted rate, at least."""


def read_bvh(
    source: str | Path | bytes, *, name: str | None = None, fps: float | None = None, file_fps: float | None = None
) -> tuple[RigMotion, ...]:
    """Reads a BVH file: the rig and the motion of each person, a ROOT each, who share one unit and one world.

    Args:
        source: a path, or the file's bytes.
        name: what to call the file in messages; its own name by default.
        fps: the rate that is wanted in the end. Of a faster file only every n-th frame is kept: those of a
            whole multiple of this rate, or of at least 50 a second. Files with SMPL22's own joints are kept
            whole, and so is every file by default.
        file_fps: the file's true rate, where it is not what the file says.

    Returns:
        lengths in metres, axes as in the file.

    Raises:
        InputError: one sentence saying where the file is wrong, and for more than six people.
    """
    data, label = read_bytes(source, name)
    data = text_bytes(data, label, "a BVH file")
    if not re.search(rb"^\s*HIERARCHY\b", data[:4096], re.IGNORECASE):
        raise InputError(f"{label} is not a BVH file: it does not begin with HIERARCHY.")
    line = re.compile(rb"^[ \t]*MOTION[ \t]*\r?$", re.MULTILINE | re.IGNORECASE)
    head = line.search(data, 0, min(len(data), _LONGEST_HIERARCHY))
    if head is None:
        if len(data) > _LONGEST_HIERARCHY:
            raise InputError(f"{label} has no MOTION part within its first megabyte: is it of another kind?")
        raise InputError(f"{label} has no MOTION part and may be cut short: export it again.")
    try:
        hierarchy = data[: head.start()].decode("utf-8")
    except UnicodeDecodeError:
        hierarchy = data[: head.start()].decode("latin-1")
    joints = parse_hierarchy(hierarchy, label)
    motion = find_motion(data, head.end(), joints, label, file_fps)
    people = [{joint.name for joint in joints[first:stop]} for first, stop in trees(joints, label)]
    own = any(names.issuperset(SMPL22.joint_names) for names in people)
    return _placed(motion, 1 if own or fps is None else _stride(motion.fps, fps))


def _stride(file_fps: float, fps: float) -> int:
    """Of how many frames of the file one is kept."""
    times = file_fps / fps
    if times >= 1 and abs(times - round(times)) < 1e-6:
        return round(times)
    return max(1, int(file_fps / max(fps, _ENOUGH)))


def _placed(motion: Motion, every: int) -> tuple[RigMotion, ...]:
    """Forward kinematics of every n-th frame."""
    joints, label = motion.joints, motion.label
    kept = -(-motion.frames // every)
    if 3 * kept * len(joints) > MAX_NUMBERS:
        raise InputError(f"{label} holds {len(joints)} joints in {kept:,} frames, too many: lower its frame rate.")
    positions = np.empty((kept, len(joints), 3), dtype=np.float32)
    done = 0
    for values, begun in _every_nth(motion, every):
        if not done:
            _forget_empty(joints, values)
        _place(joints, values, positions[begun : begun + len(values)])
        done = begun + len(values)
    assert done == kept
    return in_metres(
        [
            RigMotion(
                tuple(joint.name for joint in joints[first:stop]),
                tuple(max(joint.parent - first, -1) for joint in joints[first:stop]),
                np.array([joint.offset for joint in joints[first:stop]]),
                positions[:, first:stop],
                motion.fps / every,
                name=label,
                every=every,
                y_up=True,
            )
            for first, stop in trees(joints, label)
        ]
    )


def _every_nth(motion: Motion, every: int) -> Iterator[tuple[Array, int]]:
    """Blocks of the frames that are kept, with the number of the first among those."""
    frame = 0
    for block in motion.blocks():
        first = -frame % every
        yield block[first::every], (frame + first) // every
        frame += len(block)


def _forget_empty(joints: list[Joint], values: Array) -> None:
    """Position channels (n, width) below the root that are all zero mean that a joint stays at its OFFSET."""
    column = 0
    for joint in joints:
        its = values[:, column : column + len(joint.channels)]
        places = [kind == "position" for kind, _ in joint.channels]
        joint.keeps_offset = joint.parent >= 0 and not its[:, places].any()
        column += len(joint.channels)


def _place(joints: list[Joint], values: Array, positions: Array) -> None:
    """Writes the joints' places (n, J, 3), in the file's unit, for channels (n, width)."""
    world: list[tuple[Any, Array]] = []  # each joint's rotation and place
    column = 0
    for index, joint in enumerate(joints):
        its = values[:, column : column + len(joint.channels)]
        column += len(joint.channels)
        place: Array = np.tile(joint.offset, (len(values), 1))
        axes = ""
        degrees: list[Array] = []
        for (kind, axis), value in zip(joint.channels, its.T, strict=True):
            if kind == "rotation":
                axes, degrees = axes + "XYZ"[axis], [*degrees, value]
            elif not joint.keeps_offset:
                place[:, axis] = value
        rotation = scipy.spatial.transform.Rotation.identity(len(values))
        if axes:
            rotation = scipy.spatial.transform.Rotation.from_euler(axes, np.stack(degrees, axis=-1), degrees=True)
        if joint.parent >= 0:
            above, start = world[joint.parent]
            place, rotation = start + above.apply(place), above * rotation
        positions[:, index] = place
        world.append((rotation, place))


# ---- The HIERARCHY part ----------------------------------------------------------------------------------------------
MAX_JOINTS = 200
_LONGEST_NAME = 80
_AXES = {"x": 0, "y": 1, "z": 2}


@dataclass
class Joint:
    """A joint, or the tip of a chain; ``channels`` are ("position" or "rotation", axis) in their order."""

    name: str
    parent: int
    line: int
    index: int
    offset: tuple[float, float, float] = (0.0, 0.0, 0.0)
    channels: list[tuple[str, int]] = field(default_factory=list)
    is_end: bool = False
    keeps_offset: bool = False
    """Its position channels say nothing."""


def parse_hierarchy(text: str, label: str) -> list[Joint]:
    """The joints of a HIERARCHY part, parents first.

    Raises:
        InputError: one sentence with the line and joint where it is wrong.
    """
    joints: list[Joint] = []
    opened: list[Joint] = []  # the joints whose braces are open, the innermost last
    pending: Joint | None = None  # the joint whose "{" has not come yet
    for number, line in enumerate(text.splitlines(), 1):
        where = f"{label}, line {number}"
        # Braces may share a line with other words.
        for words in (piece.split() for piece in re.findall(r"[{}]|[^{}]+", line) if piece.strip()):
            keyword = words[0].upper()
            if keyword in ("ROOT", "JOINT", "END"):
                above = opened[-1] if opened else None
                pending = _joint(words, joints, above, number, where)
                joints.append(pending)
                if sum(not joint.is_end for joint in joints) > MAX_JOINTS or len(joints) > 2 * MAX_JOINTS:
                    raise InputError(f"{where}: more than {MAX_JOINTS} joints; export the body without extras.")
            elif keyword == "{":
                if pending is None:
                    raise InputError(f"{where}: '{{' without a joint before it.")
                opened, pending = [*opened, pending], None
            elif keyword == "}":
                if not opened:
                    raise InputError(f"{where}: one '}}' too many.")
                opened.pop()
            elif keyword == "OFFSET" and opened:
                opened[-1].offset = _three_numbers(words[1:], where, opened[-1].name)
            elif keyword == "CHANNELS" and opened:
                opened[-1].channels = _channels(words[1:], where, opened[-1].name)
            elif keyword != "HIERARCHY":
                raise InputError(f"{where}: {words[0][:40]!r} is not understood in the HIERARCHY part.")
    if last := opened[-1] if opened else pending:
        raise InputError(f"{label}: joint {last.name} (line {last.line}) is never closed by '}}'.")
    if not joints:
        raise InputError(f"{label} has no ROOT joint.")
    for first, stop in trees(joints, label):
        names = [joint.name for joint in joints[first:stop]]
        for joint in joints[first:stop]:
            if names.count(joint.name) > 1 and not joint.is_end:
                raise InputError(f"{label}, line {joint.line}: two joints are named {joint.name}: rename one.")
    return joints


def _joint(words: list[str], joints: list[Joint], above: Joint | None, number: int, where: str) -> Joint:
    """The joint of a ROOT, JOINT or End Site statement in the braces of the one ``above``."""
    is_end = words[0].upper() == "END"
    if above is None and words[0].upper() != "ROOT":
        what = "an End Site" if is_end else f"JOINT {' '.join(words[1:])}"
        raise InputError(f"{where}: {what} has no parent.")
    name = f"{above.name}_end" if is_end and above else " ".join(words[1:])[:_LONGEST_NAME]
    if not name:
        raise InputError(f"{where}: a joint has no name.")
    return Joint(name, -1 if above is None else above.index, number, index=len(joints), is_end=is_end)


def trees(joints: list[Joint], label: str) -> list[tuple[int, int]]:
    """(first, stop) joint of each person, who is a tree of joints; they follow one another."""
    roots = [index for index, joint in enumerate(joints) if joint.parent < 0]
    if len(roots) > MAX_PEOPLE:
        raise InputError(f"{label} holds {len(roots)} people: give {MAX_PEOPLE} or fewer in a file.")
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
    channels = []
    for word in words[1:]:
        match = re.fullmatch(r"([XYZ])(position|rotation)", word, re.IGNORECASE)
        if not match:
            raise InputError(f"{where}: joint {joint} has an unknown channel {word[:40]!r}.")
        channels.append((match[2].lower(), _AXES[match[1].lower()]))
    if not words or words[0] != str(len(channels)) or len(set(channels)) != len(channels):
        raise InputError(f"{where}: CHANNELS of joint {joint} must be a count and that many different channels.")
    return channels


# ---- The numbers of MOTION, block after block, never all at once -----------------------------------------------------
_PIECE = 2**20
_LARGEST = 1e7
_BLANK = re.compile(rb"\s*+")
_HEAD = re.compile(
    rb"Frames:[ \t]*+(\S{1,99}+)[ \t]*+\r?\n\s*+Frame[ \t]++Time:[ \t]*+(\S{1,99}+)[ \t]*+(?:\r?\n|$)", re.IGNORECASE
)


@dataclass(frozen=True)
class Motion:
    """Position of a file's numbers, and their header.

    Attributes:
        data: the file, in an encoding that writes numbers as ASCII does.
        start: of the numbers.
        frames: of ``width`` numbers each.
        fps: frames a second.
    """

    data: bytes
    start: int
    frames: int
    width: int
    fps: float
    joints: list[Joint]
    label: str

    def blocks(self) -> Iterator[Array]:
        """Blocks (n, width) of all frames in their order, each of about a megabyte of the file.

        Raises:
            InputError: if a number is missing, wrong or not usable.
        """
        short = (
            f"{self.label} is cut short: it says {self.frames} frames of {self.width} numbers but holds {{}} "
            "whole frames: export it again."
        )
        if self.frames * self.width > (len(self.data) - self.start + 1) // 2:  # a digit and a space each
            raise InputError(short.format("fewer"))
        start, done = self.start, 0
        rest: NDArray[np.floating] = np.empty(0)
        while done < self.frames and start < len(self.data):
            stop = _piece_end(self.data, start)
            try:
                piece = self.data[start:stop]
                numbers = np.empty(0) if piece.isspace() else np.fromstring(piece, dtype=np.float64, sep=" ")
            except ValueError:
                raise InputError(
                    f"{self.label}: after frame {done} something is not a number: export it again."
                ) from None
            numbers = np.concatenate([rest, numbers]) if len(rest) else numbers
            whole = min(len(numbers) // self.width, self.frames - done)
            block, rest = numbers[: whole * self.width].reshape(whole, self.width), numbers[whole * self.width :]
            if not np.abs(block).max(initial=0) <= _LARGEST:
                frame = done + int(np.argmax(~(np.abs(block) <= _LARGEST).all(axis=1))) + 1
                raise InputError(f"{self.label} has no usable number in frame {frame}: remove that frame.")
            start, done = stop, done + whole
            if whole:
                yield block
        if done < self.frames:
            raise InputError(short.format(done))


def find_motion(data: bytes, start: int, joints: list[Joint], label: str, file_fps: float | None = None) -> Motion:
    """The MOTION part whose head is at ``start``; a given rate stands for the file's, whatever that says.

    Raises:
        InputError: if the head is missing or says what cannot be.
    """
    blank = _BLANK.match(data, start)
    assert blank is not None  # nothing is blank, too
    head = _HEAD.match(data, blank.end())
    if not head:
        raise InputError(f"{label}: after MOTION there must be the lines 'Frames: N' and 'Frame Time: SECONDS'.")
    count, seconds = (words[:20].decode("latin-1") for words in head.groups())
    try:
        frames, frame_time = int(count), float(seconds.replace(",", "."))
    except ValueError:
        raise InputError(f"{label}: Frames {count!r} or Frame Time {seconds!r} is not a number.") from None
    if frames < 1:
        raise InputError(f"{label} holds no frames: export it again.")
    if file_fps is None and not 1e-4 < frame_time <= 1.0:
        raise InputError(
            f"{label}: a Frame Time of {frame_time:g} s is not possible, 0.0333 is usual: give its true rate."
        )
    fps = file_fps or _frame_rate(frame_time)
    check_duration(frames, fps, label)
    width = sum(len(joint.channels) for joint in joints)
    if width == 0:
        raise InputError(f"{label}: no joint has CHANNELS, so nothing moves: export it with its animation.")
    if frames * width > MAX_NUMBERS:
        raise InputError(f"{label} holds {frames * width:,} numbers, too many: lower its frame rate.")
    return Motion(data, head.end(), frames, width, fps, joints, label)


def _frame_rate(frame_time: float) -> float:
    """Frames a second; files round the frame time, so a rate within 0.05 % of a whole one is that one."""
    rate = 1.0 / frame_time
    return float(round(rate)) if abs(rate - round(rate)) < 5e-4 * rate else round(rate, 4)


def _piece_end(data: bytes, start: int) -> int:
    """End of a piece of about a megabyte: after a line, or after a word if lines are longer."""
    if start + _PIECE >= len(data):
        return len(data)
    for separator in (b"\n", b" "):
        end = data.rfind(separator, start, start + _PIECE)
        if end >= 0:
            return end + 1
    return start + _PIECE


# ---- Writing, with a standing T-pose as the rest pose ----------------------------------------------------------------
# Where the chains end beyond the last joints, in metres: the crown, the finger tips and the toe tips.
_TIPS = {
    "head": (0.0, 0.18, 0.02),
    "left_wrist": (0.17, 0.0, 0.0),
    "right_wrist": (-0.17, 0.0, 0.0),
    "left_foot": (0.01, -0.01, 0.07),
    "right_foot": (-0.01, -0.01, 0.07),
}


def bvh_bytes(clip: Clip) -> bytes:
    """One person's BVH: metres, Y up, on bones of the person's own lengths.

    Only the root has position channels and an OFFSET of zero, so that readers which add it and readers which replace
    it agree.

    Raises:
        InputError: for joints other than SMPL22's.
    """
    check_smpl(clip, "BVH")
    positions = clip.positions.astype(np.float64)
    rotations, offsets = rigged(clip)
    order: list[int] = []
    lines = ["HIERARCHY"]
    _write_joint(0, 0, offsets, lines, order)
    with warnings.catch_warnings():
        # In gimbal lock any split between two of the angles is right.
        warnings.simplefilter("ignore")
        angles = scipy.spatial.transform.Rotation.from_matrix(rotations[:, order].reshape(-1, 3, 3)).as_euler(
            "ZXY", degrees=True
        )
    angles = np.unwrap(angles.reshape(len(positions), -1), axis=0, period=360.0)
    values = np.concatenate([positions[:, 0], angles], axis=-1)
    lines += ["MOTION", f"Frames: {len(values)}", f"Frame Time: {1.0 / clip.fps:.8f}"]
    pattern = " ".join(["%.6f"] * values.shape[1])
    lines += [pattern % tuple(row) for row in values.tolist()]
    return ("\n".join(lines) + "\n").encode("ascii")


def _write_joint(joint: int, depth: int, offsets: Array, lines: list[str], order: list[int]) -> None:
    tab, inner = "\t" * depth, "\t" * (depth + 1)
    name = SMPL22.joint_names[joint]
    order.append(joint)
    lines += [f"{tab}{'JOINT' if depth else 'ROOT'} {name}", f"{tab}{{"]
    lines.append(f"{inner}OFFSET {_numbers(offsets[joint])}")
    positions = "" if depth else "Xposition Yposition Zposition "
    lines.append(f"{inner}CHANNELS {3 if depth else 6} {positions}Zrotation Xrotation Yrotation")
    for child in SMPL22.children[joint]:
        _write_joint(child, depth + 1, offsets, lines, order)
    if not SMPL22.children[joint]:
        lines += [f"{inner}End Site", f"{inner}{{", f"{inner}\tOFFSET {_numbers(_TIPS[name])}", f"{inner}}}"]
    lines.append(f"{tab}}}")


def _numbers(values: Array | tuple[float, ...]) -> str:
    return " ".join(f"{value:.6f}" for value in values)
