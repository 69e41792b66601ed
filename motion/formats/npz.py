"""NumPy files: our two-person .npz, single arrays, and AMASS' parameters.

Uploads are never unpickled, and nothing is unpacked before the sizes that a file declares have been checked.
"""

from __future__ import annotations

import io
import json
import lzma
import struct
import zipfile
import zlib
from pathlib import Path
from typing import IO, Any

import numpy as np
import scipy  # its parts are loaded with their first use
from numpy.typing import NDArray

from motion.clip import Clip, Duet
from motion.errors import InputError
from motion.kinematics import forward_kinematics
from motion.representation import NUM_FEATURES, RAW_FEATURES, decode_positions, read_raw
from motion.skeleton import SKELETONS, SMPL22, Skeleton

from . import npz_things
from .crowd import MAX_PEOPLE, Motion, gathered
from .files import check_duration, read_bytes, write_files
from .joint_order import likely_skeleton

Array = NDArray[Any]

MAX_UNPACKED = 128 * 2**20
_MOST_MEMBERS = 200
_SMPL24 = 24
_JOINT_COUNTS = "15 (Kinect v1), 17 (CMU), 22 or 24 (SMPL) or 25 (Kinect v2) joints"
_MAX_HEADER = 4096
_AT_ONCE = 4096
"""Frames of which rotations are made at a time."""
ZIP_ERRORS = (
    zipfile.BadZipFile, zlib.error, struct.error, lzma.LZMAError, EOFError, NotImplementedError, RuntimeError,
    OSError, ValueError, OverflowError, IndexError, KeyError,
)  # fmt: skip
"""Errors that :mod:`zipfile` raises over damaged files, from wrong sums to sizes below zero."""
_KEYS = (
    "positions", "fps", "joint_names", "parents", "roles", "manifest",
    "poses", "trans", "mocap_framerate", "mocap_frame_rate", *npz_things.KEYS,
)  # fmt: skip


def write_npz(duet: Duet, path: str | Path) -> list[Path]:
    """Writes a duet's positions (2, T, J, 3) float32 with fps, joint_names, parents, roles and manifest.

    Things beside the people are further arrays, see :mod:`.npz_things`.
    """
    arrays: dict[str, Any] = {
        "positions": duet.positions,
        "fps": np.float64(duet.fps),
        "joint_names": np.array(duet.skeleton.joint_names),
        "parents": np.array(duet.skeleton.parents, dtype=np.int64),
        "roles": np.array(duet.roles),
        "manifest": np.array(json.dumps(duet.manifest or {}, ensure_ascii=False)),
        **npz_things.arrays_of(duet.things),
    }
    buffer = io.BytesIO()
    np.savez_compressed(buffer, **arrays)
    return write_files({Path(path): buffer.getvalue()})


def write_npy(duet: Duet, path: str | Path) -> list[Path]:
    """Writes only a duet's positions (2, T, J, 3) float32; the frame rate is lost."""
    buffer = io.BytesIO()
    np.save(buffer, duet.positions, allow_pickle=False)
    return write_files({Path(path): buffer.getvalue()})


def read_npz(
    source: str | Path | bytes, *, name: str | None = None, fps: float | None = None, everyone: bool = False
) -> Motion:
    """Reads our .npz (one person or two) or AMASS' (one person).

    Args:
        source: a path, or the file's bytes.
        name: its name in messages.
        fps: frame rate where the file gives none; 30 by default.
        everyone: return all people instead of the first two.

    Raises:
        InputError: one sentence saying what is wrong with the file.
    """
    data, label = read_bytes(source, name)
    arrays = _load_members(data, label)
    if "positions" in arrays:
        return _from_arrays(arrays, label, fps, everyone)
    if "poses" in arrays and "trans" in arrays:
        return _from_amass(arrays, label, fps)
    raise InputError(
        f"{label} holds neither 'positions' (2, frames, 22, 3) nor AMASS' 'poses' and 'trans': save it so."
    )


