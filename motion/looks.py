"""Looks of the two people of a scene: the bodies that ship, chosen by what words say about them."""

from __future__ import annotations

import json
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Any, TypeAlias

from .errors import InputError

LOOKS = ("man", "woman", "old-man", "old-woman", "boy", "girl")
"""Names of the bodies in ``static/bodies``."""
SIZES = {"boy": 0.74, "girl": 0.74}
"""Lengths of the bones of those who are smaller than SMPL22, as a share of its bones. In MakeHuman's targets a child's
legs, trunk and arms are 0.72 to 0.79 of a man's, and the head, which the surface says, is 0.94."""
UNSAID = ("man", "woman")
"""The looks of a and b where nothing is said."""


def looks_of(people: Sequence[tuple[str, str]]) -> tuple[str, str]:
    """The looks of two people.

    A person whose sex is not said takes the one that the other has not, so that the two can be told apart.

    Args:
        people: (sex, age) of a and b; sex "m", "f" or "", age "old", "child" or "".
    """
    (one, _), (other, _) = people
    if not one and not other:
        sexes = ("m", "f")
    else:
        opposite = {"m": "f", "f": "m"}
        sexes = (one or opposite[other], other or opposite[one])
    a, b = (_look(sex, age) for sex, (_, age) in zip(sexes, people, strict=True))
    return a, b


def _look(sex: str, age: str) -> str:
    """The name of a person's body."""
    if age == "child":
        return "boy" if sex == "m" else "girl"
    return ("old-" if age == "old" else "") + ("man" if sex == "m" else "woman")


def size_of(look: str) -> float:
    """Lengths of the bones of a person who looks so, as a share of SMPL22's."""
    return SIZES.get(look, 1.0)


def grown_up(looks: tuple[str, str]) -> tuple[str, str]:
    """The looks of the same two people as adults."""
    adults = {"boy": "man", "girl": "woman"}
    a, b = (adults.get(look, look) for look in looks)
    return a, b


def checked(looks: Any) -> tuple[str, str]:
    """Two names of :data:`LOOKS` from outside.

    Raises:
        InputError: for anything else.
    """
    if isinstance(looks, (list, tuple)) and len(looks) == 2 and all(look in LOOKS for look in looks):
        return looks[0], looks[1]
    raise InputError(f"The looks of two people are two of {', '.join(LOOKS)}.")


# ---- Colours, which ``static/player/colours.json`` holds for files, films and the page alike -------------------------
Colour: TypeAlias = tuple[float, float, float]

COLOURS = Path(__file__).resolve().parents[1] / "static" / "player" / "colours.json"


@cache
def themes() -> dict[str, dict[str, Any]]:
    """Each theme's colours (``"#rrggbb"``, sRGB) and lamps under its name."""
    by_name: dict[str, dict[str, Any]] = json.loads(COLOURS.read_text(encoding="utf-8"))
    return by_name


BODIES: tuple[dict[str, str], dict[str, str]] = tuple(themes()["light"]["bodies"])
"""Colours (sRGB) of the zones of :class:`motion.body.Body` in the light theme, person a's and b's."""


def rgb(colour: str) -> Colour:
    """``"#rrggbb"`` as three numbers from 0 to 1."""
    return int(colour[1:3], 16) / 255, int(colour[3:5], 16) / 255, int(colour[5:7], 16) / 255


def linear(colour: str) -> list[float]:
    """``"#rrggbb"`` as light, which is what glTF's materials hold (IEC 61966-2-1)."""
    return [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in rgb(colour)]


def hex_of(levels: Sequence[int]) -> str:
    """Three levels from 0 to 255 as ``"#rrggbb"``."""
    return "#" + "".join(f"{level:02x}" for level in levels)
