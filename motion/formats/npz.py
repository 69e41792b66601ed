"""NumPy files: our two-person .npz, single arrays, and the parameters of SMPL bodies.

Uploads are never unpickled, and nothing is unpacked before the sizes that a file declares have been checked.

``docs/files.md`` lists the arrays that a two-person .npz may hold beside positions: things, grips (JSON text, see
:mod:`motion.hands`) and looks (:mod:`motion.looks`).
"""

from __future__ import annotations

import io
import json
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from motion.clip import Clip, Duet
from motion.errors import InputError
from motion.guesses import likely_skeleton
from motion.hands import grips_of, to_lists
from motion.looks import UNSAID, checked
from motion.representation import NUM_FEATURES, decode_humanml3d, decode_positions, upright
from motion.rigs import RigMotion
from motion.skeleton import SKELETONS, SMPL22, Skeleton
from motion.things.thing import MOST_THINGS, Mesh, Thing

from .files import check_duration, frame_rate, load_array, load_members, no_rate, numbers, read_json
from .recording import MAX_PEOPLE, ORDERS, ImportChoices, Recording
from .smpl import FPS_KEYS, PARAMETER_KEYS, has_parameters, read_parameters

Array = NDArray[Any]

_SMPL24 = 24
_JOINT_COUNTS = "15 (Kinect v1), 17 (CMU, Human3.6M, COCO), 22 or 24 (SMPL), 25 (Kinect v2), 30 or 77 joints (SOMA)"
_INTERHUMAN = 492
"""InterHuman's processed frames: 62 joints' positions and 51 joints' rotations, the body's first in both."""
_HUMANML3D, _HUMANML3D_FPS = 263, 20.0
_SOMA_JOINTS = (
    "Hips LeftLeg RightLeg Spine1 LeftShin RightShin Spine2 LeftFoot RightFoot Chest LeftToeBase RightToeBase Neck1 "
    "LeftShoulder RightShoulder Head LeftArm RightArm LeftForeArm RightForeArm LeftHand RightHand"
)
"""The joints of SOMA's skeleton that SMPL22 has too, in its order, so that its parents are theirs."""
_SOMA = {
    30: [0, 22, 26, 1, 23, 27, 2, 24, 28, 3, 25, 29, 4, 10, 16, 6, 11, 17, 12, 18, 13, 19],
    77: [0, 67, 72, 1, 68, 73, 2, 69, 74, 3, 70, 75, 4, 11, 39, 6, 12, 40, 13, 41, 14, 42],
}
"""Where they are among the 30 or 77 of Kimodo's ``posed_joints``."""
_COUNTS = {_SMPL24, *_SOMA, *(skeleton.num_joints for skeleton in SKELETONS.values())}
_POSITIONS = ("positions", "posed_joints")
_SHAPES = {
    "thing_places": ("f", 3),
    "thing_rotations": ("f", 4),
    "thing_sizes": ("iu", 2),
    "thing_vertices": ("f", 2),
    "thing_faces": ("iu", 2),
    "thing_colours": ("u", 2),
}
"""Kind of number and number of axes of each array of numbers."""
THING_KEYS = ("thing_kinds", "thing_names", *_SHAPES)
_KEYS = (*_POSITIONS, "fps", "joint_names", "parents", "roles", "manifest", *THING_KEYS, "grips", "looks")


def npz_bytes(motion: Duet | Clip) -> bytes:
    """A .npz of positions (2, T, J, 3) or (T, J, 3) float32 with fps, joint_names and parents.

    A duet's roles and manifest, things beside the people, the grips of their hands and their looks are further arrays,
    see above.
    """
    arrays: dict[str, Any] = {
        "positions": motion.positions,
        "fps": np.float64(motion.fps),
        "joint_names": np.array(motion.skeleton.joint_names),
        "parents": np.array(motion.skeleton.parents, dtype=np.int64),
    }
    if isinstance(motion, Duet):
        arrays |= {
            "roles": np.array(motion.roles),
            "manifest": np.array(json.dumps(motion.manifest or {}, ensure_ascii=False)),
            **arrays_of(motion.things),
        }
        if motion.grips:
            arrays["grips"] = np.array(json.dumps(to_lists(motion.grips)))
        if motion.looks != UNSAID:
            arrays["looks"] = np.array(motion.looks)
    buffer = io.BytesIO()
    np.savez_compressed(buffer, **arrays)
    return buffer.getvalue()


