"""Links that keep the frame and the camera; the browser's side is ``static/player/address.js``."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any
from urllib.parse import urlencode

from .film import number_of, read_player

_LIMITS = {"yaw": (-1000.0, 1000.0), "elevation": (-0.05, 1.5), "distance": (0.8, 40.0)}
_LONGEST = 100_000
"""Frames."""


def link_address(base: str, key: str, shown: str) -> str:
    """The address of a run, with the frame and the camera of a player.

    Args:
        base: of the page.
        key: of the link.
        shown: what ``READ_PLAYER`` gave; whatever is unknown in it is left out.
    """
    state: Mapping[str, Any] = read_player(shown)
    asked: dict[str, Any] = {"run": key}
    for name in ("frame", "sample"):
        value = state.get(name)
        if type(value) is int and 0 <= value < _LONGEST:
            asked[name] = value
    for name, (low, high) in _LIMITS.items():
        value = number_of(state, name, low, high)
        if value is not None:
            asked[name] = f"{value:.3f}"
    return f"{base}?{urlencode(asked)}"
