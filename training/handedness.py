"""Which hand acts, and which mirror image of a scene a sentence gets.

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

from training.judge.rules import limb_travel

LEAD = 1.5
"""How many times further than the other the leading hand moves."""
LEAST = 0.3
"""Metres over which a leading hand moves at least."""
_NAMES_SIDE = re.compile(r"\b(left|right)(wards)?\b", re.IGNORECASE)


def leading_hand(positions: NDArray[np.floating], events: Mapping[str, Any] | None) -> str | None:
    """ "left" or "right" where one hand or foot of person a leads, else None.

    Args:
        positions: (2, T, 22, 3) metres.
        events: the scene's, see :class:`training.corpus.scene.Scene`: a touch by one limb, or a side that
            is noted, decides; else the wrist that moves much further than the other.
    """
    events = events or {}
    noted = {touch["a"].partition("_")[0] for touch in events.get("contact") or ()}
    noted = noted or {(events.get("side") or {}).get("a")} - {None}
    if noted:
        return noted.pop() if len(noted) == 1 and noted <= {"left", "right"} else None
    travel = {s: limb_travel(positions[0], f"{s}_wrist", f"{s}_shoulder") for s in ("left", "right")}
    least, most = sorted(travel, key=travel.__getitem__)
    return most if travel[most] > max(LEAST, LEAD * travel[least]) else None


def mirrored(caption: str, hand: str | None, draw: float) -> bool:
    """Whether a scene is shown mirrored under this caption; ``draw`` is uniform in [0, 1)."""
    if hand is None or _NAMES_SIDE.search(caption):
        return draw < 0.5
    return hand == "left"