def npy_bytes(motion: Duet | Clip) -> bytes:
    """A .npy of positions (2, T, J, 3) or (T, J, 3) float32 alone; the frame rate is lost."""
    buffer = io.BytesIO()
    np.save(buffer, motion.positions, allow_pickle=False)
    return buffer.getvalue()


def read_npz(data: bytes, label: str, choices: ImportChoices) -> Recording:
    """Our .npz (one person or two), positions with names of any rig, Kimodo's, and parameters of SMPL's bodies.

    Raises:
        InputError: one sentence saying what is wrong with the file.
    """
    arrays = load_members(data, label, (*_KEYS, *PARAMETER_KEYS, *FPS_KEYS))
    key = next((key for key in _POSITIONS if key in arrays), None)
    if key is None and has_parameters(arrays):
        return read_parameters(arrays, label, choices.fps)
    if key is None:
        raise InputError(
            f"{label} holds none of 'positions' (2, frames, 22, 3), Kimodo's 'posed_joints', AMASS' 'poses' and "
            "'trans', and 'global_orient', 'body_pose' and 'transl': save it so."
        )
    rate = frame_rate(arrays.get("fps"), choices.fps, label)
    notes = () if choices.fps or "fps" in arrays else (no_rate(label, rate),)
    recording = _recording(arrays[key], rate, label, choices, notes, arrays)
    return replace(recording, beside=_beside(arrays, recording, label)) if key == "positions" else recording


def read_npy(data: bytes, label: str, choices: ImportChoices) -> Recording:
    """A single array: positions of one person or more, features of InterGen or HumanML3D, or InterHuman's frames.

    InterGen's features are (T, 262) or (T, 524), HumanML3D's (T, 263). InterHuman's processed files, one person each,
    are (T, 492): 62 joints' positions, Z up, and 51 joints' rotations. Of these the 22 of the body are read.

    Raises:
        InputError: one sentence saying what is wrong with the file.
    """
    array = load_array(io.BytesIO(data), len(data), label)
    columns = array.shape[-1] if array.ndim == 2 and len(array) else 0
    rate = choices.fps or (_HUMANML3D_FPS if columns == _HUMANML3D else 30.0)
    notes = () if choices.fps else (no_rate(label, rate),)
    if columns not in (NUM_FEATURES, 2 * NUM_FEATURES, _INTERHUMAN, _HUMANML3D):
        return _recording(array, rate, label, choices, notes)
    check_duration(len(array), rate, label)
    array = numbers(array, label)
    decode = {_INTERHUMAN: upright, _HUMANML3D: decode_humanml3d}.get(columns, decode_positions)
    positions = numbers(decode(array), label)
    people = positions if positions.ndim > 3 else positions[None]
    clips = tuple(Clip(person, rate, name=label, notes=notes) for person in people)
    return Recording(clips, on_floor=columns == _INTERHUMAN)


