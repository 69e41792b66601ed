"""Mirrored captions."""

from __future__ import annotations

import re

_SWAP = {"left": "right", "clockwise": "counterclockwise", "leftwards": "rightwards"}
_SWAP.update({value: key for key, value in _SWAP.items()} | {"anticlockwise": "clockwise"})


def mirror_caption(text: str) -> str:
    """The caption of the mirrored motion: left and right, clockwise and counterclockwise change places."""

    def other(match: re.Match[str]) -> str:
        word = match.group(0)
        swapped = _SWAP[word.lower()]
        return swapped.upper() if word.isupper() else swapped.capitalize() if word[0].isupper() else swapped

    return re.sub(rf"\b({'|'.join(_SWAP)})\b", other, text, flags=re.IGNORECASE)
