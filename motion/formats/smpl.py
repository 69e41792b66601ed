"""Parameters of SMPL bodies: the .npz of AMASS, Inter-X and of estimators of bodies in, AMASS' out.

A person is a rotation of each joint against its parent, the root's against the world, and a path. SMPL's body model,
which would make joints of them, may not be shipped: the bones are those of :data:`~motion.SMPL22`, an average adult's.
A file that gives its person's shape as ``betas`` is read without it.
"""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from motion.clip import Clip, Duet
from motion.errors import InputError
from motion.kinematics import forward_kinematics
from motion.looks import size_of
from motion.representation import Z_UP_TO_Y_UP
from motion.sizes import of_adults
from motion.skeleton import SMPL22
from motion.vectors import rotation_vectors, rotations_by

from .files import check_duration, check_smpl, frame_rate, no_rate, numbers
from .recording import Recording
from .skinned import rigged

Array = NDArray[Any]

SUFFIX = ".smpl.npz"
FPS_KEYS = ("mocap_framerate", "mocap_frame_rate", "frame_rate", "fps")
_WHOLE, _ROOT, _BODY_KEYS = (
    ("poses", "smpl_poses", "pose"),
    ("root_orient", "global_orient"),
    ("pose_body", "body_pose"),
)
_TRANS = ("trans", "transl", "smpl_trans", "translation")
PARAMETER_KEYS = (*_WHOLE, *_ROOT, *_BODY_KEYS, *_TRANS, "betas", *FPS_KEYS)
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


def has_parameters(arrays: Mapping[str, Array]) -> bool:
    """True if these are the rotations of a person's joints."""
    return any(key in arrays for key in _WHOLE) or (
        any(key in arrays for key in _ROOT) and any(key in arrays for key in _BODY_KEYS)
    )


def read_parameters(arrays: Mapping[str, Array], label: str, fps: float | None) -> Recording:
    """The person of a file, where the file puts them.

    Args:
        arrays: the path, (T, 3) under ``trans`` or ``transl``, with rotations of all joints as ``poses``, or of the
            root as ``root_orient`` or ``global_orient`` and of the others as ``pose_body`` or ``body_pose``: vectors
            (T, 3 J), (T, J, 3) or matrices (T, J, 3, 3), of SMPL's 24 joints or more of its kin; the rate under one
            of :data:`FPS_KEYS`.
        label: the file's name in messages.
        fps: the true frame rate; otherwise the file's, or 30, or 120 for Inter-X.

    Returns:
        a clip. AMASS is Z up, other files usually Y up.

    Raises:
        InputError: one sentence saying what is wrong with the arrays.
    """
    interx = "pose_body" in arrays and "poses" not in arrays
    whole, trans = _first(arrays, _WHOLE), _first(arrays, _TRANS)
    if whole is None:
        root, body = (_vectors(_first(arrays, keys), label) for keys in (_ROOT, _BODY_KEYS))
        fits = len(root) == len(body) and root.shape[1] == 3 and body.shape[1] >= _BODY - 3
        poses = np.concatenate([root, body[:, : _BODY - 3]], axis=1) if fits else root[:, :0]
    else:
        poses = _vectors(whole, label)[:, :_BODY]
    path = np.zeros((len(poses), 3)) if trans is None else numbers(trans, label)
    path = path[:, 0] if path.ndim == 3 else path
    if poses.shape[-1] < _BODY or path.shape != (len(poses), 3) or len(poses) == 0:
        raise InputError(
            f"{label}: SMPL's rotations must be 'poses' (frames, 66 or more), or 'global_orient' (frames, 3) and "
            "'body_pose' (frames, 63 or more), and 'trans' (frames, 3), with the same number of frames."
        )
    stored = _first(arrays, FPS_KEYS)
    rate = frame_rate(stored, fps, label, usual=INTERX_FPS if interx else 30.0)
    check_duration(len(poses), rate, label)
    notes = [] if fps or stored is not None else [no_rate(label, rate)]
    if trans is None:
        notes.append(f"{label} does not give the person's path: they stay in one place.")
    if interx or np.any(numbers(arrays.get("betas", np.zeros(1)), label)):
        notes.append(SHAPE_UNUSED.format(label))
    amass = "poses" in arrays and "trans" in arrays
    clip = Clip(_posed(poses, path), rate, name=label, notes=tuple(notes))
    return Recording((clip,), "z" if amass else "", on_floor=True)


def _first(arrays: Mapping[str, Array], keys: Sequence[str]) -> Array | None:
    return next((arrays[key] for key in keys if key in arrays), None)


def _vectors(rotations: Array | None, label: str) -> Array:
    """(T, 3 J) rotation vectors of (T, 3 J), (T, J, 3) or (T, J, 3, 3); of matrices those of the body's joints."""
    assert rotations is not None
    turns = numbers(rotations, label)
    if turns.ndim < 2 or not turns.size:
        return np.zeros((0, 0))
    if turns.ndim > 2 and turns.shape[-2:] == (3, 3):
        matrices = turns.reshape(len(turns), -1, 3, 3)[:, : SMPL22.num_joints]
        vectors = np.empty(matrices.shape[:3], dtype=np.float32)
        try:
            for first in range(0, len(matrices), _AT_ONCE):
                part = slice(first, first + _AT_ONCE)
                vectors[part] = rotation_vectors(matrices[part])
        except ValueError:
            raise InputError(f"{label} holds matrices that are not rotations: save it again.") from None
        turns = vectors
    return turns.reshape(len(turns), -1)


def _posed(poses: Array, trans: Array) -> Array:
    """(T, 22, 3) positions in the file's axes."""
    positions = np.empty((len(poses), SMPL22.num_joints, 3), dtype=np.float32)
    for first in range(0, len(poses), _AT_ONCE):
        part = slice(first, first + _AT_ONCE)
        turns = rotations_by(poses[part].reshape(-1, SMPL22.num_joints, 3))
        positions[part] = forward_kinematics(turns, trans[part] + PELVIS)
    return positions


def as_adults(duet: Duet) -> tuple[Clip, Clip]:
    """Two people of whom a child is an adult, on the way of an adult: the body of these files is one."""
    a, b = (size_of(look) for look in duet.looks)
    if (a, b) != (1.0, 1.0) and duet.skeleton.joint_names == SMPL22.joint_names:
        duet = duet.with_positions(of_adults(duet.positions, (a, b)))
    return duet.people


def smpl_bytes(clip: Clip) -> bytes:
    """One person as AMASS' .npz: ``poses`` (T, 156), ``trans`` (T, 3), ``betas`` (16,), ``gender``, the rate twice.

    The world is Z up. Bones point where those of the clip point, and the body is SMPL's neutral one (betas of 0): its
    bones are about as long as SMPL22's, but not the same, and a person with other bones gets SMPL's.

    Raises:
        InputError: for joints other than SMPL22's.
    """
    check_smpl(clip, SUFFIX)
    rotations, _ = rigged(clip)
    rotations[:, 0] = Z_UP_TO_Y_UP.T @ rotations[:, 0]
    poses = np.zeros((clip.num_frames, _POSES))
    poses[:, :_BODY] = rotation_vectors(rotations).reshape(clip.num_frames, _BODY)
    buffer = io.BytesIO()
    np.savez_compressed(
        buffer,
        poses=poses,
        trans=clip.positions[:, 0].astype(np.float64) @ Z_UP_TO_Y_UP - PELVIS,
        betas=np.zeros(_BETAS),
        gender=np.array("neutral"),
        mocap_frame_rate=np.float64(clip.fps),
        mocap_framerate=np.float64(clip.fps),
    )
    return buffer.getvalue()