def read_npy(
    source: str | Path | bytes, *, name: str | None = None, fps: float | None = None, everyone: bool = False
) -> Motion:
    """Reads a single array: positions (2, T, J, 3) or (T, J, 3), features (T, 262) or (T, 524), raw (T, 192).

    Args:
        source: a path, or the file's bytes.
        name: its name in messages.
        fps: frame rate; 30 by default, as the file has none.
        everyone: return all people instead of the first two.

    Raises:
        InputError: one sentence saying what is wrong with the file.
    """
    data, label = read_bytes(source, name)
    array = _load_array(io.BytesIO(data), len(data), label)
    rate = fps or 30.0
    if array.ndim == 2 and array.shape[-1] in (NUM_FEATURES, 2 * NUM_FEATURES, RAW_FEATURES) and len(array):
        array = _numbers(array, label)
        check_duration(len(array), rate, label)
        positions = read_raw(array)[0] if array.shape[-1] == RAW_FEATURES else decode_positions(array)
        return _motion(positions, rate, SMPL22, label)
    if array.ndim not in (3, 4):
        raise InputError(
            f"{label} has the shape {array.shape}: give positions (2, frames, 22, 3) or (frames, 22, 3)."
        )
    array = _numbers(_body(array), label)
    _check_people(array, rate, label)
    skeleton = likely_skeleton(array)
    if skeleton is None:
        raise InputError(f"{label} has {array.shape[-2]} joints a frame: give {_JOINT_COUNTS}.")
    return _motion(array, rate, skeleton, label, everyone=everyone)


def _body(positions: Array) -> Array:
    """Drops the hands, the last two of SMPL's 24 joints; leaves any other count unchanged."""
    is_smpl = positions.ndim in (3, 4) and positions.shape[-2] == _SMPL24
    return positions[..., : SMPL22.num_joints, :] if is_smpl else positions


def _load_members(data: bytes, label: str) -> dict[str, Array]:
    arrays = {}
    if data.count(b"PK\x01\x02") > _MOST_MEMBERS:
        raise InputError(f"{label} holds more than {_MOST_MEMBERS} parts: save its arrays alone.")
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            members = {m.filename.removesuffix(".npy"): m for m in archive.infolist()}
            wanted = [members[key] for key in _KEYS if key in members]
            if any(m.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED) for m in wanted):
                raise InputError(f"{label} is not packed the way NumPy does it: save it with numpy.savez.")
            total = sum(member.file_size for member in wanted)
            if total > MAX_UNPACKED:
                raise InputError(
                    f"{label} would unpack to {total / 2**20:.0f} MB, more than is allowed: cut it."
                )
            for member in wanted:
                key = member.filename.removesuffix(".npy")
                with archive.open(member) as stream:  # gives no more than the declared size
                    arrays[key] = _load_array(stream, member.file_size, f"{label}, {key}")
    except InputError:
        raise
    except ZIP_ERRORS as error:
        raise InputError(f"{label} is not a whole .npz file, or it is damaged: save it again.") from error
    return arrays


def _load_array(stream: IO[bytes], size: int, label: str) -> Array:
    """One .npy, whose header is checked against the bytes that are there before anything is made."""
    try:
        version = np.lib.format.read_magic(stream)
        reader = {(1, 0): np.lib.format.read_array_header_1_0, (2, 0): np.lib.format.read_array_header_2_0}
        shape, _, dtype = reader[version](stream, max_header_size=_MAX_HEADER)
    except Exception:  # the header is parsed as Python literals, which can fail in any way
        raise InputError(
            f"{label} is not a NumPy array file: save it with numpy.save or numpy.savez."
        ) from None
    if dtype.hasobject:
        raise InputError(f"{label} holds Python objects, which are not read: save plain numbers.")
    count = 1
    for length in shape:
        count *= int(length)
    if count * dtype.itemsize != size - stream.tell():
        raise InputError(f"{label} is damaged: its header says {shape}, its data has another size.")
    stream.seek(0)
    return np.lib.format.read_array(stream, allow_pickle=False, max_header_size=_MAX_HEADER)


def _from_arrays(arrays: dict[str, Array], label: str, fps: float | None, everyone: bool) -> Motion:
    rate = _rate(arrays.get("fps"), fps, label)
    _check_people(arrays["positions"], rate, label)
    positions = _numbers(arrays["positions"], label)
    if "joint_names" not in arrays:
        positions = _body(positions)
    skeleton = _skeleton(arrays, positions, label)
    roles = tuple(str(role)[:40] for role in np.atleast_1d(arrays.get("roles", ("a", "b")))[:2])
    manifest = None
    if "manifest" in arrays:
        try:
            manifest = json.loads(str(arrays["manifest"]))
        except (ValueError, RecursionError):
            raise InputError(f"{label}: its manifest is not JSON text: save it again.") from None
    made = _motion(positions, rate, skeleton, label, everyone=everyone)
    if not isinstance(made, Duet):
        return made
    known = manifest if isinstance(manifest, dict) and manifest else None
    named = (roles[0], roles[1]) if len(roles) == 2 else ("a", "b")
    return Duet(made.a, made.b, named, known, npz_things.things_of(arrays, made.num_frames, label))


