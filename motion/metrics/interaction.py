"""Interaction of two people: distances, facing, contacts."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from motion import Clip, Duet
from motion.skeleton import ARMS, TOES
from motion.transforms import facing
from motion.vectors import Array, runs

from .bodies import CAPSULES, Capsules, point_segment_distance, segment_segment_distance
from .quality import bone_drift, foot_skate, jerk, penetration

PALM = 0.08
"""Metres from the wrist joint to the middle of the palm, along the forearm: 22 joints end at the wrist.

Everywhere in the measures a hand is this line from wrist to palm. Palms that meet touch with the ends of these lines;
in a grasp the two lines overlap, with the wrists a palm's length apart."""
HANDS_TOUCH = 0.10
"""Metres between two hands that count as touching."""
HANDS_PART = 0.13
"""Metres between two hands at which a touch ends; it is larger because grips loosen and tighten."""
HANDS_NEAR = 0.25
"""Metres: a hand this near another one is about to meet it, or has just met it, and is not on the forearm."""
SKIN_TOUCH = 0.05
"""Metres between a hand or a foot and the surface of the other's body that count as touching."""
_JOIN_GAP = 0.1
_SHORTEST = 0.05
_ELBOWS, _WRISTS = [arm[1] for arm in ARMS], [arm[2] for arm in ARMS]


def pelvis_distance(duet: Duet) -> Array:
    """(T,) distance of the two roots over the floor plan, metres."""
    a, b = duet.positions[:, :, 0][..., [0, 2]]
    return np.linalg.norm(a - b, axis=-1)


def hand_distance(duet: Duet) -> Array:
    """(T,) distance of the nearest pair of hands, one of each person, metres."""
    return _hand_gaps(duet).min(axis=(1, 2))


def facing_angle(duet: Duet) -> Array:
    """(2, T) angle in degrees between where a person faces and where the other stands; first a, then b.

    0 is straight ahead, 180 behind; over the floor plan.
    """
    angles = []
    for me, other in ((duet.a, duet.b), (duet.b, duet.a)):
        forward = facing(me.positions)[..., [0, 2]]
        towards = (other.positions[:, 0] - me.positions[:, 0])[..., [0, 2]]
        cos = np.sum(forward * towards, axis=-1) / np.maximum(np.linalg.norm(towards, axis=-1), 1e-6)
        angles.append(np.degrees(np.arccos(np.clip(cos, -1.0, 1.0))))
    return np.array(angles)


@dataclass(frozen=True)
class Contact:
    """A stretch of frames during which the two people touch.

    Attributes:
        start: first frame.
        stop: one past the last frame.
        kind: ``"hands"`` (hand on hand), ``"touch"`` (hand on body) or ``"foot"`` (foot on body).
        label: for people, such as ``"hand of A on B"``.
    """

    start: int
    stop: int
    kind: str
    label: str

    def to_dict(self) -> dict[str, Any]:
        """The contact as plain values, for JSON."""
        return asdict(self)


def contact_events(duet: Duet) -> list[Contact]:
    """Stretches during which hands meet, or a hand or foot of one person is on the other's body.

    Hands meet where they are within 10 cm (:data:`PALM` says what a hand is) and part beyond 13 cm; a hand or
    foot is on a body where it is within 5 cm of the surface of its capsules. Stretches with
    gaps under 0.1 s are merged; those shorter than 0.05 s are dropped.

    Returns:
        contacts by start.
    """
    above_ground = CAPSULES.part(~CAPSULES.are("foot", "ankle"))  # feet side by side on the floor are no kick
    nearest = hand_distance(duet)
    meeting = _stretches(nearest < HANDS_TOUCH, duet.fps, loosely=nearest < HANDS_PART)
    events = [Contact(*ends, "hands", "hand on hand") for ends in meeting]
    for me, other in ((0, 1), (1, 0)):
        mine, theirs = "AB"[me], "AB"[other]
        on_body = _hand_touching(duet, me)
        for start, stop in meeting:
            on_body[start:stop] = False  # one contact, not two
        events += [Contact(*ends, "touch", f"hand of {mine} on {theirs}") for ends in _stretches(on_body, duet.fps)]
        kicks = _touching(duet.people[me].positions[:, TOES], duet.people[other].positions, above_ground)
        events += [Contact(*ends, "foot", f"foot of {mine} on {theirs}") for ends in _stretches(kicks, duet.fps)]
    return sorted(events, key=lambda contact: (contact.start, contact.kind, contact.label))


def _hand_touching(duet: Duet, me: int) -> NDArray[np.bool_]:
    """(T,) whether a hand of person ``me`` (0 or 1) is on the body of the other.

    A hand that is near one of the other's hands is not on the forearm behind it.
    """
    target = duet.people[1 - me].positions
    bones = np.stack([target[:, CAPSULES.starts], target[:, CAPSULES.ends]], axis=2)
    on = _between(_hands(duet.people[me])[:, :, None], bones[:, None]) - CAPSULES.radii < SKIN_TOUCH
    meets = _hand_gaps(duet).min(axis=2 - me) < HANDS_NEAR  # (T, 2), each hand of mine
    return np.asarray((on & ~(CAPSULES.are("wrist") & meets[..., None])).any(axis=(1, 2)))


