"""Holds: couples who dance in each other's arms, pairs who spin with both hands joined, and one who pulls the other up.

The network lets go of hands while people turn. There, the way of both and their hands are given.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from motion.skeleton import SIDES
from motion.vectors import Array, direction, floor_points

from .places import EVENLY
from .poses import JOINT, TRUNK, UPRIGHT, WRISTS, Pose, bending
from .window import OFTEN, REACHES, Frames, KnownFrames, Stretch


@dataclass(frozen=True)
class Hold:
    """A hold.

    Attributes:
        apart: metres between the pelvises of the two.
        turns: a second, of the two around the middle between them.
        lean: radians by which they lean towards each other.
    """

    apart: float
    turns: float
    lean: float = 0.0


COUPLE = "couple"
"""The hold of two who dance as a recorded couple does."""
HOLDS: Mapping[str, Hold] = {
    "closed": Hold(0.6, 0.14),
    "ring": Hold(0.85, 0.17),
    "palms": Hold(0.95, 0.0, lean=0.25),
    COUPLE: Hold(0.75, 0.0),
}
"""The holds by their names in the lexicon."""
TWIRL = 0.42
"""Metres between the pelvises of two people while one turns under the other's arm."""
_OVER = 1.88
"""Height in metres of the hands over the person who turns under them."""
_BASIC, _BAR = 0.16, 2.0
"""Metres and seconds of a couple's basic step to and fro."""
_TOGETHER, _GROWS = 0.8, 0.6
"""Seconds in which the two come together before it, and in which it grows to its length."""
_NEARLY = 0.2
"""Metres more than in a hold at which two who begin in it stand."""
_HIPS = [JOINT["left_hip"], JOINT["right_hip"]]
_HELD = 45
"""Frames before somebody is up in which their hand is held."""
_ARM = 0.48
"""Metres from the shoulder to the wrist of an arm that pulls."""
_NEAR = 1.15
"""Times the length of both arms between two shoulders at which the hands begin to reach for each other."""
_LEANS = np.linspace(0.1, 1.2, 12)
"""Radians by which somebody leans forward who pulls the other up: as little as gets the hands together."""
_GAP = 0.03
"""Metres from where two hands meet to each wrist."""
_SHOULDERS = {side: JOINT[f"{side}_shoulder"] for side in SIDES}
_WRIST = dict(zip(SIDES, WRISTS, strict=True))


def raised(places: Array) -> Array:
    """The place of the two joined hands over two people (2, N, 2), one of whom turns under them: (N, 3) metres."""
    return np.insert(np.mean(places, axis=0), 1, _OVER, axis=-1)


def joined(hold: str, places: Array) -> Array:
    """The places of the wrists of two people in a hold.

    Args:
        hold: of :data:`HOLDS`.
        places: (2, N, 2) x and z in metres of a, who leads, and b.

    Returns:
        (2, 2, N, 3) metres: of each person the left wrist and the right one.
    """
    a, b = (floor_points(place) for place in places)
    ahead = (b - a) / np.linalg.norm(b - a, axis=-1, keepdims=True).clip(min=1e-6)
    left = np.cross([0.0, 1.0, 0.0], ahead)  # of a
    middle, up = (a + b) / 2, np.array([0.0, 1.0, 0.0])
    if hold != "closed":
        wide, high, apart = (0.24, 1.05, 0.03) if hold == "ring" else (0.17, 1.3, 0.06)
        one, other = (middle + side * wide * left + high * up for side in (1, -1))
        gap = apart * ahead
        return np.stack([[one - gap, other - gap], [other + gap, one + gap]])
    hands = middle + 0.42 * left + 1.3 * up
    return np.stack(
        [
            [hands - 0.03 * ahead, b - 0.2 * left + 1.06 * up],  # a's right hand on b's back
            [a - 0.17 * left + 1.46 * up + 0.1 * ahead, hands + 0.03 * ahead],  # b's left on a's shoulder
        ]
    )


def danced(seconds: Array, angles: Array, sign: float) -> Array:
    """(N, 2) metres by which a couple in hold steps to and fro, along the line between them, as they turn.

    Args:
        seconds: (N,) since the beat began.
        angles: (N,) radians of one of them about the middle.
        sign: 1 for a and -1 for b, who go the same way.
    """
    ahead = sign * direction(angles)
    since = np.clip(seconds - _TOGETHER, 0, None)[:, None]
    return np.clip(since / _GROWS, 0, 1) * _BASIC * np.sin(2 * np.pi * since / _BAR) * ahead


