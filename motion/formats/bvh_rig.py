"""A person's motion on the rig of another BVH file: its joints, bones, rest pose, unit and axes.

What each of the rig's joints is turned by is learned from the motion that the file holds itself: beside the
body's rotations (:func:`motion.body.bone_rotations`) of the same frames each joint has one constant rotation,
whatever its maker's rest pose. Limbs then point exactly where the person's do.
"""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import scipy  # its parts are loaded with their first use
from numpy.typing import NDArray

from motion.body import bone_rotations
from motion.clip import Clip
from motion.retarget import floor_on_smpl, retarget, up_rotation
from motion.rigs import RigMotion, matched_names
from motion.skeleton import SMPL22

from .bvh import read_bvh, read_rotations
from .bvh_hierarchy import Joint
from .files import ascii_bytes, check_smpl, read_bytes
from .rig_pose import local_of, posed, root_path

Array = NDArray[np.floating]

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
    rig = replace(rig, offsets=_bones(rig, _world(turned, rig.parents)))
    upright = up_rotation(rig)
    pairs = {rig.joint_names.index(theirs): SMPL22.index(ours) for theirs, ours in matched_names(rig)}
    constants = _learned(rig, turned, upright, pairs)
    # Fingers and the like stay as they are on average.
    usual = np.stack([_mean_rotation(turned[:, joint]) for joint in range(len(joints))])
    usual[[joint for joint, parent in enumerate(rig.parents) if parent < 0]] = np.eye(3)
    world = posed(rig, rig.offsets, clip, pairs, constants, usual)
    local = local_of(world, rig.parents)
    local[:, 0] = upright.T @ world[:, 0]
    path = root_path(rig, rig.offsets, clip, world, floor_on_smpl(rig))
    root = path @ upright / rig.metres_per_unit
    return _text(reference, name, joints, local, root, values, clip.fps)


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
    world = _world(turned, rig.parents)
    return {
        joint: _mean_rotation(np.swapaxes(own[:, ours], -1, -2) @ (upright @ world[:, joint]))
        for joint, ours in pairs.items()
    }


def _text(
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


def _world(local: Array, parents: tuple[int, ...]) -> Array:
    world = np.array(local, dtype=np.float64)
    for joint, parent in enumerate(parents):
        if parent >= 0:
            world[:, joint] = world[:, parent] @ world[:, joint]
    return world


def _mean_rotation(rotations: Array) -> Array:
    """(3, 3) the rotation nearest to all of (T, 3, 3)."""
    left, _, right = np.linalg.svd(np.asarray(rotations, dtype=np.float64).sum(axis=0))
    return left @ np.diag([1.0, 1.0, np.linalg.det(left @ right)]) @ right
