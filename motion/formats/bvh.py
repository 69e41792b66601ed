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
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import scipy  # its parts are loaded with their first use

from motion.clip import Clip
from motion.errors import InputError
from motion.retarget import metres_per_unit
from motion.rigs import RigMotion
from motion.skeleton import SMPL22
from motion.vectors import Array

from .bvh_numbers import Joint, Motion, find_motion, parse_hierarchy, trees
from .files import MAX_NUMBERS, check_smpl, read_bytes, text_bytes
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
    rigs = [
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
    scale = metres_per_unit(rigs[0])
    positions *= scale
    return tuple(replace(rig, offsets=rig.offsets * scale, metres_per_unit=scale) for rig in rigs)


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
        place, axes, degrees = np.tile(joint.offset, (len(values), 1)), "", []
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
