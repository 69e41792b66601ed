"""Heels that rise over toes which stay: how a foot that is left behind lets the body go on.

People who walk roll over their toes. A foot that stayed flat until it swings would pull the body down into a lunge.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .easing import smoothstep
from .vectors import FLAT, unit

Array = NDArray[np.floating]

_BEHIND = 0.2
"""Metres that a foot is behind its hip from which its heel rises fully."""


def heel_raised(hip: Array, ankle: Array, toe: Array, leg: Array) -> Array:
    """Places of an ankle, taken up about its toe where a foot behind the hip is out of the leg's reach.

    Args:
        hip, ankle, toe: (T, 3) metres.
        leg: (T, 1) metres that the leg reaches.

    Returns:
        (T, 3) as far from the toe as before; what is in reach, or before the hip, stays.
    """
    foot, line = ankle - toe, hip - toe
    length, far = (np.linalg.norm(each, axis=-1, keepdims=True) for each in (foot, line))
    axis = line / np.maximum(far, 1e-9)
    along = np.clip((length**2 + far**2 - leg**2) / np.maximum(2 * far, 1e-9), -length, length)
    out = unit(foot - np.sum(foot * axis, axis=-1, keepdims=True) * axis)
    raised = toe + along * axis + np.sqrt(np.maximum(length**2 - along**2, 0.0)) * out
    ahead = np.sum((hip - ankle) * unit((toe - ankle) * FLAT), axis=-1, keepdims=True)
    short = np.linalg.norm(ankle - hip, axis=-1, keepdims=True) > leg
    turned = toe + (ankle - toe) + short * smoothstep(ahead / _BEHIND) * (raised - ankle)
    bone = turned - toe
    return np.asarray(toe + bone * length / np.maximum(np.linalg.norm(bone, axis=-1, keepdims=True), 1e-9))