def _recording(
    array: Array,
    rate: float,
    label: str,
    choices: ImportChoices,
    notes: tuple[str, ...],
    named: Mapping[str, Array] | None = None,
) -> Recording:
    """Positions (T, J, 3) or (people, T, J, 3), on known joints or a rig's; MDM's (J, 3, T) are turned round."""
    if array.ndim in (3, 4) and array.shape[-1] != 3 == array.shape[-2] and array.shape[-3] in _COUNTS:
        array = np.moveaxis(array, -1, -3)
    if array.ndim not in (3, 4) or array.shape[-1] != 3:
        raise InputError(
            f"{label} has the shape {array.shape}: give positions (2, frames, 22, 3) or (frames, 22, 3), a person of "
            f"InterHuman (frames, {_INTERHUMAN}) or HumanML3D (frames, {_HUMANML3D})."
        )
    people = array if array.ndim > 3 else array[None]
    if not 1 <= len(people) <= MAX_PEOPLE:
        raise InputError(f"{label} holds {len(people)} people: give 1 to {MAX_PEOPLE} in a file.")
    check_duration(people.shape[1], rate, label)
    people = numbers(people, label)
    names = _names(named or {}, people.shape[-2])
    if names is None and people.shape[-2] in _SOMA:
        people, names = people[:, :, _SOMA[people.shape[-2]]], (tuple(_SOMA_JOINTS.split()), SMPL22.parents)
    if names is not None:
        still = np.zeros((len(names[0]), 3))
        return Recording(tuple(RigMotion(*names, still, person, rate, name=label, notes=notes) for person in people))
    skeleton, more = _skeleton(named or {}, people, label, choices.order)
    people = people[:, :, : skeleton.num_joints]  # the hands of SMPL's 24 come last
    return Recording(tuple(Clip(its, rate, skeleton, name=label, notes=(*notes, *more)) for its in people))


def _names(arrays: Mapping[str, Array], joints: int) -> tuple[tuple[str, ...], tuple[int, ...]] | None:
    """Names and parents of a rig's joints that a file gives; None for known joints or a file without parents."""
    if "joint_names" not in arrays or "parents" not in arrays:
        return None
    names = tuple(str(name)[:80] for name in np.atleast_1d(arrays["joint_names"]).reshape(-1))
    parents = arrays["parents"]
    known = any(names == skeleton.joint_names for skeleton in SKELETONS.values())
    if known or len(names) != joints or parents.shape != (joints,) or parents.dtype.kind not in "iu":
        return None
    above = tuple(int(parent) for parent in parents)
    return (names, above) if all(-1 <= parent < joint for joint, parent in enumerate(above)) else None


def _skeleton(
    arrays: Mapping[str, Array], people: Array, label: str, order: str | None
) -> tuple[Skeleton, tuple[str, ...]]:
    """The known joints that positions are of, by their names or number and places, and a note where it is unsure."""
    if "joint_names" in arrays and arrays["joint_names"].ndim == 1:
        names = tuple(str(name) for name in arrays["joint_names"])
        for skeleton in SKELETONS.values():
            if names == skeleton.joint_names:
                return skeleton, ()
        raise InputError(
            f"{label} has joints that are not known ({', '.join(names[:4])}, …): save their 'parents' as well, or use "
            f"the joints of {' or '.join(SKELETONS)}."
        )
    count = people.shape[-2]
    if order is not None:
        if count != SKELETONS[order].num_joints:
            raise InputError(
                f"{label} has {count} joints a frame, but the order of {ORDERS.get(order, order)} has "
                f"{SKELETONS[order].num_joints}: leave the order to be detected."
            )
        return SKELETONS[order], ()
    body = people[..., : SMPL22.num_joints, :] if count == _SMPL24 else people
    likely, other = likely_skeleton(body)
    if likely is None:
        raise InputError(f"{label} has {count} joints a frame: give {_JOINT_COUNTS}.")
    if other is None:
        return likely, ()
    return likely, (
        f"{label} has {count} joints without names: the order of {ORDERS[likely.name]} was taken, but it may be "
        f"that of {ORDERS[other.name]}. Choose the order if it is wrong.",
    )


