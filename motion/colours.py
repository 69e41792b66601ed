"""The colour of each person in files and films: those of the player's light theme (``palette.js``)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias

Colour: TypeAlias = tuple[float, float, float]

BODIES = (
    {"top": "#2a6bdc", "trousers": "#1f3c7d", "shoes": "#16233f", "skin": "#dfd3cb", "hair": "#28375a",
     "eyes": "#10141d"},
    {"top": "#e87a1c", "trousers": "#7d421a", "shoes": "#3f2413", "skin": "#e6d3c3", "hair": "#5d3a22",
     "eyes": "#140f0c"},
)  # fmt: skip
"""Colours (sRGB) of the zones of :class:`motion.body.Body`, person a's and b's."""


def rgb(colour: str) -> Colour:
    """``"#rrggbb"`` as three numbers from 0 to 1."""
    return int(colour[1:3], 16) / 255, int(colour[3:5], 16) / 255, int(colour[5:7], 16) / 255


def linear(colour: str) -> list[float]:
    """``"#rrggbb"`` as light, which is what glTF's materials hold (IEC 61966-2-1)."""
    return [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in rgb(colour)]


def hex_of(levels: Sequence[int]) -> str:
    """Three levels from 0 to 255 as ``"#rrggbb"``."""
    return "#" + "".join(f"{level:02x}" for level in levels)
