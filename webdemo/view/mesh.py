"""One moment of a motion as a surface for 3D programs and printers: PLY or OBJ, through trimesh."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from motion.body import Body, skin
from motion.clip import Clip, Duet, stacked_positions
from motion.errors import InputError
from motion.formats.files import replacing

from .stage import Style, seen_by

if TYPE_CHECKING:
    from trimesh import Trimesh

SUFFIXES = (".ply", ".obj")


def mesh(motion: Clip | Duet, frame: int, *, style: Style | None = None) -> list[Trimesh]:
    """The surface of each person at a frame, coloured by its zones.

    Args:
        motion: one person or two on SMPL22.
        frame: which; a negative one counts from the end.
        style: its body and its theme's colours are used.

    Returns:
        a mesh a person in metres, Y up.

    Raises:
        InputError: for a frame that the motion has not, or joints other than SMPL22's.
    """
    import trimesh  # takes a quarter of a second, which the page's start is spared

    if not -motion.num_frames <= frame < motion.num_frames:
        raise InputError(f"The motion has frames 0 to {motion.num_frames - 1}, but not {frame}.")
    style, people = style or Style(), stacked_positions(motion)
    found = []
    for person, (body, zones) in enumerate(zip(style.worn(motion, small=False), style.colours.bodies, strict=False)):
        shades = np.array([(*zones.get(zone, zones["top"]), 1.0) for zone in body.zones])
        found.append(
            trimesh.Trimesh(
                skin(body, people[person, frame][None], seen=seen_by(people[:, [frame]], person))[0].astype(np.float64),
                body.faces,
                vertex_colors=(255 * shades[_zone_of_vertices(body)]).round().astype(np.uint8),
                process=False,
            )
        )
    return found


def write_mesh(motion: Clip | Duet, path: str | Path, *, frame: int, style: Style | None = None) -> Path:
    """Writes :func:`mesh` of everybody as one .ply (binary) or .obj.

    Raises:
        InputError: as :func:`mesh`, for another suffix, or where the file cannot be written; no file is left.
    """
    import trimesh

    path = Path(path)
    suffix = path.suffix.lower()
    if suffix not in SUFFIXES:
        raise InputError(f"Meshes end in {' or '.join(SUFFIXES)}, not in {suffix or 'nothing'}.")
    whole = trimesh.util.concatenate(mesh(motion, frame, style=style))
    data = whole.export(file_obj=None, file_type=suffix[1:])
    with replacing(path) as temporary:
        temporary.write_bytes(data if isinstance(data, bytes) else data.encode())
    return path


def _zone_of_vertices(body: Body) -> np.ndarray:
    """(V,) a zone of each vertex: that of the last face that has it."""
    zones = np.zeros(len(body.vertices), dtype=np.int64)
    zones[body.faces] = body.face_zones[:, None]
    return zones
