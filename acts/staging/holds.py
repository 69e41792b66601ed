"""Holds: couples who dance in each other's arms, pairs who spin with both hands joined, and one who pulls the other up.

The network lets go of hands while people turn. There, the way of both and their hands are given.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from motion.skeleton import FEET, SIDES
from motion.vectors import Array, floor_points, left_of, leftwards, unit

from .lifts import stepping
from .places import EVENLY
from .poses import JOINT, TRUNK, UPRIGHT, WRISTS, Pose, bending, leaning, upright
from .recordings import sampled
from .window import OFTEN, REACHES, Frames, KnownFrames, Stretch


@dataclass(frozen=True)
class Hold:
    """A hold.

    Attributes:
        apart: metres between the pelvises of the two.
        turns: a second, of the two around the middle between them.
        lean: radians by which they lean towards each other.
        aside: metres by which a metre of the trunk leans to the right, and each head is beside the other.
        begins: metres by which they are farther apart when a story begins with it.
    """

    apart: float
    turns: float
    lean: float = 0.0
    aside: float = 0.0
    begins: float = 0.0


COUPLE, EMBRACE = "couple", "embrace"
"""The holds of two who dance as a recorded couple does, and of two who may come up to each other for it."""
HOLDS: Mapping[str, Hold] = {
    "closed": Hold(0.6, 0.14),
    "ring": Hold(0.85, 0.17),
    "palms": Hold(0.95, 0.0, lean=0.25),
    EMBRACE: Hold(0.3, 0.0, lean=0.08, aside=0.14, begins=0.6),
    COUPLE: Hold(0.75, 0.0),
}
"""The holds by their names in the lexicon."""
TWIRL = 0.42
"""Metres between the pelvises of two people while one turns under the other's arm."""
_OVER = 1.88
"""Height in metres of the hands over the person who turns under them."""
STEP = 15
"""Frames of a step by one of two who go round in a hold."""
_HIPS = [JOINT["left_hip"], JOINT["right_hip"]]
_HELD = 45
"""Frames before somebody is up in which their hand is held."""
_NEAR = 1.1
"""Metres between two shoulders at which the hands begin to reach for each other."""
_STRAIGHT, _LEANS = 1.4, 1.2
"""Height in metres of the other's shoulder to which somebody who pulls them up stands straight, and radians a metre by
which they lean to a lower one."""
_MEET = 0.1
"""Metres by which two may still be farther apart than in their hold for their hands to begin."""
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
    left = left_of(ahead)  # of a
    middle, up = (a + b) / 2, np.array([0.0, 1.0, 0.0])
    if hold == EMBRACE:  # the left arm is over the other's, the right one under it
        over, under = (0.14 * ahead + wide * left + high * up for wide, high in ((0.06, 1.3), (-0.04, 1.1)))
        behind = np.array([-1.0, 1.0, -1.0])
        return np.stack([[b + over, b + under], [a + behind * over, a + behind * under]])
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


def hold_parts(hold: str, stretch: Stretch) -> list[KnownFrames]:
    """The trunks and hands of two people in a hold."""
    courses = [stretch.course(person) for person in (0, 1)]
    met = np.linalg.norm(courses[0].places - courses[1].places, axis=1) < HOLDS[hold].apart + _MEET
    at = stretch.shown(np.arange(REACHES, stretch.frames, OFTEN))
    at = at[met[at]]
    wrists = joined(hold, np.stack([course.places[at] for course in courses]))
    every, feet = stretch.every(EVENLY), list[KnownFrames]()
    for person, course in enumerate(courses if HOLDS[hold].turns else ()):  # by itself the network crosses their legs
        feet.append(stretch.known(person, every, stepping(course, STEP, 0, stretch.frames)[every], FEET))
    return feet + _with_hands(stretch, at, HOLDS[hold], wrists, WRISTS, [*TRUNK, *WRISTS])


def twirl_parts(stretch: Stretch) -> list[KnownFrames]:
    """The bodies and joined right hands of two people, one of whom turns under them."""
    at = stretch.shown(np.arange(REACHES, stretch.frames - REACHES, OFTEN))
    hands = raised(np.stack([stretch.course(person).places[at] for person in (0, 1)]))
    wrist = [JOINT["right_wrist"]]
    return _with_hands(stretch, at, Hold(TWIRL, 0.0), np.stack([hands[None]] * 2), wrist, [*_HIPS, *TRUNK, *wrist])


def _with_hands(
    stretch: Stretch, at: Frames, hold: Hold, places: Array, wrists: Sequence[int], joints: Sequence[int]
) -> list[KnownFrames]:
    """Joints of two people who stand or lean, with wrists at places (2, W, N, 3)."""
    parts = []
    for person in (0, 1):
        course = stretch.course(person)
        poses = bending(course.places[at], course.headings[at], hold.lean)
        right = -floor_points(leftwards(course.headings[at]))[:, None]
        poses += hold.aside * (poses[..., 1:2] - poses[:, :1, 1:2]) * right
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
    known, bodies = np.array([frame for frame, _ in poses]), np.stack([pose for _, pose in poses])
    down = np.flatnonzero(bodies[:, 0, 1] <= UPRIGHT)
    if not len(down) or down[-1] + 1 == len(known):
        return []
    first, last = max(known[down[-1]] - _HELD, known[0]), known[down[-1] + 1]
    at = stretch.shown(np.arange(first, last + 1, EVENLY) - stretch.start)
    theirs = sampled(bodies, np.interp(at + stretch.start, known, np.arange(len(known))))
    course = stretch.course(person)
    low = _STRAIGHT - theirs[:, _SHOULDERS["right"], 1]
    own = leaning(upright(course.places[at], course.headings[at]), course.headings[at], (_LEANS * low).clip(0.1, 1.2))
    apart = np.linalg.norm(own[:, _SHOULDERS["right"]] - theirs[:, _SHOULDERS["right"]], axis=1)
    for mine, their in hands:
        line = own[:, _SHOULDERS[mine]] - theirs[:, _SHOULDERS[their]]
        meet, gap = theirs[:, _SHOULDERS[their]] + line / 2, _GAP * unit(line)
        own[:, _WRIST[mine]], theirs[:, _WRIST[their]] = meet + gap, meet - gap
    near = apart < _NEAR  # they are no longer on their way
    return [
        stretch.known(person, at[near], own[near], [*TRUNK, *(_WRIST[mine] for mine, _ in hands)]),
        stretch.known(1 - person, at[near], theirs[near], [_WRIST[their] for _, their in hands]),
    ]
