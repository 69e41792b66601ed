"""Parameters of SMPL bodies: AMASS' and Inter-X' .npz in, AMASS' out.

A person is a rotation vector (axis × angle) of each joint against its parent, the root's against the world, and a
path ``trans``. SMPL's body model, which would make joints of them, may not be shipped: the bones are those of
:data:`~motion.SMPL22`, an average adult's. A file that gives its person's shape as ``betas`` is read without it.
"""

from __future__ import annotations

import io
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import scipy  # its parts are loaded with their first use
from numpy.typing import NDArray

from motion.clip import Clip, Duet
from motion.errors import InputError
from motion.kinematics import fit_rotations, forward_kinematics
from motion.looks import size_of
from motion.sizes import of_adults
from motion.skeleton import SMPL22

from .arrays import frame_rate, no_rate, numbers
from .files import check_duration, write_files

Array = NDArray[Any]

SUFFIX = ".smpl.npz"
FPS_KEYS = ("mocap_framerate", "mocap_frame_rate", "fps")
PARAMETER_KEYS = ("poses", "pose_body", "root_orient", "trans", "betas", *FPS_KEYS)
PELVIS = np.array([-0.00179506, -0.22333382, 0.02821918])
"""Metres: the pelvis of SMPL's neutral body in its own frame. A body's pelvis is at ``trans`` plus this."""
SHAPE_UNUSED = (
    "{} gives its person's shape, which only SMPL's own body model can apply: the bones are an average adult's, so "
    "positions are approximate."
)
INTERX_FPS = 120.0
_BODY = 3 * SMPL22.num_joints
_POSES = 156
"""Columns of AMASS' ``poses``: SMPL+H's 52 joints, of which 30 are fingers."""
_BETAS = 16
_AT_ONCE = 4096
"""Frames of which rotations are made at a time."""
_Z_UP_TO_Y_UP = np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]])


def has_parameters(arrays: Mapping[str, Array]) -> bool:
    """True if these are the arrays of a person of AMASS or of Inter-X."""
    return "trans" in arrays and ("poses" in arrays or {"pose_body", "root_orient"} <= set(arrays))


def read_parameters(arrays: Mapping[str, Array], label: str, fps: float | None) -> Clip:
    """The person of a file, where the file puts them, heights included.

    Args:
        arrays: ``trans`` (T, 3) with AMASS' ``poses`` (T, 66 or more), or with Inter-X' ``root_orient`` (T, 3) and
            ``pose_body`` (T, 63) or (T, 21, 3); the rate under one of :data:`FPS_KEYS`.
        label: the file's name in messages.
        fps: frame rate where the file gives none; 30 by default, and 120 for Inter-X.

    Returns:
        a clip with rotations, Y up. AMASS is Z up; of Inter-X' files the axis along which the body stands is taken.

    Raises:
        InputError: one sentence saying what is wrong with the arrays.
    """
    interx = "poses" not in arrays
    poses, trans = _joined(arrays, label) if interx else _amass(arrays, label)
    stored = next((arrays[key] for key in FPS_KEYS if key in arrays), None)
    rate = frame_rate(stored, fps, label, usual=INTERX_FPS if interx else 30.0)
    check_duration(len(poses), rate, label)
    notes = () if fps or stored is not None else (no_rate(label, rate),)
    if interx or np.any(numbers(arrays.get("betas", np.zeros(1)), label)):
        notes = (*notes, SHAPE_UNUSED.format(label))
    positions, rotations = _posed(numbers(poses, label), numbers(trans, label))
    if not interx or _stands_along_z(positions):
        positions = positions @ _Z_UP_TO_Y_UP.T.astype(np.float32)
        rotations[:, 0] = _Z_UP_TO_Y_UP @ rotations[:, 0]
    return Clip(positions, rate, SMPL22, rotations, label, notes)


def on_floor(*people: Clip) -> list[Clip]:
    """People of one world, shifted together so that their lowest joint is at height 0."""
    lowest = min(float(person.positions[..., 1].min()) for person in people)
    shift = np.array([0.0, lowest, 0.0], dtype=np.float32)
    return [replace(person, positions=person.positions - shift) for person in people]


def _amass(arrays: Mapping[str, Array], label: str) -> tuple[Array, Array]:
    poses, trans = arrays["poses"], arrays["trans"]
    if poses.ndim != 2 or poses.shape[1] < _BODY or trans.shape != (len(poses), 3) or len(poses) == 0:
        raise InputError(f"{label}: AMASS poses must be (frames, 66 or more) and trans (frames, 3).")
    return poses[:, :_BODY], trans