def hold_parts(hold: str, stretch: Stretch) -> list[KnownFrames]:
    """The trunks and hands of two people in a hold."""
    courses = [stretch.course(person) for person in (0, 1)]
    apart = float(np.linalg.norm(np.subtract(*stretch.stand.places)))
    begun = stretch.start == 0 and apart < HOLDS[hold].apart + _NEARLY  # a story that begins in the hold
    at = stretch.shown(np.arange(0 if begun else REACHES, stretch.frames, OFTEN))
    wrists = joined(hold, np.stack([course.places[at] for course in courses]))
    return _with_hands(stretch, at, HOLDS[hold].lean, wrists, WRISTS, [*TRUNK, *WRISTS])


def twirl_parts(stretch: Stretch) -> list[KnownFrames]:
    """The bodies and joined right hands of two people, one of whom turns under them."""
    at = stretch.shown(np.arange(REACHES, stretch.frames - REACHES, OFTEN))
    hands = raised(np.stack([stretch.course(person).places[at] for person in (0, 1)]))
    wrist = [JOINT["right_wrist"]]
    return _with_hands(stretch, at, 0.0, np.stack([hands[None]] * 2), wrist, [*_HIPS, *TRUNK, *wrist])


def _with_hands(
    stretch: Stretch, at: Frames, lean: float, places: Array, wrists: Sequence[int], joints: Sequence[int]
) -> list[KnownFrames]:
    """Joints of two people who stand or lean, with wrists at places (2, W, N, 3)."""
    parts = []
    for person in (0, 1):
        course = stretch.course(person)
        poses = bending(course.places[at], course.headings[at], lean)
        poses[:, wrists] = np.moveaxis(places[person], 0, 1)
        parts.append(stretch.known(person, at, poses, joints))
    return parts


def pull_parts(puller: str, poses: Sequence[Pose], stretch: Stretch, *, both: bool) -> list[KnownFrames]:
    """The hands of both, and the trunk of the one who pulls.

    Args:
        puller: "a" or "b".
        poses: of the other, as :func:`.postures.postures` gives them.
        stretch: the beat.
        both: both hands are held; otherwise the right ones.
    """
    person = "ab".index(puller)
    hands = [("right", "left"), ("left", "right")] if both else [("right", "right")]
    down = [frame for frame, pose in poses if pose[0, 1] <= UPRIGHT]
    up = [frame for frame, pose in poses if pose[0, 1] > UPRIGHT and down and frame > down[-1]]
    if not up:
        return []
    course = stretch.course(person)
    frames, own, theirs = [], [], []
    known, bodies = np.array([frame for frame, _ in poses]), np.stack([pose for _, pose in poses])
    for frame in range(max(down[-1] - _HELD, known[0]), up[0] + 1, EVENLY):
        if not stretch.shows(frame - stretch.start):
            continue
        last = int(np.searchsorted(known, frame).clip(1, len(known) - 1))
        share = (frame - known[last - 1]) / (known[last] - known[last - 1])
        pose = bodies[last - 1] + share * (bodies[last] - bodies[last - 1])
        t = frame - stretch.start
        place, angle = course.places[t], float(course.headings[t])
        one, other = _leaning_to(pose, place, angle), pose.copy()
        if _gap(one, other) > _NEAR * 2 * _ARM:
            continue  # they are still on their way
        for mine, their in hands:
            line = one[_SHOULDERS[mine]] - other[_SHOULDERS[their]]
            meet, gap = other[_SHOULDERS[their]] + line / 2, _GAP * line / np.linalg.norm(line)
            one[_WRIST[mine]], other[_WRIST[their]] = meet + gap, meet - gap
        frames.append(t)
        own.append(one)
        theirs.append(other)
    if not frames:
        return []
    return [
        stretch.known(person, frames, np.stack(own), [*TRUNK, *(_WRIST[mine] for mine, _ in hands)]),
        stretch.known(1 - person, frames, np.stack(theirs), [_WRIST[their] for _, their in hands]),
    ]


def _leaning_to(pose: Array, place: Array, angle: float) -> Array:
    """The pose (22, 3) of a person at a place (2,) who leans forward as far as to reach the hand of another pose."""
    leaning = bending(place, angle, float(_LEANS[0]))
    for lean in _LEANS[1:]:
        if _gap(leaning, pose) <= 2 * _ARM:
            break
        leaning = bending(place, angle, float(lean))
    return leaning


def _gap(one: Array, other: Array) -> float:
    """Metres between the right shoulders of two poses (22, 3)."""
    return float(np.linalg.norm(one[_SHOULDERS["right"]] - other[_SHOULDERS["right"]]))
