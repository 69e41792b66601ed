"""What two people do to each other: distances, facing, contacts."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from webdemo.motion import Clip, Duet, Skeleton
from webdemo.motion.transforms import facing

from .bodies import Capsules, capsules, point_segment_distance, sideless

Array = NDArray[np.floating]

PALM = 0.08
"""Metres from the wrist joint to the middle of the palm, along the forearm: 22 joints end at the wrist."""
HANDS_TOUCH = 0.10
"""Metres between two palms that count as hand on hand."""
SKIN_TOUCH = 0.05
"""Metres between a palm or a foot and the surface of the other's body that count as touching."""
_JOIN_GAP = 0.1
_SHORTEST = 0.05


def pelvis_distance(duet: Duet) -> Array:
    """(T,) distance of the two roots over the floor plan, metres."""
    a, b = duet.positions[:, :, _root(duet.skeleton)][..., [0, 2]]
    return np.linalg.norm(a - b, axis=-1)


def wrist_to_wrist(duet: Duet) -> Array:
    """(T,) distance of the closest pair of wrists, one of each person, metres."""
    wrists = _limbs(duet.skeleton, "wrist")
    a, b = duet.positions[:, :, wrists]
    return np.linalg.norm(a[:, :, None] - b[:, None], axis=-1).min(axis=(1, 2))


def wrist_to_body(duet: Duet) -> Array:
    """(2, T) distance in metres from the nearest wrist of a, then of b, to the bones of the other's trunk
    (torso, neck and head)."""
    body = capsules(duet.skeleton)
    wrists = _limbs(duet.skeleton, "wrist")
    trunk = np.flatnonzero(body.trunk)
    found = []
    for me, other in ((duet.a, duet.b), (duet.b, duet.a)):
        starts, ends = other.positions[:, body.starts[trunk]], other.positions[:, body.ends[trunk]]
        gaps = point_segment_distance(me.positions[:, wrists, None], starts[:, None], ends[:, None])
        found.append(gaps.min(axis=(1, 2)))
    return np.array(found)


def facing_angle(duet: Duet) -> Array:
    """(2, T) angle in degrees between where a person faces and where the other stands; first a, then b.

    0 is straight ahead, 180 behind; over the floor plan.
    """
    found = []
    root = _root(duet.skeleton)
    for me, other in ((duet.a, duet.b), (duet.b, duet.a)):
        forward = facing(me.positions, me.skeleton)[..., [0, 2]]
        towards = (other.positions[:, root] - me.positions[:, root])[..., [0, 2]]
        cos = np.sum(forward * towards, axis=-1) / np.maximum(np.linalg.norm(towards, axis=-1), 1e-6)
        found.append(np.degrees(np.arccos(np.clip(cos, -1.0, 1.0))))
    return np.array(found)


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
        return asdict(self)


def contact_events(duet: Duet) -> list[Contact]:
    """Stretches during which hands meet, or a hand or foot of one person is on the other's body.

    Hands meet where the middles of two palms are within 10 cm; a hand or foot is on a body where it is
    within 5 cm of the surface of its capsules. Stretches less than 0.1 s apart are one; those under
    0.05 s are left out.

    Returns:
        contacts by start.
    """
    body = capsules(duet.skeleton)
    palms = [_palms(person) for person in duet.people]
    feet = _limbs(duet.skeleton, "foot", "ankle")
    gaps = np.linalg.norm(palms[0][:, :, None] - palms[1][:, None], axis=-1)
    hands = gaps.min(axis=(1, 2)) < HANDS_TOUCH
    found = [Contact(*ends, "hands", "hand on hand") for ends in _stretches(hands, duet.fps)]
    for me, other in ((0, 1), (1, 0)):
        mine, theirs = _shown(duet.roles[me]), _shown(duet.roles[other])
        target = duet.people[other].positions
        # Hands that meet also bring each near the other's forearm: one contact, not two.
        on_body = _touching(palms[me], target, body, margin=SKIN_TOUCH) & ~hands
        found += [
            Contact(*ends, "touch", f"hand of {mine} on {theirs}") for ends in _stretches(on_body, duet.fps)
        ]
        kicks = _touching(duet.people[me].positions[:, feet], target, _above_ground(body, duet.skeleton),
                          margin=SKIN_TOUCH)  # fmt: skip
        found += [
            Contact(*ends, "foot", f"foot of {mine} on {theirs}") for ends in _stretches(kicks, duet.fps)
        ]
    return sorted(found, key=lambda contact: (contact.start, contact.kind, contact.label))


def _touching(points: Array, target: Array, body: Capsules, *, margin: float) -> NDArray[np.bool_]:
    """(T,) whether any of points (T, P, 3) is within ``margin`` of the surface of a body (T, J, 3)."""
    gaps = point_segment_distance(
        points[:, :, None], target[:, None, body.starts], target[:, None, body.ends]
    )
    return (gaps - body.radii < margin).any(axis=(1, 2))


def _above_ground(body: Capsules, skeleton: Skeleton) -> Capsules:
    """The body without feet: feet side by side on the floor are no kick."""
    kept = np.array([sideless(skeleton.joint_names[end]) not in ("foot", "ankle") for end in body.ends])
    return Capsules(body.starts[kept], body.ends[kept], body.radii[kept], body.trunk[kept])


def _shown(role: str) -> str:
    """A role in a sentence: letters large, words as they are."""
    return role.upper() if len(role) == 1 else role


def _palms(person: Clip) -> Array:
    """(T, 2, 3) the middles of the palms."""
    wrists, elbows = _limbs(person.skeleton, "wrist"), _limbs(person.skeleton, "elbow")
    wrist, forearm = person.positions[:, wrists], person.positions[:, wrists] - person.positions[:, elbows]
    return wrist + PALM * forearm / np.maximum(np.linalg.norm(forearm, axis=-1, keepdims=True), 1e-6)


def _root(skeleton: Skeleton) -> int:
    """The joint that stands for where a person is: the pelvis, whatever the skeleton calls it."""
    for name in ("pelvis", "base_of_spine", "torso"):
        if name in skeleton.joint_names:
            return skeleton.index(name)
    return 0


def _limbs(skeleton: Skeleton, *parts: str) -> list[int]:
    """Left and right joint of the first of ``parts`` that the skeleton has."""
    for part in parts:
        if f"left_{part}" in skeleton.joint_names:
            return [skeleton.index(f"left_{part}"), skeleton.index(f"right_{part}")]
    raise KeyError(f"{skeleton.name} has none of the joints {parts}.")


def _stretches(flags: NDArray[np.bool_], fps: float) -> list[tuple[int, int]]:
    """(start, stop) of the runs of True, joined over short gaps, without the shortest."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]]).astype(np.int8)))
    joined: list[tuple[int, int]] = []
    for start, stop in edges.reshape(-1, 2).tolist():
        if joined and start - joined[-1][1] < _JOIN_GAP * fps:
            joined[-1] = (joined[-1][0], stop)
        else:
            joined.append((start, stop))
    return [(start, stop) for start, stop in joined if stop - start >= _SHORTEST * fps]
