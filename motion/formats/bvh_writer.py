"""Two people as two BVH files in one world, each with a standing T-pose as its rest pose.

On the rig of another BVH file, what each joint is turned by is learned from the motion that the file holds itself:
beside the body's rotations (:func:`motion.body.bone_rotations`) of the same frames each joint has one constant
rotation, whatever its maker's rest pose. Limbs then point exactly where the person's do.
"""

from __future__ import annotations

import re
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
import scipy  # its parts are loaded with their first use
from numpy.typing import NDArray

from motion.body import bone_rotations
from motion.clip import Clip, Duet
from motion.kinematics import global_rotations, local_rotations
from motion.retarget import floor_on_smpl, retarget, up_rotation
from motion.rigs import RigMotion, matched_names
from motion.skeleton import SMPL22

from .bvh import read_bvh, read_rotations
from .bvh_numbers import Joint
from .files import ascii_bytes, check_smpl, read_bytes, write_files
from .skinned import posed, rigged, root_path

Array = NDArray[np.floating]

# Where the chains end beyond the last joints, in metres: the crown, the finger tips and the toe tips.
_TIPS = {
    "head": (0.0, 0.18, 0.02),
    "left_wrist": (0.17, 0.0, 0.0),
    "right_wrist": (-0.17, 0.0, 0.0),
    "left_foot": (0.01, -0.01, 0.07),
    "right_foot": (-0.01, -0.01, 0.07),
}


def write_bvh(duet: Duet, path: str | Path) -> list[Path]:
    """Writes ``NAME_a.bvh`` and ``NAME_b.bvh`` beside each other for a path ``NAME.bvh``.

    Metres, Y up, both in the duet's world; only the root has position channels and an OFFSET of zero, so
    that readers which add it and readers which replace it agree. Bones have each person's own lengths.

    Returns:
        the two paths.

    Raises:
        InputError: for people who are not on SMPL22, or where the files cannot be written.
    """
    path = Path(path)
    stem = path.name[: -len(".bvh")] if path.name.lower().endswith(".bvh") else path.name
    files = {path.with_name(f"{stem}_{letter}.bvh"): clip for letter, clip in zip("ab", duet.people, strict=True)}
    return write_files({file: bvh_text(clip).encode("ascii") for file, clip in files.items()})


def bvh_text(clip: Clip) -> str:
    """One person's BVH."""
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
    return "\n".join(lines) + "\n"


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


# ---- On the rig of another file --------------------------------------------------------------------------------------
_ENOUGH = 600
"""Frames of the file from which the rig is learned."""


def bvh_on_rig(clip: Clip, reference: str | Path | bytes, *, name: str | None = None) -> bytes:
    """One person's motion as a BVH file whose HIERARCHY is that of the reference, letter for letter.

    Args:
        clip: on SMPL22, metres.
        reference: a BVH file of one person, or its bytes; its motion shows how the rig is meant.
        name: what to call it in messages.

    Returns:
        the file, at the clip's frame rate, on the floor and in the world of the reference.

    Raises:
        InputError: for another skeleton, or a file that is no BVH of one person.
    """
    check_smpl(clip, "A rig")
    rig = read_bvh(reference, name=name)
    joints, turned, values = read_rotations(reference, name=name, most=_ENOUGH)
    frames = len(turned)
    rig = replace(rig, positions=rig.positions[:frames], rotations=None)
    rig = replace(rig, offsets=_bones(rig, global_rotations(turned, rig.bones)))
    upright = up_rotation(rig)
    pairs = {rig.joint_names.index(theirs): SMPL22.index(ours) for theirs, ours in matched_names(rig)}
    constants = _learned(rig, turned, upright, pairs)
    # Fingers and the like stay as they are on average.
    usual = np.stack([_mean_rotation(turned[:, joint]) for joint in range(len(joints))])
    usual[[joint for joint, parent in enumerate(rig.parents) if parent < 0]] = np.eye(3)
    world = posed(rig, rig.offsets, clip, pairs, constants, usual)
    local = local_rotations(world, rig.bones)
    local[:, 0] = upright.T @ world[:, 0]
    path = root_path(rig, rig.offsets, clip, world, floor_on_smpl(rig))
    root = path @ upright / rig.metres_per_unit
    return _rig_text(reference, name, joints, local, root, values, clip.fps)


def _bones(rig: RigMotion, world: Array) -> Array:
    """(J, 3) metres: the bones as the motion has them, where position channels make OFFSETs mean nothing."""
    offsets = np.array(rig.offsets)
    for joint, parent in enumerate(rig.parents):
        if parent >= 0:
            bone = (rig.positions[:, joint] - rig.positions[:, parent])[:, None] @ world[:, parent]
            offsets[joint] = np.median(bone[:, 0], axis=0)
    return offsets


def _learned(rig: RigMotion, turned: Array, upright: Array, pairs: dict[int, int]) -> dict[int, Array]:
    """The constant rotation of each matched joint beside the body's, from the file's own motion."""
    own = bone_rotations(retarget(rig, fps=rig.fps, plant=False).positions)
    world = global_rotations(turned, rig.bones)
    return {
        joint: _mean_rotation(np.swapaxes(own[:, ours], -1, -2) @ (upright @ world[:, joint]))
        for joint, ours in pairs.items()
    }


def _rig_text(
    reference: str | Path | bytes,
    name: str | None,
    joints: list[Joint],
    local: Array,
    root: Array,
    values: Array,
    fps: float,
) -> bytes:
    data, label = read_bytes(reference, name)
    data = ascii_bytes(data, label, "a BVH file")
    head = re.search(rb"^[ \t]*MOTION[ \t]*\r?$", data, re.MULTILINE | re.IGNORECASE)
    assert head is not None  # it has been read before
    columns: list[Array] = []
    usual = np.median(values, axis=0)
    for index, joint in enumerate(joints):
        axes = "".join("XYZ"[axis] for kind, axis in joint.channels if kind == "rotation")
        angles = iter(_angles(local[:, index], axes).T)
        for kind, axis in joint.channels:
            place = root[:, axis] if joint.parent < 0 else np.full(len(root), usual[len(columns)])
            columns.append(place if kind == "position" else next(angles))
    rows = np.stack(columns, axis=1)
    pattern = " ".join(["%.6f"] * rows.shape[1])
    lines = ["MOTION", f"Frames: {len(rows)}", f"Frame Time: {1.0 / fps:.8f}"]
    lines += [pattern % tuple(row) for row in rows.tolist()]
    return data[: head.start()] + "\n".join(lines).encode("ascii") + b"\n"


def _angles(rotations: Array, axes: str) -> Array:
    """(T, A) degrees about these axes in their order; a joint with fewer than three comes as near as it can."""
    found = scipy.spatial.transform.Rotation.from_matrix(rotations)
    if len(axes) == 3:
        return np.unwrap(found.as_euler(axes, degrees=True), axis=0, period=360.0)
    return np.degrees(found.as_rotvec())[:, ["XYZ".index(axis) for axis in axes]]


def _mean_rotation(rotations: Array) -> Array:
    """(3, 3) the rotation nearest to all of (T, 3, 3)."""
    left, _, right = np.linalg.svd(np.asarray(rotations, dtype=np.float64).sum(axis=0))
    return left @ np.diag([1.0, 1.0, np.linalg.det(left @ right)]) @ right