def _touching(points: Array, target: Array, body: Capsules) -> NDArray[np.bool_]:
    """(T,) whether any of points (T, P, 3) is on the surface of a body (T, 22, 3)."""
    gaps = point_segment_distance(points[:, :, None], target[:, None, body.starts], target[:, None, body.ends])
    return np.asarray((gaps - body.radii < SKIN_TOUCH).any(axis=(1, 2)))


def palms(positions: Array) -> Array:
    """(…, T, 2, 3) the middles of the left and the right palm of people (…, T, 22, 3)."""
    forearm = positions[..., _WRISTS, :] - positions[..., _ELBOWS, :]
    length = np.maximum(np.linalg.norm(forearm, axis=-1, keepdims=True), 1e-6)
    return positions[..., _WRISTS, :] + PALM * forearm / length


def _hands(person: Clip) -> Array:
    """(T, 2, 2, 3) the left and the right hand as lines: wrist and middle of the palm, metres."""
    return np.stack([person.positions[:, _WRISTS], palms(person.positions)], axis=2)


def _hand_gaps(duet: Duet) -> Array:
    """(T, 2, 2) metres from each hand of a (left, right) to each of b."""
    a, b = (_hands(person) for person in duet.people)
    return _between(a[:, :, None], b[:, None])


def _between(first: Array, second: Array) -> Array:
    """(…,) metres between lines (…, 2, 3), broadcast."""
    first, second = np.broadcast_arrays(first, second)
    ends = [line[..., end, :].reshape(-1, 3) for line in (first, second) for end in (0, 1)]
    return segment_segment_distance(*ends).reshape(first.shape[:-2])


def _stretches(
    flags: NDArray[np.bool_], fps: float, *, loosely: NDArray[np.bool_] | None = None
) -> list[tuple[int, int]]:
    """(start, stop) of the runs of True, joined over short gaps, without the shortest.

    Runs between which ``loosely`` holds throughout are joined too, however long that takes.
    """
    joined: list[tuple[int, int]] = []
    for start, stop in runs(flags):
        last = joined[-1][1] if joined else 0
        held = loosely is not None and loosely[last:start].all()
        if joined and (held or start - last < _JOIN_GAP * fps):
            joined[-1] = (joined[-1][0], stop)
        else:
            joined.append((start, stop))
    return [(start, stop) for start, stop in joined if stop - start >= _SHORTEST * fps]


# ---- what a result shows -------------------------------------------------------------------------


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
    Measure("penetration", "Penetration", "cm", 2, "Mean over time of the deepest overlap of the bodies.", "lower"),
    Measure("penetration_max", "Deepest overlap", "cm", 1, "At the worst frame.", "lower"),
    Measure("jerk", "Jerk", "m/s³", 0, "Mean third derivative of the joints: shaking and snapping.", "lower"),
    Measure("bone_drift", "Bone drift", "%", 2, "How much the bones change in length.", "lower"),
    Measure("distance", "Distance, mean", "m", 2, "Between the two pelvises, along the floor."),
    Measure("distance_min", "Distance, closest", "m", 2, "Between the two pelvises, along the floor."),
    Measure("hands_min", "Hands, closest", "m", 2, "Between the two nearest hands, one of each person."),
    Measure("facing", "Facing, mean", "°", 0, "Mean angle between where a person faces and where the other is."),
    Measure("contact_seconds", "In contact", "s", 1, "Time during which a hand or foot is on the other person."),
)
"""The measures of the summary, in display order."""


def summary(duet: Duet) -> dict[str, float]:
    """One number per measure; keys and units are those of :data:`MEASURES`."""
    return _summary(duet, contact_events(duet))


def _summary(duet: Duet, contacts: list[Contact]) -> dict[str, float]:
    overlap, distance = penetration(duet), pelvis_distance(duet)
    touched = {frame for contact in contacts for frame in range(contact.start, contact.stop)}
    numbers = {
        "foot_skate": foot_skate(duet),
        "penetration": float(overlap.mean()),
        "penetration_max": float(overlap.max()),
        "jerk": jerk(duet),
        "bone_drift": bone_drift(duet),
        "distance": float(distance.mean()),
        "distance_min": float(distance.min()),
        "hands_min": float(hand_distance(duet).min()),
        "facing": float(facing_angle(duet).mean()),
        "contact_seconds": len(touched) / duet.fps,
    }
    return {key: round(value, 4) for key, value in numbers.items()}


def compare(before: Duet | None, after: Duet) -> dict[str, Any]:
    """Measures of a motion beside those it had before it was corrected, ready for JSON.

    Args:
        before: the motion as it was, or None if there was nothing to correct.
        after: the motion as it is shown.

    Returns:
        ``before`` (a :func:`summary`, or None), ``after`` (a summary), and the ``contacts`` of the motion that is
        shown: dictionaries with ``start``, ``stop`` (frames), ``kind`` and ``label``.
    """
    contacts = contact_events(after)
    return {
        "before": None if before is None else summary(before),
        "after": _summary(after, contacts),
        "contacts": [contact.to_dict() for contact in contacts],
    }