def _from_amass(arrays: dict[str, Array], label: str, fps: float | None) -> Clip:
    """AMASS: axis-angle ``poses`` (T, 3·J), ``trans`` (T, 3), Z up; body joints only, on SMPL22's bones."""
    poses, trans = arrays["poses"], arrays["trans"]
    if poses.ndim != 2 or poses.shape[1] < 66 or trans.shape != (len(poses), 3) or len(poses) == 0:
        raise InputError(f"{label}: AMASS poses must be (frames, 66 or more) and trans (frames, 3).")
    rate = _rate(arrays.get("mocap_framerate", arrays.get("mocap_frame_rate")), fps, label)
    check_duration(len(poses), rate, label)
    poses, trans = _numbers(poses[:, :66], label), _numbers(trans, label)
    z_up_to_y_up = np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]])
    rotations = np.empty((len(poses), 22, 3, 3), dtype=np.float32)
    positions = np.empty((len(poses), 22, 3), dtype=np.float32)
    for first in range(0, len(poses), _AT_ONCE):
        part = slice(first, first + _AT_ONCE)
        turns = (
            scipy.spatial.transform.Rotation.from_rotvec(poses[part].reshape(-1, 3))
            .as_matrix()
            .reshape(-1, 22, 3, 3)
        )
        turns[:, 0] = z_up_to_y_up @ turns[:, 0]
        positions[part] = forward_kinematics(turns, trans[part] @ z_up_to_y_up.T)
        rotations[part] = turns
    positions[..., 1] -= positions[..., 1].min()
    return Clip(positions, rate, SMPL22, rotations, label)


def _motion(
    positions: Array, fps: float, skeleton: Skeleton, label: str, *, everyone: bool = False
) -> Motion:
    """(T, J, 3) or (people, T, J, 3) as clips."""
    people = positions[None] if positions.ndim < 4 else positions
    check_duration(people.shape[1] if people.ndim > 3 else 0, fps, label)
    try:
        clips = tuple(Clip(person, fps, skeleton, name=label) for person in people)
    except InputError as error:
        raise InputError(f"{label}: {error}") from None
    return gathered(clips, label, everyone=everyone)


def _check_people(positions: Array, fps: float, label: str) -> None:
    """Checks length and number of people by the shape, before the values are used."""
    if positions.ndim == 4 and not 1 <= len(positions) <= MAX_PEOPLE:
        raise InputError(f"{label} holds {len(positions)} people: give 1 to {MAX_PEOPLE} a file.")
    check_duration(positions.shape[-3] if positions.ndim > 2 else 0, fps, label)


def _numbers(array: Array, label: str) -> Array:
    if array.dtype.kind not in "fiu":
        raise InputError(f"{label} holds {array.dtype} where numbers are needed: save float32 metres.")
    with np.errstate(all="ignore"):
        numbers = array.astype(np.float32, copy=False)
    low, high = (float(numbers.min()), float(numbers.max())) if numbers.size else (0.0, 0.0)
    if not (np.isfinite(low) and np.isfinite(high)):
        raise InputError(f"{label} holds NaN or infinite numbers: remove or repair those frames.")
    if max(-low, high) > 1e4:
        raise InputError(f"{label} holds places more than 10 km away: save metres.")
    return numbers


def _rate(stored: Array | None, given: float | None, label: str) -> float:
    if stored is None:
        return given or 30.0
    try:
        rate = float(np.asarray(stored).reshape(()))
    except (TypeError, ValueError):
        raise InputError(f"{label}: its frame rate is not one number: save fps as a number.") from None
    if not 1.0 <= rate <= 1000.0:
        raise InputError(f"{label}: a frame rate of {rate:g} is not possible: save frames a second.")
    return rate


def _skeleton(arrays: dict[str, Array], positions: Array, label: str) -> Skeleton:
    if "joint_names" in arrays and arrays["joint_names"].ndim == 1:
        names = tuple(str(name) for name in arrays["joint_names"])
        for skeleton in SKELETONS.values():
            if names == skeleton.joint_names:
                return skeleton
        raise InputError(
            f"{label} has joints that are not known ({', '.join(names[:4])}, …): use the joints of "
            f"{' or '.join(SKELETONS)}, or save it as BVH, where any rig is understood."
        )
    joints = positions.shape[-2] if positions.ndim > 1 else 0
    found = likely_skeleton(positions)
    if found is None:
        raise InputError(f"{label} has {joints} joints a frame and no joint_names: give {_JOINT_COUNTS}.")
    return found
