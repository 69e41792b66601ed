"""Things as arrays of our two-person .npz, beside the people's; a file without them has none.

========================  ======================================================================================
``thing_kinds``           (K,) text, such as "chair"
``thing_names``           (K,) text, what the words call each
``thing_places``          (K, T, 3) float32 metres
``thing_rotations``       (K, T, 3, 3) float32
``thing_sizes``           (K, 2) vertices and triangles of each
``thing_vertices``        (V, 3) float32 metres, one thing after another, each in its own frame
``thing_faces``           (F, 3) int32, counted from each thing's own first vertex
``thing_colours``         (F, 3) uint8 sRGB
``grips``                 JSON text: person, side, shape, first frame and last frame of each, see :mod:`motion.hands`
``looks``                 (2,) text, the bodies that the two wear, see :mod:`motion.looks`; absent where nothing is said
========================  ======================================================================================
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from motion.errors import InputError
from motion.hands import Grip, grips_of, to_lists
from motion.looks import UNSAID, checked
from motion.things.thing import MOST_THINGS, Mesh, Thing

from .files import read_json

Array = NDArray[Any]

KEYS = (
    "thing_kinds",
    "thing_names",
    "thing_places",
    "thing_rotations",
    "thing_sizes",
    "thing_vertices",
    "thing_faces",
    "thing_colours",
)
GRIPS = "grips"
"""Name of the array of grips."""
LOOKS = "looks"
"""Name of the array of looks."""
_SHAPES = {
    "thing_places": ("f", 3),
    "thing_rotations": ("f", 4),
    "thing_sizes": ("iu", 2),
    "thing_vertices": ("f", 2),
    "thing_faces": ("iu", 2),
    "thing_colours": ("u", 2),
}
"""Kind of number and number of axes of each array of numbers."""


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


def things_of(arrays: Mapping[str, Array], frames: int, label: str) -> tuple[Thing, ...]:
    """The things of a file whose arrays have been read; () where it holds none.

    Args:
        arrays: of the file, by name.
        frames: of its people.
        label: what to call the file in messages.

    Raises:
        InputError: one sentence on what is wrong with them.
    """
    if not any(key in arrays for key in KEYS):
        return ()
    if missing := [key for key in KEYS if key not in arrays]:
        raise InputError(f"{label} holds things without {missing[0]}: save it again.")
    kinds, names = (np.atleast_1d(arrays[key]) for key in ("thing_kinds", "thing_names"))
    count = len(kinds)
    if not 1 <= count <= MOST_THINGS or kinds.shape != (count,) or names.shape != (count,):
        raise InputError(f"{label} holds {count} things: {MOST_THINGS} are the limit.")
    for key, (number, axes) in _SHAPES.items():
        if arrays[key].dtype.kind not in number or arrays[key].ndim != axes:
            raise InputError(f"{label}, {key}: it is not an array of the right kind: save it again.")
    if arrays["thing_places"].shape[:2] != (count, frames) or len(arrays["thing_rotations"]) != count:
        raise InputError(f"{label}: the tracks of its things are not as long as the motion: save it again.")
    sizes = arrays["thing_sizes"]
    if sizes.shape != (count, 2) or (sizes.astype(np.float64) < 0).any():
        raise InputError(f"{label}: the sizes of its things are damaged: save it again.")
    ends = np.minimum(np.cumsum(sizes.astype(np.float64), axis=0), 1e9).astype(np.int64)
    if ends[-1].tolist() != [len(arrays["thing_vertices"]), len(arrays["thing_faces"])]:
        raise InputError(f"{label}: the surfaces of its things are cut off: save it again.")
    try:
        return tuple(_thing(arrays, i, ends - sizes.astype(np.int64), ends) for i in range(count))
    except InputError as error:
        raise InputError(f"{label}: {error}") from None


def _thing(arrays: Mapping[str, Array], i: int, starts: Array, ends: Array) -> Thing:
    vertices = arrays["thing_vertices"][starts[i, 0] : ends[i, 0]]
    rows = slice(int(starts[i, 1]), int(ends[i, 1]))
    mesh = Mesh(vertices, arrays["thing_faces"][rows], arrays["thing_colours"][rows])
    kind, name = (str(arrays[key][i])[:40] for key in ("thing_kinds", "thing_names"))
    return Thing(kind, mesh, arrays["thing_places"][i], arrays["thing_rotations"][i], name)


def grips_array(grips: Sequence[Grip]) -> dict[str, Array]:
    """The array of some grips; none for none."""
    return {GRIPS: np.array(json.dumps(to_lists(grips)))} if grips else {}


def grips_in(arrays: Mapping[str, Array], label: str) -> tuple[Grip, ...]:
    """The grips of a file whose arrays have been read; raises InputError for what is none."""
    if GRIPS not in arrays:
        return ()
    try:
        return grips_of(read_json(str(arrays[GRIPS])))
    except InputError as error:
        raise InputError(f"{label}: {error}") from None
    except ValueError as error:
        raise InputError(f"{label}: the text of its grips {error}: save it again.") from None


def looks_array(looks: tuple[str, str]) -> dict[str, Array]:
    """The array of the looks of two people; none where nothing is said."""
    return {} if looks == UNSAID else {LOOKS: np.array(looks)}


def looks_in(arrays: Mapping[str, Array], label: str) -> tuple[str, str]:
    """The looks in a file whose arrays have been read; raises InputError for what is none."""
    if LOOKS not in arrays:
        return UNSAID
    try:
        return checked([str(look) for look in np.atleast_1d(arrays[LOOKS])[:3]])
    except InputError as error:
        raise InputError(f"{label}: {error}") from None
