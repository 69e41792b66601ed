"""Measures of a duet: quality of the motion, and what the two people do to each other.

Every measure takes a :class:`~motion.clip.Duet` of any of the project's skeletons and is plain numpy.
"""

from .bodies import Capsules, capsules
from .interaction import (
    MEASURES,
    Contact,
    Measure,
    compare,
    contact_events,
    facing_angle,
    hand_distance,
    pelvis_distance,
    response_delay,
    summary,
)
from .quality import FootSkate, Penetration, bone_drift, foot_skate, jerk, penetration

__all__ = [
    "MEASURES",
    "Capsules",
    "Contact",
    "FootSkate",
    "Measure",
    "Penetration",
    "bone_drift",
    "capsules",
    "compare",
    "contact_events",
    "facing_angle",
    "foot_skate",
    "hand_distance",
    "jerk",
    "pelvis_distance",
    "penetration",
    "response_delay",
    "summary",
]
