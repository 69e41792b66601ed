"""What can be measured on a duet: quality of the motion, and what the two people do to each other.

Every measure takes a :class:`~webdemo.motion.clip.Duet` of any of the project's skeletons and is plain numpy.
"""

from .bodies import Capsules, capsules
from .interaction import (
    Contact,
    contact_events,
    facing_angle,
    pelvis_distance,
    wrist_to_body,
    wrist_to_wrist,
)
from .quality import FootSkate, Penetration, bone_drift, foot_skate, jerk, penetration
from .readouts import MEASURES, Measure, compare, readouts, summary
from .response import response_delay

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
    "jerk",
    "pelvis_distance",
    "penetration",
    "readouts",
    "response_delay",
    "summary",
    "wrist_to_body",
    "wrist_to_wrist",
]
