"""NumPy files: our two-person .npz, single arrays, and the parameters of SMPL bodies.

Uploads are never unpickled, and nothing is unpacked before the sizes that a file declares have been checked.
"""

from __future__ import annotations

import io
import json
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from motion.clip import Clip, Duet
from motion.errors import InputError
from motion.representation import NUM_FEATURES, RAW_FEATURES, decode_positions, read_raw
from motion.skeleton import SKELETONS, SMPL22, Skeleton

from . import npz_things
from .arrays import frame_rate, load_array, load_members, no_rate, numbers
from .crowd import MAX_PEOPLE, Motion, gathered
from .files import check_duration, read_bytes, write_files
from .joint_order import likely_skeleton
from .smpl import FPS_KEYS, PARAMETER_KEYS, has_parameters, on_floor, read_parameters

Array = NDArray[Any]

_SMPL24 = 24
_LONGEST_MANIFEST = 1_000_000
"""Characters of JSON, which holds the interpreter while it is read: some 30 ms for so many."""
_JOINT_COUNTS = "15 (Kinect v1), 17 (CMU), 22 or 24 (SMPL) or 25 (Kinect v2) joints"
_INTERHUMAN = 492
"""InterHuman's processed frames: 62 joints' positions and 51 joints' rotations, the body's first in both."""
_BODY_POSITIONS, _BODY_ROTATIONS = slice(0, 66), slice(186, 312)
_COLUMNS = (NUM_FEATURES, 2 * NUM_FEATURES, RAW_FEATURES, _INTERHUMAN)
_KEYS = (
    "positions",
    "fps",
    "joint_names",
    "parents",
    "roles",
    "manifest",
    *npz_things.KEYS,
    npz_things.GRIPS,
    npz_things.LOOKS,
)


def write_npz(duet: Duet, path: str | Path) -> list[Path]:
    """Writes a duet's positions (2, T, J, 3) float32 with fps, joint_names, parents, roles and manifest.

    Things beside the people, the grips of their hands and their looks are further arrays, see :mod:`.npz_things`.
    """
    arrays: dict[str, Any] = {
        "positions": duet.positions,
        "fps": np.float64(duet.fps),
        "joint_names": np.array(duet.skeleton.joint_names),
        "parents": np.array(duet.skeleton.parents, dtype=np.int64),
        "roles": np.array(duet.roles),
        "manifest": np.array(json.dumps(duet.manifest or {}, ensure_ascii=False)),
        **npz_things.arrays_of(duet.things),
        **npz_things.grips_array(duet.grips),
        **npz_things.looks_array(duet.looks),
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
    source: str | Path | bytes, *, name: str | None = None, fps: float | None = None, everyone: bool = False,
    floor: bool = True,
) -> Motion:  # fmt: skip
    """Reads our .npz (one person or two), AMASS' or Inter-X' (one person a file).

    Args:
        source: a path, or the file's bytes.
        name: its name in messages.
        fps: frame rate where the file gives none; 30 by default, 120 for Inter-X, as its authors say.
        everyone: return all people instead of the first two.
        floor: put a person of SMPL's parameters on the floor; where two share a world, they are put on it together.

    Raises:
        InputError: one sentence saying what is wrong with the file.
    """
    data, label = read_bytes(source, name)
    arrays = load_members(data, label, (*_KEYS, *PARAMETER_KEYS, *FPS_KEYS))
    if "positions" in arrays:
        return _from_arrays(arrays, label, fps, everyone)
    if has_parameters(arrays):
        person = read_parameters(arrays, label, fps)
        return on_floor(person)[0] if floor else person
    raise InputError(
        f"{label} holds none of 'positions' (2, frames, 22, 3), AMASS' 'poses' and 'trans', and Inter-X' 'pose_body', "
        "'root_orient' and 'trans': save it so."
    )


