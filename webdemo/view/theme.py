"""The player's colours and lamps for pictures that are drawn here: ``static/player/palette.js`` in Python."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from motion.colours import BODIES, Colour, rgb

Worn = Mapping[str, Colour]


@dataclass(frozen=True)
class Lamps:
    """Light (red, green, blue) of each lamp, and how strong highlights are."""

    key: Colour
    sky: Colour
    ground: Colour
    rim: Colour
    shine: float


@dataclass(frozen=True)
class Theme:
    """Colours from 0 to 1.

    Attributes:
        sky, horizon, floor, grid, grid_strong: of what the people stand in.
        shade: what full shadow multiplies the floor by.
        ghost, ink: of a pale figure, and of captions.
        lamps: the light on bodies.
        bodies, given_bodies: by zone, a's and b's; greyer while a motion is given.
        people, given: middle, left and right limbs of skeletons, a's and b's.
    """

    sky: Colour
    horizon: Colour
    floor: Colour
    grid: Colour
    grid_strong: Colour
    shade: Colour
    ghost: Colour
    ink: Colour
    lamps: Lamps
    bodies: tuple[Worn, Worn]
    people: tuple[tuple[Colour, Colour, Colour], ...]
    given: tuple[tuple[Colour, Colour, Colour], ...]

    @property
    def given_bodies(self) -> tuple[Worn, Worn]:
        """The colours of people who are given, greyer than those who are made."""
        return _greyer(self.bodies[0]), _greyer(self.bodies[1])


def mix(first: Colour, second: Colour, share: float) -> Colour:
    """A colour ``share`` of the way from the first to the second."""
    a, b, c = (one + share * (other - one) for one, other in zip(first, second, strict=True))
    return a, b, c


def _greyer(zones: Worn) -> Worn:
    found = {}
    for zone, (red, green, blue) in zones.items():
        grey = 0.75 * (0.3 * red + 0.55 * green + 0.15 * blue) + 0.14
        found[zone] = mix((red, green, blue), (grey, grey, grey), 0.72)
    return found


def _worn(zones: Mapping[str, str]) -> Worn:
    return {zone: rgb(colour) for zone, colour in zones.items()}


def _limbs(*people: tuple[str, str, str]) -> tuple[tuple[Colour, Colour, Colour], ...]:
    return tuple((rgb(middle), rgb(left), rgb(right)) for middle, left, right in people)


_DARK_BODIES = (
    {"top": "#3f86ff", "trousers": "#2a4f9c", "shoes": "#1d2f57", "skin": "#dfd3cb", "hair": "#314674",
     "eyes": "#10141d"},
    {"top": "#ff912e", "trousers": "#94501f", "shoes": "#54301a", "skin": "#e6d3c3", "hair": "#714829",
     "eyes": "#140f0c"},
)  # fmt: skip

THEMES = {
    "light": Theme(
        sky=rgb("#dfe7f2"), horizon=rgb("#f4f6fa"), floor=rgb("#e3e8f0"), grid=rgb("#cad2de"),
        grid_strong=rgb("#b6c1d1"), shade=(0.55, 0.59, 0.68), ghost=rgb("#8e99aa"), ink=rgb("#475569"),
        lamps=Lamps((0.78, 0.75, 0.7), (0.4, 0.43, 0.48), (0.2, 0.2, 0.21), (0.5, 0.53, 0.58), 0.07),
        bodies=(_worn(BODIES[0]), _worn(BODIES[1])),
        people=_limbs(("#2468d8", "#5c9cf5", "#17479e"), ("#e07a10", "#f7a944", "#b25606")),
        given=_limbs(("#7186ab", "#9fb2d2", "#566a8c"), ("#b09070", "#cdb498", "#8c7053")),
    ),
    "dark": Theme(
        sky=rgb("#0b0e14"), horizon=rgb("#222a37"), floor=rgb("#1b212c"), grid=rgb("#2c3543"),
        grid_strong=rgb("#3d4a5d"), shade=(0.3, 0.32, 0.38), ghost=rgb("#667389"), ink=rgb("#cbd5e1"),
        lamps=Lamps((0.84, 0.82, 0.79), (0.3, 0.34, 0.42), (0.14, 0.15, 0.17), (1.0, 1.05, 1.15), 0.08),
        bodies=(_worn(_DARK_BODIES[0]), _worn(_DARK_BODIES[1])),
        people=_limbs(("#4f94f7", "#8fc0ff", "#2f6bd0"), ("#f2933a", "#ffc27a", "#c96a14")),
        given=_limbs(("#7f92b5", "#a9bad6", "#64769a"), ("#b59a7d", "#d0bba2", "#93795e")),
    ),
}  # fmt: skip
