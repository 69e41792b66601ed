"""The player's colours and lamps for pictures that are drawn here; ``static/player/palette.js`` reads the same ones."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from motion.looks import Colour, rgb, themes

Worn = Mapping[str, Colour]

_REACH = 18.0
"""Metres from the camera's target after which the floor is as dim as it gets."""


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
        sky, horizon: of the sky high up and right above the floor.
        floor, far: of the floor at the camera's target and in the distance.
        grid, grid_strong: of the lines on it.
        reach: metres from the camera's target after which the floor is as in the distance.
        shade: what full shadow multiplies the floor by.
        ghost, ink: of a pale figure, and of captions.
        lamps: the light on bodies.
        bodies, given_bodies: by zone, a's and b's; greyer while a motion is given.
        people, given: middle, left and right limbs of skeletons, a's and b's.
    """

    sky: Colour
    horizon: Colour
    far: Colour
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
    reach: float

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


def _theme(stored: Mapping[str, Any]) -> Theme:
    lamps = dict(stored["lamps"])
    a, b = (_worn(zones) for zones in stored["bodies"])
    plain = ("sky", "horizon", "far", "floor", "grid", "ghost", "ink")
    return Theme(
        **{name: rgb(stored[name]) for name in plain},
        grid_strong=rgb(stored["gridStrong"]),
        shade=tuple(stored["shade"]),
        lamps=Lamps(shine=lamps.pop("shine"), **{name: tuple(light) for name, light in lamps.items()}),
        bodies=(a, b),
        people=_limbs(stored["people"]),
        given=_limbs(stored["given"]),
        reach=_REACH,
    )


def _limbs(people: Sequence[Sequence[str]]) -> tuple[tuple[Colour, Colour, Colour], ...]:
    return tuple((rgb(middle), rgb(left), rgb(right)) for middle, left, right in people)


THEMES = {name: _theme(stored) for name, stored in themes().items()}
