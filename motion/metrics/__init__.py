"""Measures of a duet: quality of the motion, and what the two people do to each other.

Every measure takes a :class:`~motion.clip.Duet` on SMPL22 and is plain numpy.
"""

from .interaction import MEASURES, Contact, Measure, compare, contact_events, hand_distance, pelvis_distance, summary

__all__ = ["MEASURES", "Contact", "Measure", "compare", "contact_events", "hand_distance", "pelvis_distance", "summary"]
