"""The shapes of things, one file of ``static/things`` each (its README says what their frames are)."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

import numpy as np

from motion.errors import InputError

from .kinds import KINDS, LEAVES
from .thing import Mesh

FOLDER = Path(__file__).resolve().parents[2] / "static" / "things"
USUAL = {
    "chair": (0.45, 0.44),
    "bench": (0.45, 1.4),
    "table": (0.74, 1.2),
    "bed": (0.48, 1.0),
    "door frame": (2.05, 0.95),
    "box": (0.28, 0.38),
    "ball": (0.2, 0.2),
}
"""Height and width in metres of the files of those kinds of which others can be had."""
_ON_FLOOR = 0.02
"""Metres above the floor below which a part of furniture stays there."""


@lru_cache(maxsize=64)
def shape(kind: str, *, height: float | None = None, width: float | None = None) -> Mesh:
    """The surface of a kind of thing.

    Args:
        kind: one of :data:`~motion.things.KINDS` or :data:`~motion.things.kinds.LEAVES`.
        height: metres from the floor to a seat, a table's top, a bed's mattress or the lintel of a door frame, and
            of a box; the usual by default. Other things have one height.
        width: metres along X of furniture, of a box, and across a ball; the usual by default.

    Raises:
        InputError: if there is no such kind, or a size is not between 1 cm and 3 m.
    """
    if kind not in (*KINDS, *LEAVES):
        raise InputError(f"There is no thing {kind!r:.40}: choose one of {', '.join(KINDS)}.")
    for size in (height, width):
        if size is not None and not 0.01 <= size <= 3.0:
            raise InputError(f"A thing of {size:g} m cannot be built: give 0.01 to 3 m.")
    import trimesh  # takes a while to load

    stored = trimesh.load_mesh(FOLDER / f"{kind.replace(' ', '-')}.ply", process=False)
    vertices = np.array(stored.vertices)
    if kind in USUAL:
        high, wide = USUAL[kind]
        taller, wider = (height or high) - high, (width or wide) - wide
        if kind == "ball":
            vertices *= 1 + wider / wide
        elif kind == "box":
            vertices *= [1 + wider / wide, 1 + taller / high, 1 + wider / wide]
        else:  # legs, posts and backs move apart and up, and what joins them is drawn out
            vertices[:, 0] += np.sign(vertices[:, 0]) * wider / 2
            vertices[:, 1] += (vertices[:, 1] > _ON_FLOOR) * taller
        if kind == "table":  # a narrow one is less deep
            vertices[:, 2] += np.sign(vertices[:, 2]) * (min(0.75, 0.9 * (wide + wider)) - 0.75) / 2
    assert isinstance(stored.visual, trimesh.visual.ColorVisuals)
    return Mesh(vertices, stored.faces, stored.visual.face_colors[:, :3])
