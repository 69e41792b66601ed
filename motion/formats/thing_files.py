"""One's own thing: the surface in a .glb, .obj, .stl or .ply file, read as if sent by an enemy.

Triangles are counted before anything is decoded; .glb is decoded by :mod:`.glb_file`, the others by trimesh, from bytes
alone, without materials and pictures. A finer surface is made coarser.
"""

from __future__ import annotations

import io
import re
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from motion.errors import InputError
from motion.things.thing import Mesh
from motion.vectors import unit

from .files import read_bytes
from .glb_file import GlbFile, opened
from .glb_nodes import placed, with_those_above

Array = NDArray[np.floating]

SUFFIXES = (".glb", ".obj", ".stl", ".ply")
MOST_BYTES = 12 * 2**20
MOST_TRIANGLES = 200_000
"""Triangles of a file; all of them are decoded."""
MOST_DRAWN = 6_000
"""Triangles that a thing keeps; a finer surface is made coarser."""
SMALLEST, LARGEST = 0.005, 4.0
"""Metres of its longest side."""
_PLAIN = (150, 163, 181)
"""Colour (sRGB) of a surface that has none."""
_MOST_WORDS = 3_000_000
"""Of a text: numbers in words take twenty times their bytes as they are read."""
_SURFACE = re.compile(rb"^[ \t]*+[vf][ \t][^\r\n]*+", re.MULTILINE)
"""The lines of a .obj file that are read; a material or a name on each triangle would take trimesh minutes."""
_ELEMENT = re.compile(rb"^element\s+(\S{1,40})\s+(\d{1,20})\s*$", re.MULTILINE)


def read_thing(source: str | Path | bytes, *, name: str | None = None) -> Mesh:
    """The surface of one's own thing, about the middle of its box, Y up, in metres.

    Lengths are metres; a file whose longest side would have more than four is taken for one in millimetres. The Z axis
    of .stl and .ply points up, as their programs have it.

    Args:
        source: a path, or the file's bytes; then ``name`` must end in its suffix.
        name: what to call it in messages.

    Raises:
        InputError: one sentence that says what is wrong with the file and what to do.
    """
    label = name or (Path(source).name if not isinstance(source, bytes) else "")
    suffix = Path(label).suffix.lower()
    if suffix not in SUFFIXES:
        raise InputError(f"{label or 'This file'} is no thing: give a .glb, .obj, .stl or .ply file.")
    data, label = read_bytes(source, label, remedy="reduce its mesh")
    if len(data) > MOST_BYTES:
        raise InputError(f"{label} has {len(data) / 2**20:.0f} MB: reduce its mesh to {MOST_BYTES // 2**20} MB.")
    if suffix == ".glb":
        with opened(data, label, "used as a thing") as file:
            vertices, faces, colours = _from_glb(file)
    else:
        _check_counts(data, suffix, label)
        vertices, faces, colours = _from_trimesh(data, suffix, label)
    return _fitted(vertices, faces, colours, label)


# ---- .obj, .stl, .ply ------------------------------------------------------------------------------------
def _check_counts(data: bytes, suffix: str, label: str) -> None:
    """Refuses a file with too many triangles by what it declares."""
    if suffix == ".stl":
        text = data[:5] == b"solid" and b"facet" in data[:1000]
        counted = data.count(b"endfacet") if text else int.from_bytes(data[80:84], "little")
        if not text and len(data) != 84 + 50 * counted:
            raise InputError(f"{label} is damaged: it is not as long as its triangles are. Export it again.")
    elif suffix == ".ply":
        head, mark, _ = data[:65536].partition(b"end_header")
        if not mark or not data.startswith(b"ply"):
            raise InputError(f"{label} is no PLY file, or its header is damaged: export it again.")
        counted = sum(int(count) for _, count in _ELEMENT.findall(head))
    else:
        counted = data.count(b"\nf ") + data.count(b"\nf\t") + data.count(b"\nv ") + data.count(b"\nv\t")
    if not 0 < counted <= 2 * MOST_TRIANGLES:
        raise InputError(f"{label} has {counted:,} triangles and vertices: give 1 to {MOST_TRIANGLES:,} triangles.")
    text = suffix == ".obj" or data[:5] == b"solid" or b"format ascii" in data[:1000]
    if text and np.count_nonzero(np.frombuffer(data, np.uint8) <= ord(" ")) > _MOST_WORDS:
        raise InputError(f"{label} has more than {_MOST_WORDS:,} words: reduce its mesh.")


def _from_trimesh(data: bytes, suffix: str, label: str) -> tuple[Array, NDArray, NDArray]:
    import trimesh

    if suffix == ".obj":
        data = b"\n".join(_SURFACE.findall(data.replace(b"\\\n", b" ").replace(b"\\\r\n", b" ")))
    try:
        made: Any = trimesh.load(
            io.BytesIO(data), file_type=suffix[1:], force="mesh", process=False, resolver=None, skip_materials=True
        )
        vertices, faces = np.asarray(made.vertices, dtype=np.float64), np.asarray(made.faces, dtype=np.int64)
        colours = np.tile(np.array(_PLAIN, dtype=np.uint8), (len(faces), 1))
        if made.visual.defined and made.visual.kind in ("face", "vertex"):
            colours = np.asarray(made.visual.face_colors)[:, :3].astype(np.uint8)
    except Exception:  # trimesh raises what its readers raise
        raise InputError(f"{label} is damaged, or not what its name says: export it again.") from None
    if suffix in (".stl", ".ply"):
        vertices = vertices[:, [1, 2, 0]] if vertices.ndim == 2 and vertices.shape[1] == 3 else vertices
    return vertices, faces, colours


