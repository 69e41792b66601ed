"""The colours of people in files, films and on the page, which ``static/player/colours.js`` holds for all of them."""

from __future__ import annotations

import json
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Any, TypeAlias

Colour: TypeAlias = tuple[float, float, float]

FILE = Path(__file__).resolve().parents[1] / "static" / "player" / "colours.js"


@cache
def themes() -> dict[str, dict[str, Any]]:
    """The JSON that the file exports: each theme's colours (``"#rrggbb"``) and lamps under its name."""
    _, data = FILE.read_text(encoding="utf-8").split("export default", 1)
    found: dict[str, dict[str, Any]] = json.loads(data.strip().removesuffix(";"))
    return found


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
