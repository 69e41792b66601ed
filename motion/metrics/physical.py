"""Means over many duets of the measures that say how real a motion looks."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from motion import Duet

from .quality import bone_drift, foot_skate, jerk, penetration

PHYSICAL = {
    "foot_skate": ("foot skate", "cm/s"),
    "jerk": ("jerk", "m/s³"),
    "penetration": ("penetration", "cm"),
    "bone_drift": ("bone drift", "%"),
}
"""Key → (label, unit) of each measure."""


def physical(duets: Sequence[Duet]) -> dict[str, float]:
    """The mean of each measure of :data:`PHYSICAL` over duets."""
    values = [(foot_skate(duet).speed, jerk(duet), penetration(duet).mean, bone_drift(duet)) for duet in duets]
    return {key: round(float(mean), 4) for key, mean in zip(PHYSICAL, np.mean(values, axis=0), strict=True)}
