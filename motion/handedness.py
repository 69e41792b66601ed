"""Detects a person's leading hand, and whether words name a side."""

from __future__ import annotations

import re

import numpy as np
from numpy.typing import NDArray

from .skeleton import SMPL22
from .transforms import heading, heading_matrix

Array = NDArray[np.floating]

LEAD = 1.5
"""Least ratio of the leading hand's movement to the other's."""
LEAST = 0.3
"""Metres over which a leading hand moves at least."""
_SIDE = re.compile(r"\b(left|right)(wards)?\b", re.IGNORECASE)


def names_side(words: str) -> bool:
    """True if words say left or right."""
    return _SIDE.search(words) is not None


def limb_travel(positions: Array, joint: str, root: str) -> float:
    """Metres over which a joint moves relative to its root joint, in the body's own heading.

    The diagonal of the box that holds 96 % of its path, so that a pose which is merely held counts nothing.

    Args:
        positions: (T, 22, 3) metres.
    """
    relative = positions[:, SMPL22.index(joint)] - positions[:, SMPL22.index(root)]
    own = np.einsum("tij,ti->tj", heading_matrix(heading(positions)), relative)
    low, high = np.percentile(own, (2, 98), axis=0)
    return float(np.linalg.norm(high - low))


def leading_wrist(positions: Array) -> str | None:
    """ "left" or "right" where that wrist moves much further than the other, else None.

    Args:
        positions: (T, 22, 3) metres.
    """
    travel = {side: limb_travel(positions, f"{side}_wrist", f"{side}_shoulder") for side in ("left", "right")}
    least, most = sorted(travel, key=travel.__getitem__)
    return most if travel[most] > max(LEAST, LEAD * travel[least]) else None