def _joined(arrays: Mapping[str, Array], label: str) -> tuple[Array, Array]:
    root, body, trans = (arrays[key] for key in ("root_orient", "pose_body", "trans"))
    frames = len(trans) if trans.ndim else 0
    fits = body.shape in ((frames, 63), (frames, 21, 3)) and root.shape == trans.shape == (frames, 3)
    if not fits or not frames:
        raise InputError(
            f"{label}: Inter-X' pose_body must be (frames, 63) or (frames, 21, 3), root_orient and trans (frames, 3), "
            "with the same number of frames."
        )
    return np.concatenate([root, body.reshape(frames, 63)], axis=-1), trans


def _posed(poses: Array, trans: Array) -> tuple[Array, Array]:
    """(T, 22, 3) positions and (T, 22, 3, 3) rotations in the file's axes."""
    rotations = np.empty((len(poses), SMPL22.num_joints, 3, 3), dtype=np.float32)
    positions = np.empty((len(poses), SMPL22.num_joints, 3), dtype=np.float32)
    for first in range(0, len(poses), _AT_ONCE):
        part = slice(first, first + _AT_ONCE)
        vectors = scipy.spatial.transform.Rotation.from_rotvec(poses[part].reshape(-1, 3))
        turns = vectors.as_matrix().reshape(-1, SMPL22.num_joints, 3, 3)
        positions[part] = forward_kinematics(turns, trans[part] + PELVIS)
        rotations[part] = turns
    return positions, rotations


def _stands_along_z(positions: Array) -> bool:
    """True if head and ankles are farther apart along Z than along Y."""
    ankles = [SMPL22.index("left_ankle"), SMPL22.index("right_ankle")]
    tall = np.median(positions[:, SMPL22.index("head")] - positions[:, ankles].mean(axis=1), axis=0)
    return bool(abs(tall[2]) > abs(tall[1]))


def write_smpl(duet: Duet, path: str | Path) -> list[Path]:
    """Writes AMASS' parameters, ``NAME_a.smpl.npz`` and ``NAME_b.smpl.npz``, in one Z-up world.

    A child is written as an adult, on the way of an adult: the body of these files is one.

    Raises:
        InputError: for joints other than SMPL22's, or where a file cannot be written; no file is left.
    """
    path = Path(path)
    stem = path.name[: -len(SUFFIX)]
    a, b = (size_of(look) for look in duet.looks)
    if (a, b) != (1.0, 1.0) and duet.skeleton.joint_names == SMPL22.joint_names:
        duet = duet.with_positions(of_adults(duet.positions, (a, b)))
    files = {
        path.with_name(f"{stem}_{letter}{SUFFIX}"): smpl_bytes(clip)
        for letter, clip in zip("ab", duet.people, strict=True)
    }
    return write_files(files)


def smpl_bytes(clip: Clip) -> bytes:
    """One person as AMASS' .npz: ``poses`` (T, 156), ``trans`` (T, 3), ``betas`` (16,), ``gender``, the rate twice.

    Bones point where those of the clip point, and the body is SMPL's neutral one (betas of 0): its bones are about as
    long as SMPL22's, but not the same, and a person with other bones gets SMPL's.

    Raises:
        InputError: for joints other than SMPL22's.
    """
    if clip.skeleton.joint_names != SMPL22.joint_names:
        raise InputError(
            f"SMPL's parameters need its 22 joints, not those of {clip.skeleton.name}: retarget the motion."
        )
    rotations = (
        fit_rotations(clip.positions) if clip.rotations is None else np.array(clip.rotations, np.float64)
    )
    rotations[:, 0] = _Z_UP_TO_Y_UP.T @ rotations[:, 0]
    vectors = scipy.spatial.transform.Rotation.from_matrix(rotations.reshape(-1, 3, 3)).as_rotvec()
    poses = np.zeros((clip.num_frames, _POSES))
    poses[:, :_BODY] = vectors.reshape(clip.num_frames, _BODY)
    buffer = io.BytesIO()
    np.savez_compressed(
        buffer,
        poses=poses,
        trans=clip.positions[:, 0].astype(np.float64) @ _Z_UP_TO_Y_UP - PELVIS,
        betas=np.zeros(_BETAS),
        gender=np.array("neutral"),
        mocap_frame_rate=np.float64(clip.fps),
        mocap_framerate=np.float64(clip.fps),
    )
    return buffer.getvalue()
