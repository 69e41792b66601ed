"""The shapes of things, parametric, in metres; each opens with what its frame is.

What a room has stands on the floor on its origin and faces +Z, where the people are. A part that moves is a shape of
its own.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from .kinds import CURTAIN, DOOR_HEIGHT, DOOR_WIDTH, PANE_HEIGHT, PANE_WIDTH, RAIL, SILL
from .parts import Part, ball, box, hoop, placed, pleated, rod, slab, turned, upper

OAK, WALNUT, STEEL, CLOTH = "#c79a63", "#8a5a34", "#aab2bd", "#6f8fa8"
CREAM, RED, GREEN, INK, GOLD = "#efe6d6", "#c8453c", "#4f8a4c", "#2b3240", "#d9ab3f"
CARD, TEAL, ROSE, SKY = "#cfa877", "#3d8f8a", "#d8647f", "#9cc7e8"
PLASTER, WHITE, LINEN = "#ddd5c6", "#f4f1ea", "#b9695a"


def _legs(width: float, depth: float, height: float, thick: float, colour: str) -> list[Part]:
    x, z = width / 2 - thick / 2, depth / 2 - thick / 2
    return [box((thick, height, thick), (sx * x, height / 2, sz * z), colour) for sx in (-1, 1) for sz in (-1, 1)]


def _chair(height: float = 0.45, width: float = 0.44) -> list[Part]:
    back = [box((0.035, 0.46, 0.03), (s * (width / 2 - 0.03), height + 0.22, -0.215), OAK, lean=-0.1) for s in (-1, 1)]
    rails = [
        box((width - 0.06, 0.075, 0.018), (0, height + up, -0.215 - 0.1 * (up - 0.22)), OAK, lean=-0.1)
        for up in (0.21, 0.39)
    ]
    seat = [
        box((width, 0.035, 0.43), (0, height - 0.0375, 0), OAK),
        box((width - 0.04, 0.025, 0.39), (0, height - 0.0125, 0), CLOTH),
    ]
    return [*_legs(width - 0.02, 0.41, height - 0.05, 0.04, WALNUT), *seat, *back, *rails]


def _bench(height: float = 0.45, width: float = 1.4) -> list[Part]:
    planks = [box((width, 0.035, 0.115), (0, height - 0.0175, z), OAK) for z in (-0.13, 0.0, 0.13)]
    feet = [
        part
        for s in (-1, 1)
        for part in (
            box((0.06, height - 0.035, 0.06), (s * (width / 2 - 0.16), (height - 0.035) / 2, -0.13), INK),
            box((0.06, height - 0.035, 0.06), (s * (width / 2 - 0.16), (height - 0.035) / 2, 0.13), INK),
            box((0.06, 0.05, 0.32), (s * (width / 2 - 0.16), height - 0.06, 0), INK),
        )
    ]
    return [*planks, *feet]


def _table(height: float = 0.74, width: float = 1.2) -> list[Part]:
    depth = min(0.75, 0.9 * width)
    apron = [box((width - 0.12, 0.07, 0.02), (0, height - 0.07, s * (depth / 2 - 0.07)), WALNUT) for s in (-1, 1)]
    return [
        *_legs(width - 0.08, depth - 0.08, height - 0.035, 0.06, WALNUT),
        *apron,
        box((width, 0.035, depth), (0, height - 0.0175, 0), OAK),
    ]


def _computer() -> list[Part]:
    """A table with a screen, and a keyboard before the person at it."""
    top = 0.74
    return [
        *_table(top),
        *upper(box((0.56, 0.34, 0.025), (0, top + 0.3, -0.1), INK), "z", "#9cc7e8"),
        box((0.05, 0.16, 0.03), (0, top + 0.08, -0.115), STEEL),
        box((0.22, 0.012, 0.16), (0, top + 0.006, -0.1), STEEL),
        *upper(box((0.42, 0.018, 0.14), (0, top + 0.009, 0.2), INK), "y", STEEL),
    ]


def _bed(height: float = 0.48, width: float = 1.0) -> list[Part]:
    return [
        *_legs(width, 2.04, height - 0.24, 0.06, WALNUT),
        box((width, 0.08, 2.04), (0, height - 0.2, 0), WALNUT),
        box((width - 0.04, 0.16, 0.7), (0, height - 0.08, -0.65), CREAM),
        box((width, 0.16, 1.3), (0, height - 0.08, 0.35), CLOTH),
        box((0.6 * width, 0.09, 0.34), (0, height + 0.05, -0.78), "#ffffff", lean=0.12),
        box((width, height + 0.38, 0.05), (0, (height + 0.38) / 2, -1.05), OAK),
    ]


def _door_frame(height: float = 2.05, width: float = 0.95) -> list[Part]:
    posts = [box((0.09, height, 0.14), (s * (width / 2 + 0.045), height / 2, 0), CREAM) for s in (-1, 1)]
    return [
        *posts,
        box((width + 0.18, 0.09, 0.14), (0, height + 0.045, 0), CREAM),
        box((width, 0.015, 0.14), (0, 0.0075, 0), OAK),
    ]


def _box(height: float = 0.28, width: float = 0.38) -> list[Part]:
    """The origin is its middle."""
    return upper(box((width, height, 0.75 * width), (0, 0, 0), CARD), "y", "#e2c194")


def _ball(width: float = 0.2) -> list[Part]:
    """The origin is its middle; white bands show how it turns."""
    band = hoop(width / 2, 0.03 * width, "#ffffff", sides=4, steps=24)
    return [ball(width / 2, (0, 0, 0), RED, fine=2), band, placed(band, turns=[(np.pi / 2, "y")])]


def _book() -> list[Part]:
    """The origin is the middle of its back cover, its spine on -X, and its front cover towards +Z."""
    covers = [box((0.15, 0.215, 0.004), (0, 0, z), TEAL) for z in (0.002, 0.032)]
    return [
        *covers,
        box((0.004, 0.215, 0.026), (-0.073, 0, 0.017), TEAL),
        box((0.142, 0.205, 0.026), (0, 0, 0.017), CREAM),
    ]


def _cup() -> list[Part]:
    """The origin is in its middle, its handle towards +X."""
    wall = [(0, -0.045), (0.032, -0.045), (0.04, -0.035), (0.042, 0.045), (0.037, 0.045), (0.035, -0.036), (0, -0.036)]
    drink = turned([(0.0355, 0.026), (0, 0.026)], "#6b4226", sides=14)
    handle = placed(hoop(0.026, 0.006, CREAM, arc=np.pi, steps=10), (0.036, 0, 0), [(-np.pi / 2, "z")])
    return [turned(wall, CREAM, sides=14), drink, handle]


def _phone() -> list[Part]:
    """The origin is its middle, the screen towards +Z."""
    return upper(box((0.074, 0.15, 0.009), (0, 0, 0), INK), "z", "#9cc7e8")


def _umbrella() -> list[Part]:
    """The origin is on its handle, the open canopy 0.75 m above it."""
    canopy = [
        (0, 0.86),
        (0.18, 0.83),
        (0.36, 0.76),
        (0.48, 0.66),
        (0.47, 0.66),
        (0.35, 0.745),
        (0.17, 0.815),
        (0, 0.845),
    ]
    return [
        turned(canopy, RED, sides=10),
        rod((0, -0.02, 0), (0, 0.9, 0), 0.008, STEEL, sides=6),
        rod((0, -0.09, 0), (0, 0.06, 0), 0.015, WALNUT),
        placed(hoop(0.035, 0.012, WALNUT, arc=np.pi, steps=8), (0.035, -0.09, 0), [(np.pi, "z")]),
    ]


def _flower() -> list[Part]:
    """The origin is on its stem, the blossom 0.3 m above it."""
    petals = [
        placed(
            ball(0.036, (0.042, 0, 0), ROSE, fine=1, stretch=(1, 0.38, 0.8)),
            (0, 0.3, 0),
            [(0.5, "z"), (k * np.pi / 3, "y")],
        )
        for k in range(6)
    ]
    leaves = [
        placed(
            ball(0.04, (0.04, 0, 0), GREEN, fine=1, stretch=(1, 0.12, 0.45)),
            (0, 0.1 + 0.05 * k, 0),
            [(0.6, "z"), (2.5 * k, "y")],
        )
        for k in range(2)
    ]
    return [
        rod((0, -0.08, 0), (0, 0.3, 0), 0.006, GREEN, sides=6),
        ball(0.026, (0, 0.312, 0), GOLD, fine=1),
        *petals,
        *leaves,
    ]


def _ring() -> list[Part]:
    """The origin is its middle; wider than a finger, so that it is seen across a room."""
    return [hoop(0.014, 0.0028, GOLD), ball(0.007, (0, 0.021, 0), "#bfe3f2", fine=1)]


def _sword() -> list[Part]:
    """The origin is in the middle of its grip, the blade along +Y."""
    blade = [(-0.022, 0.11), (0.022, 0.11), (0.018, 0.82), (0, 0.92), (-0.018, 0.82)]
    return [
        slab(blade, 0.007, STEEL),
        box((0.2, 0.022, 0.03), (0, 0.1, 0), GOLD),
        ball(0.022, (0, -0.1, 0), GOLD, fine=1),
        rod((0, -0.09, 0), (0, 0.09, 0), 0.015, WALNUT),
    ]


def _stick() -> list[Part]:
    """The origin is a third of its length from one end, the longer part along +Y."""
    return [rod((0, -0.4, 0), (0, 0.8, 0), 0.016, WALNUT), rod((0, -0.41, 0), (0, -0.37, 0), 0.019, INK)]


def _guitar() -> list[Part]:
    """The origin is the middle of its body, the neck along +Y and the strings towards +Z."""
    angles = np.linspace(0, 2 * np.pi, 20, endpoint=False)
    lower = np.stack([0.19 * np.cos(angles), 0.16 * np.sin(angles) - 0.08], axis=1)
    upper = np.stack([0.14 * np.cos(angles), 0.12 * np.sin(angles) + 0.13], axis=1)
    hole = np.stack([0.045 * np.cos(angles[::2]), 0.045 * np.sin(angles[::2]) + 0.06], axis=1)
    head = [(-0.03, 0.66), (0.03, 0.66), (0.04, 0.8), (-0.04, 0.8)]
    return [
        slab(lower, 0.09, OAK),
        slab(upper, 0.09, OAK),
        slab(hole, 0.1, INK),
        box((0.05, 0.42, 0.03), (0, 0.45, 0.008), WALNUT),
        box((0.1, 0.025, 0.11), (0, -0.13, 0), WALNUT),
        slab(head, 0.02, WALNUT),
    ]


def _cigarette() -> list[Part]:
    """The origin is between the fingers, the glowing end along +Y."""
    return [
        rod((0, -0.03, 0), (0, 0, 0), 0.0045, OAK, sides=6),
        rod((0, 0, 0), (0, 0.055, 0), 0.0045, "#ffffff", sides=6),
        rod((0, 0.055, 0), (0, 0.06, 0), 0.0045, RED, sides=6),
    ]


def _bag() -> list[Part]:
    """The origin is at the top of its handles; the bag hangs below."""
    handles = [placed(hoop(0.07, 0.007, WALNUT, arc=np.pi, steps=10), (0, -0.07, z)) for z in (-0.03, 0.03)]
    return [box((0.34, 0.2, 0.13), (0, -0.23, 0), TEAL), box((0.345, 0.06, 0.135), (0, -0.1, 0), WALNUT), *handles]


def window() -> list[Part]:
    """A piece of wall with an opening for two sashes, a sill, and a curtain rail before it."""
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
    across = np.linspace(-CURTAIN / 2, CURTAIN / 2, 13)
    folds = np.stack([across, 0.035 * (-1.0) ** np.arange(13)], axis=1)
    return [pleated(folds, RAIL, 0.012, LINEN)]


def door_leaf() -> list[Part]:
    """A door without its frame, hinged about its origin at the floor, along +X."""
    wide, high = DOOR_WIDTH, DOOR_HEIGHT
    panels = [
        box((0.62 * wide, part * high, 0.055), (wide / 2, y * high, 0), OAK) for y, part in ((0.27, 0.36), (0.72, 0.4))
    ]
    knobs = [ball(0.03, (wide - 0.08, 1.02, z), STEEL, fine=1) for z in (-0.07, 0.07)]
    pin = rod((wide - 0.08, 1.02, -0.07), (wide - 0.08, 1.02, 0.07), 0.01, STEEL, sides=6)
    return [box((wide, high - 0.02, 0.04), (wide / 2, high / 2, 0), WALNUT), *panels, pin, *knobs]


def hifi() -> list[Part]:
    """A sideboard with an amplifier between two loudspeakers, its knobs at the height of a hand."""
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
    "chair": _chair,
    "bench": _bench,
    "table": _table,
    "computer": _computer,
    "bed": _bed,
    "door frame": _door_frame,
    "box": _box,
    "ball": _ball,
    "book": _book,
    "cup": _cup,
    "phone": _phone,
    "umbrella": _umbrella,
    "flower": _flower,
    "ring": _ring,
    "sword": _sword,
    "stick": _stick,
    "guitar": _guitar,
    "bag": _bag,
    "cigarette": _cigarette,
    "window": window,
    "curtain": curtain,
    "hi-fi": hifi,
    "sash": sash,
    "door": door_leaf,
}
