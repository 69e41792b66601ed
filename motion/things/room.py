"""The shapes of what a room has: windows and their curtains, doors and a hi-fi, in metres.

Each stands on the floor on its origin and faces +Z, where the people are. A part that moves is a shape of its own.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from .parts import Part

OAK, WALNUT, STEEL, INK = "#c79a63", "#8a5a34", "#aab2bd", "#2b3240"
PLASTER, WHITE, LINEN, SKY = "#ddd5c6", "#f4f1ea", "#b9695a", "#9cc7e8"

SILL, PANE_WIDTH, PANE_HEIGHT = 0.9, 0.54, 1.14
"""Height of a window's sill over the floor, and width and height of each of its two sashes."""
RAIL = 2.14
"""Height of a curtain rail."""
CURTAIN = 0.58
"""Width of one of two curtains."""
DOOR_WIDTH, DOOR_HEIGHT = 0.95, 2.05


def window() -> list[Part]:
    """A piece of wall with an opening for two sashes, a sill, and a curtain rail before it."""
    from .parts import box

    side, top = PANE_WIDTH + 0.08, SILL + PANE_HEIGHT
    posts = [box((0.16, PANE_HEIGHT, 0.12), (s * side, SILL + PANE_HEIGHT / 2, 0), PLASTER) for s in (-1, 1)]
    ends = [box((0.05, 0.05, 0.05), (s * 1.24, RAIL, 0.14), WALNUT) for s in (-1, 1)]
    return [
        box((2 * side + 0.16, SILL, 0.12), (0, SILL / 2, 0), PLASTER),
        box((2 * side + 0.16, 0.18, 0.12), (0, top + 0.09, 0), PLASTER),
        *posts,
        box((2 * PANE_WIDTH + 0.14, 0.035, 0.13), (0, SILL, 0.03), OAK),
        box((2.48, 0.028, 0.028), (0, RAIL, 0.14), WALNUT),
        *ends,
    ]


def sash() -> list[Part]:
    """Half a window, hinged about its origin at the lower corner, along +X."""
    from .parts import box

    wide, high, thick = PANE_WIDTH, PANE_HEIGHT, 0.05
    stiles = [box((thick, high, 0.04), (x, high / 2, 0), WHITE) for x in (thick / 2, wide - thick / 2)]
    rails = [box((wide, thick, 0.04), (wide / 2, y, 0), WHITE) for y in (thick / 2, high - thick / 2)]
    bars = [
        box((wide, 0.02, 0.03), (wide / 2, 0.62 * high, 0), WHITE),
        box((0.02, high, 0.03), (wide / 2, high / 2, 0), WHITE),
    ]
    return [*stiles, *rails, *bars]


def curtain() -> list[Part]:
    """One of two curtains in folds, down to the floor, about its middle."""
    from .parts import pleated

    across = np.linspace(-CURTAIN / 2, CURTAIN / 2, 13)
    folds = np.stack([across, 0.035 * (-1.0) ** np.arange(13)], axis=1)
    return [pleated(folds, RAIL, 0.012, LINEN)]


def door_leaf() -> list[Part]:
    """A door without its frame, hinged about its origin at the floor, along +X."""
    from .parts import ball, box, rod

    wide, high = DOOR_WIDTH, DOOR_HEIGHT
    panels = [
        box((0.62 * wide, part * high, 0.055), (wide / 2, y * high, 0), OAK) for y, part in ((0.27, 0.36), (0.72, 0.4))
    ]
    knobs = [ball(0.03, (wide - 0.08, 1.02, z), STEEL, fine=1) for z in (-0.07, 0.07)]
    pin = rod((wide - 0.08, 1.02, -0.07), (wide - 0.08, 1.02, 0.07), 0.01, STEEL, sides=6)
    return [box((wide, high - 0.02, 0.04), (wide / 2, high / 2, 0), WALNUT), *panels, pin, *knobs]


def hifi() -> list[Part]:
    """A sideboard with an amplifier between two loudspeakers, its knobs at the height of a hand."""
    from .parts import box, rod

    top = 0.92
    legs = [box((0.05, 0.12, 0.05), (sx * 0.48, 0.06, sz * 0.15), INK) for sx in (-1, 1) for sz in (-1, 1)]
    doors = [box((0.5, top - 0.2, 0.02), (s * 0.265, (top + 0.1) / 2, 0.19), OAK) for s in (-1, 1)]
    speakers = [
        part
        for s in (-1, 1)
        for part in (
            box((0.22, 0.38, 0.26), (s * 0.41, top + 0.19, 0), WALNUT),
            rod((s * 0.41, top + 0.13, 0.12), (s * 0.41, top + 0.13, 0.138), 0.08, INK, sides=16),
            rod((s * 0.41, top + 0.29, 0.12), (s * 0.41, top + 0.29, 0.138), 0.04, INK, sides=12),
        )
    ]
    knobs = [
        rod((x, top + 0.09, 0.14), (x, top + 0.09, 0.18), radius, STEEL, sides=12)
        for x, radius in ((0.16, 0.036), (0.06, 0.018), (-0.02, 0.018))
    ]
    return [
        *legs,
        box((1.08, top - 0.12, 0.38), (0, (top + 0.12) / 2, 0), WALNUT),
        *doors,
        *speakers,
        box((0.5, 0.18, 0.28), (0, top + 0.09, 0), INK),
        box((0.14, 0.05, 0.01), (-0.15, top + 0.11, 0.143), SKY),
        *knobs,
    ]


BUILD: dict[str, Callable[..., list[Part]]] = {
    "window": window,
    "curtain": curtain,
    "hi-fi": hifi,
    "sash": sash,
    "door": door_leaf,
}