def _beside(arrays: dict[str, Array], recording: Recording, label: str) -> dict[str, Any]:
    """Parts of our own file beside two people's positions."""
    if len(recording.people) != 2:
        return {}
    roles = tuple(str(role)[:40] for role in np.atleast_1d(arrays.get("roles", ("a", "b")))[:2])
    try:
        manifest, grips = (read_json(str(arrays[key])) if key in arrays else None for key in ("manifest", "grips"))
        return {
            "roles": (roles[0], roles[1]) if len(roles) == 2 else ("a", "b"),
            "manifest": manifest if isinstance(manifest, dict) and manifest else None,
            "things": _things_of(arrays, recording.people[0].num_frames),
            "grips": grips_of(grips) if "grips" in arrays else (),
            "looks": checked([str(look) for look in np.atleast_1d(arrays.get("looks", UNSAID))[:3]]),
        }
    except InputError:
        raise
    except ValueError as error:
        raise InputError(f"{label}: a text in it {error}: save it again.") from None


# ---- Things ----------------------------------------------------------------------------------------------------------


def arrays_of(things: Sequence[Thing]) -> dict[str, Array]:
    """The arrays of some things; none for no things."""
    if not things:
        return {}
    meshes = [thing.mesh for thing in things]
    return {
        "thing_kinds": np.array([thing.kind for thing in things]),
        "thing_names": np.array([thing.name for thing in things]),
        "thing_places": np.stack([thing.places for thing in things]),
        "thing_rotations": np.stack([thing.rotations for thing in things]),
        "thing_sizes": np.array([[len(mesh.vertices), len(mesh.faces)] for mesh in meshes], dtype=np.int64),
        "thing_vertices": np.concatenate([mesh.vertices for mesh in meshes]),
        "thing_faces": np.concatenate([mesh.faces for mesh in meshes]).astype(np.int32),
        "thing_colours": np.concatenate([mesh.colours for mesh in meshes]),
    }


def _things_of(arrays: Mapping[str, Array], frames: int) -> tuple[Thing, ...]:
    """The things of a file whose arrays have been read, with so many frames; () where it holds none.

    Raises:
        InputError: one sentence on what is wrong with them.
    """
    if not any(key in arrays for key in THING_KEYS):
        return ()
    if missing := [key for key in THING_KEYS if key not in arrays]:
        raise InputError(f"it holds things without {missing[0]}: save it again.")
    kinds, names = (np.atleast_1d(arrays[key]) for key in ("thing_kinds", "thing_names"))
    count = len(kinds)
    if not 1 <= count <= MOST_THINGS or kinds.shape != (count,) or names.shape != (count,):
        raise InputError(f"it holds {count} things: {MOST_THINGS} are the limit.")
    for key, (number, axes) in _SHAPES.items():
        if arrays[key].dtype.kind not in number or arrays[key].ndim != axes:
            raise InputError(f"{key} is not an array of the right kind: save it again.")
    if arrays["thing_places"].shape[:2] != (count, frames) or len(arrays["thing_rotations"]) != count:
        raise InputError("the tracks of its things are not as long as the motion: save it again.")
    sizes = arrays["thing_sizes"]
    if sizes.shape != (count, 2) or (sizes.astype(np.float64) < 0).any():
        raise InputError("the sizes of its things are damaged: save it again.")
    ends = np.minimum(np.cumsum(sizes.astype(np.float64), axis=0), 1e9).astype(np.int64)
    if ends[-1].tolist() != [len(arrays["thing_vertices"]), len(arrays["thing_faces"])]:
        raise InputError("the surfaces of its things are cut off: save it again.")
    return tuple(_thing(arrays, i, ends - sizes.astype(np.int64), ends) for i in range(count))


def _thing(arrays: Mapping[str, Array], i: int, starts: Array, ends: Array) -> Thing:
    vertices = arrays["thing_vertices"][starts[i, 0] : ends[i, 0]]
    rows = slice(int(starts[i, 1]), int(ends[i, 1]))
    mesh = Mesh(vertices, arrays["thing_faces"][rows], arrays["thing_colours"][rows])
    kind, name = (str(arrays[key][i])[:40] for key in ("thing_kinds", "thing_names"))
    return Thing(kind, mesh, arrays["thing_places"][i], arrays["thing_rotations"][i], name)