# ---- .glb ------------------------------------------------------------------------------------------------
def _from_glb(file: GlbFile) -> tuple[Array, NDArray, NDArray]:
    """All triangles of the file as its nodes place them, each in the colour of its material."""
    parents = file.node_parents()
    nodes, meshes = (file.document.get(key, []) for key in ("nodes", "meshes"))
    used = [(i, file.index(node["mesh"], len(meshes), "mesh")) for i, node in enumerate(nodes) if "mesh" in node]
    corners = sum(file.corners(part, MOST_TRIANGLES) for _, mesh in used for part in meshes[mesh]["primitives"])
    if not 0 < corners <= 3 * MOST_TRIANGLES:
        file.refuse(f"it has {corners // 3:,} triangles", f"give 1 to {MOST_TRIANGLES:,}")
    vertices, faces, colours, first = [], [], [], 0
    world = placed(file, with_those_above([node for node, _ in used], parents), parents)
    for node, mesh in used:
        place = world[node][0]
        if not (np.abs(place) <= 1e6).all():  # NaN is not
            file.refuse("a node in it is very far away or infinite", "apply its transforms")
        for part in meshes[mesh]["primitives"]:
            if file.corners(part, MOST_TRIANGLES):
                places = part["attributes"]["POSITION"]
                points = file.numbers(places, "VEC3", 3 * MOST_TRIANGLES, "vertices").astype(np.float64)
                cells = file.triangles(part, len(points), MOST_TRIANGLES)
                vertices.append(points @ place[:3, :3].T + place[:3, 3])
                turned = np.linalg.det(place[:3, :3]) < 0
                faces.append((cells[:, ::-1] if turned else cells) + first)
                colours.append(np.tile(_colour(file, part), (len(cells), 1)))
                first += len(points)
    return np.concatenate(vertices), np.concatenate(faces), np.concatenate(colours)


def _colour(file: GlbFile, part: dict[str, Any]) -> NDArray[np.uint8]:
    materials = file.document.get("materials", [])
    if part.get("material") is None:
        return np.array(_PLAIN, dtype=np.uint8)
    found = materials[file.index(part["material"], len(materials), "material")]
    light = found.get("pbrMetallicRoughness", {}).get("baseColorFactor", [1, 1, 1, 1])
    if len(light) != 4 or not all(isinstance(v, int | float) and 0 <= v <= 1 for v in light):
        file.refuse("a colour in it is none", "export it again")
    return np.rint(255 * np.array(light[:3], dtype=float) ** (1 / 2.2)).astype(np.uint8)


# ---- the surface -----------------------------------------------------------------------------------------
def _fitted(vertices: Array, faces: NDArray, colours: NDArray, label: str) -> Mesh:
    """A surface in metres about its middle, coarse enough to be drawn."""
    if vertices.shape[1:] != (3,) or faces.shape[1:] != (3,) or not len(vertices) or not len(faces):
        raise InputError(f"{label} has no triangles: export its surface as triangles.")
    if len(faces) > MOST_TRIANGLES or faces.min() < 0 or faces.max() >= len(vertices):
        raise InputError(f"{label} has too many triangles, or corners that are not there: export it again.")
    used = vertices[np.unique(faces)]
    if not (np.isfinite(used).all() and np.abs(used).max() < 1e9):
        raise InputError(f"{label} holds places that are not finite or very far away: scale it, or export it again.")
    vertices = vertices - (used.min(axis=0) + used.max(axis=0)) / 2
    longest = float(np.ptp(used, axis=0).max())
    scale = 0.001 if longest > LARGEST else 1.0
    if not SMALLEST <= longest * scale <= LARGEST:
        raise InputError(f"{label} is {longest:.3g} m large: scale it to between 5 mm and {LARGEST:g} m.")
    points, cells, shades = _coarser(vertices * scale, faces, colours)
    return _split(points, cells, shades, label)


def _coarser(vertices: Array, faces: NDArray, colours: NDArray) -> tuple[Array, NDArray, NDArray]:
    """The surface with at most :data:`MOST_DRAWN` triangles: vertices of one cell of a grid become one."""
    used, faces = np.unique(faces, return_inverse=True)
    vertices, faces = vertices[used], faces.reshape(-1, 3)
    cell = 1e-6
    while True:
        keys = np.floor((vertices - vertices.min(axis=0)) / cell).astype(np.int64)
        if (size := int(keys.max()) + 1) < 2**21:  # a number a cell, which sorts a hundred times as fast
            keys = keys @ np.array([size * size, size, 1])
        _, group, count = np.unique(keys, axis=0, return_inverse=True, return_counts=True)
        group = group.reshape(-1)
        made = group[faces]
        whole = (made[:, 0] != made[:, 1]) & (made[:, 1] != made[:, 2]) & (made[:, 2] != made[:, 0])
        if whole.sum() <= MOST_DRAWN:
            break
        cell = max(1.3 * cell, 1e-3)
    mean = np.stack([np.bincount(group, weights=vertices[:, axis]) / count for axis in range(3)], axis=1)
    return mean, made[whole], colours[whole]


def _split(vertices: Array, faces: NDArray, colours: NDArray, label: str) -> Mesh:
    """The surface with the vertices of sharp edges split."""
    if not len(faces):
        raise InputError(f"{label} has no triangles with an area: export it again.")
    normals = np.cross(vertices[faces[:, 1]] - vertices[faces[:, 0]], vertices[faces[:, 2]] - vertices[faces[:, 0]])
    normals = unit(normals)
    # Corners that meet in a vertex stay together where their triangles face the same way, roughly.
    towards = np.rint(1.2 * np.repeat(normals, 3, axis=0)).astype(np.int64)
    keys = np.c_[faces.reshape(-1), towards]
    found, which = np.unique(keys, axis=0, return_inverse=True)
    return Mesh(vertices[found[:, 0]], which.reshape(-1, 3), colours)
