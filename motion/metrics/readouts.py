"""All measures of a duet in one dictionary, and two duets side by side."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from motion import Duet

from .interaction import contact_events, facing_angle, hand_distance, hand_to_body, pelvis_distance, response_delay
from .quality import bone_drift, foot_skate, jerk, penetration


@dataclass(frozen=True)
class Measure:
    """Name and display of a number of :func:`summary`.

    Attributes:
        key: its key in the summary.
        label: its name on the page.
        unit: its unit.
        digits: digits after the decimal point.
        meaning: a one-line explanation.
        better: "lower" if less is better, "" if the measure is descriptive.
    """

    key: str
    label: str
    unit: str
    digits: int
    meaning: str
    better: str = ""


MEASURES = (
    Measure("foot_skate", "Foot skate", "cm/s", 1, "Mean speed of feet while they stand on the floor.", "lower"),
    Measure("skate_ratio", "Skating frames", "%", 1, "Standing feet that slide faster than 50 cm/s.", "lower"),
    Measure("penetration", "Penetration", "cm", 2, "Mean over time of the deepest overlap of the bodies.", "lower"),
    Measure("penetration_max", "Deepest overlap", "cm", 1, "At the worst frame.", "lower"),
    Measure("jerk", "Jerk", "m/s³", 0, "Mean third derivative of the joints: shaking and snapping.", "lower"),
    Measure("bone_drift", "Bone drift", "%", 2, "How much the bones change in length.", "lower"),
    Measure("distance", "Distance, mean", "m", 2, "Between the two pelvises, along the floor."),
    Measure("distance_min", "Distance, closest", "m", 2, "Between the two pelvises, along the floor."),
    Measure("hands_min", "Hands, closest", "m", 2, "Between the two nearest hands, one of each person."),
    Measure("facing", "Facing, mean", "°", 0, "Mean angle between where a person faces and where the other is."),
    Measure("contact_seconds", "In contact", "s", 1, "Time during which a hand or foot is on the other person."),
    Measure(
        "response_delay",
        "Response delay",
        "s",
        2,
        "How long after the first person the second one moves, where their speeds are alike.",
    ),
)
"""The measures of the summary, in display order."""


def summary(duet: Duet) -> dict[str, float | None]:
    """One number per measure, None for a delay that cannot be determined; keys and units are those of `MEASURES`."""
    return readouts(duet)["summary"]


def readouts(duet: Duet) -> dict[str, Any]:
    """All measurements of a duet, ready for JSON.

    Returns:
        ``summary``: numbers by the keys of :data:`MEASURES`;
        ``curves``: ``pelvis_distance``, ``hand_distance``, ``hand_to_body_a``, ``hand_to_body_b``
        (metres), ``facing_a``, ``facing_b`` (degrees) and ``penetration`` (cm), a list of T numbers each;
        ``contacts``: dictionaries with ``start``, ``stop`` (frames), ``kind`` and ``label``.
    """
    skate, overlap = foot_skate(duet), penetration(duet)
    distance, hands, body, angles = (pelvis_distance(duet), hand_distance(duet), hand_to_body(duet), facing_angle(duet))
    contacts = contact_events(duet)
    touched = {frame for contact in contacts for frame in range(contact.start, contact.stop)}
    numbers = {
        "foot_skate": skate.speed,
        "skate_ratio": 100 * skate.ratio,
        "penetration": overlap.mean,
        "penetration_max": overlap.deepest,
        "jerk": jerk(duet),
        "bone_drift": bone_drift(duet),
        "distance": float(distance.mean()),
        "distance_min": float(distance.min()),
        "hands_min": float(hands.min()),
        "facing": float(angles.mean()),
        "contact_seconds": len(touched) / duet.fps,
        "response_delay": response_delay(duet),
    }
    curves = {
        "pelvis_distance": distance,
        "hand_distance": hands,
        "hand_to_body_a": body[0],
        "hand_to_body_b": body[1],
        "facing_a": angles[0],
        "facing_b": angles[1],
        "penetration": overlap.depth,
    }
    return {
        "summary": {key: None if value is None else round(value, 4) for key, value in numbers.items()},
        "curves": {key: [round(float(value), 4) for value in curve] for key, curve in curves.items()},
        "contacts": [contact.to_dict() for contact in contacts],
    }


def compare(before: Duet | None, after: Duet) -> dict[str, Any]:
    """Read-outs of a motion beside those it had before it was corrected.

    Args:
        before: the motion as it was, or None if there was nothing to correct.
        after: the motion as it is shown.

    Returns:
        ``before`` (a summary, or None), ``after`` (a summary), and the ``curves`` and ``contacts`` of
        the motion that is shown.
    """
    shown = readouts(after)
    return {
        "before": None if before is None else summary(before),
        "after": shown["summary"],
        "curves": shown["curves"],
        "contacts": shown["contacts"],
    }