def read_npy(
    source: str | Path | bytes, *, name: str | None = None, fps: float | None = None, everyone: bool = False,
    floor: bool = True,
) -> Motion:  # fmt: skip
    """Reads a single array: positions (2, T, J, 3) or (T, J, 3), InterGen's features, or InterHuman's frames.

    Features are (T, 262) or (T, 524). InterHuman's processed files, one person each, are (T, 492): 62 joints'
    positions, Z up, and 51 joints' rotations. Of these the 22 of the body are read, as they are of the (T, 192) that
    InterGen's loader cuts out of them.

    Args:
        source: a path, or the file's bytes.
        name: its name in messages.
        fps: frame rate; 30 by default, as the file has none.
        everyone: return all people instead of the first two.
        floor: put a person of InterHuman's on the floor; where two share a world, they are put on it together.

    Raises:
        InputError: one sentence saying what is wrong with the file.
    """
    data, label = read_bytes(source, name)
    array = load_array(io.BytesIO(data), len(data), label)
    rate = fps or 30.0
    notes = () if fps else (no_rate(label, rate),)
    if array.ndim == 2 and array.shape[-1] in _COLUMNS and len(array):
        check_duration(len(array), rate, label)
        if array.shape[-1] in (RAW_FEATURES, _INTERHUMAN):
            person = Clip(read_raw(numbers(_body_columns(array), label))[0], rate, name=label, notes=notes)
            return on_floor(person)[0] if floor else person
        return _motion(decode_positions(numbers(array, label)), rate, SMPL22, label, notes=notes)
    if array.ndim not in (3, 4):
        raise InputError(
            f"{label} has the shape {array.shape}: give positions (2, frames, 22, 3) or (frames, 22, 3), or a person "
            f"of InterHuman (frames, {_INTERHUMAN})."
        )
    array = numbers(_body(array), label)
    _check_people(array, rate, label)
    skeleton = likely_skeleton(array)
    if skeleton is None:
        raise InputError(f"{label} has {array.shape[-2]} joints a frame: give {_JOINT_COUNTS}.")
    return _motion(array, rate, skeleton, label, everyone=everyone, notes=notes)


def _body_columns(raw: Array) -> Array:
    """(T, 192) of InterHuman's (T, 492); (T, 192) as it is."""
    if raw.shape[-1] == RAW_FEATURES:
        return raw
    return np.concatenate([raw[:, _BODY_POSITIONS], raw[:, _BODY_ROTATIONS]], axis=-1)


def _body(positions: Array) -> Array:
    """Drops the hands, the last two of SMPL's 24 joints; leaves any other count unchanged."""
    is_smpl = positions.ndim in (3, 4) and positions.shape[-2] == _SMPL24
    return positions[..., : SMPL22.num_joints, :] if is_smpl else positions


def _from_arrays(arrays: dict[str, Array], label: str, fps: float | None, everyone: bool) -> Motion:
    rate = frame_rate(arrays.get("fps"), fps, label)
    notes = () if fps or "fps" in arrays else (no_rate(label, rate),)
    _check_people(arrays["positions"], rate, label)
    positions = numbers(arrays["positions"], label)
    if "joint_names" not in arrays:
        positions = _body(positions)
    skeleton = _skeleton(arrays, positions, label)
    roles = tuple(str(role)[:40] for role in np.atleast_1d(arrays.get("roles", ("a", "b")))[:2])
    manifest = None
    if "manifest" in arrays:
        if arrays["manifest"].nbytes > 4 * _LONGEST_MANIFEST:
            raise InputError(
                f"{label}: its manifest has over {_LONGEST_MANIFEST:,} characters: save it again."
            )
        try:
            manifest = json.loads(str(arrays["manifest"]))
        except (ValueError, RecursionError):
            raise InputError(f"{label}: its manifest is not JSON text: save it again.") from None
    made = _motion(positions, rate, skeleton, label, everyone=everyone, notes=notes)
    if not isinstance(made, Duet):
        return made
    known = manifest if isinstance(manifest, dict) and manifest else None
    named = (roles[0], roles[1]) if len(roles) == 2 else ("a", "b")
    things = npz_things.things_of(arrays, made.num_frames, label)
    grips, looks = npz_things.grips_in(arrays, label), npz_things.looks_in(arrays, label)
    return Duet(made.a, made.b, named, known, things, grips, looks)


def _motion(
    positions: Array, fps: float, skeleton: Skeleton, label: str, *, everyone: bool = False,
    notes: tuple[str, ...] = (),
) -> Motion:  # fmt: skip
    """(T, J, 3) or (people, T, J, 3) as clips."""
    people = positions[None] if positions.ndim < 4 else positions
    check_duration(people.shape[1] if people.ndim > 3 else 0, fps, label)
    try:
        clips = tuple(Clip(person, fps, skeleton, name=label, notes=notes) for person in people)
    except InputError as error:
        raise InputError(f"{label}: {error}") from None
    return gathered(clips, label, everyone=everyone)


def _check_people(positions: Array, fps: float, label: str) -> None:
    """Checks length and number of people by the shape, before the values are used."""
    if positions.ndim == 4 and not 1 <= len(positions) <= MAX_PEOPLE:
        raise InputError(f"{label} holds {len(positions)} people: give 1 to {MAX_PEOPLE} a file.")
    check_duration(positions.shape[-3] if positions.ndim > 2 else 0, fps, label)


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
