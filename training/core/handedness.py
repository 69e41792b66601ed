"""The acting hand, the choice of a scene's mirror image for a sentence, and mirrored captions.

Half of all handshakes in a mirrored corpus are left-handed. A sentence that names no side then stands for two
motions at once, and a network that has seen few of each gives their mean: hands that almost meet. So a
sentence that names no side stands for the right-handed image, where one hand leads; a sentence that names
one, or a motion without a leading hand, is mirrored half of the time.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from motion.transforms import leading_wrist, names_side


def leading_hand(positions: NDArray[np.floating], events: Mapping[str, Any] | None) -> str | None:
    """ "left" or "right" where one hand or foot of person a leads, else None.

    Args:
        positions: (2, T, 22, 3) metres.
        events: the scene's, see :class:`training.corpus.cues.Scene`: a touch by one limb decides; else the wrist that
            moves much further than the other.
    """
    noted = {touch["a"].partition("_")[0] for touch in (events or {}).get("contact") or ()}
    if noted:
        return noted.pop() if len(noted) == 1 and noted <= {"left", "right"} else None
    return leading_wrist(positions[0])


def mirrored(caption: str, hand: str | None, draw: float) -> bool:
    """True if a scene is shown mirrored under this caption; ``draw`` is uniform in [0, 1)."""
    if hand is None or names_side(caption):
        return draw < 0.5
    return hand == "left"


_SWAP = {"left": "right", "clockwise": "counterclockwise", "leftwards": "rightwards"}
_SWAP.update({value: key for key, value in _SWAP.items()} | {"anticlockwise": "clockwise"})


def mirror_caption(text: str) -> str:
    """The caption of the mirrored motion: left and right, clockwise and counterclockwise change places."""

    def other(match: re.Match[str]) -> str:
        word = match.group(0)
        swapped = _SWAP[word.lower()]
        return swapped.upper() if word.isupper() else swapped.capitalize() if word[0].isupper() else swapped

    return re.sub(rf"\b({'|'.join(_SWAP)})\b", other, text, flags=re.IGNORECASE)
