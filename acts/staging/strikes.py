"""Blows and throws: people who fight, with or without weapons, play with rackets, or throw each other a ball.

The network throws punches at the distance of its training scenes, most of which miss by half a metre, and only one of
the two strikes; rackets and balls it does not know. So the two are kept at the distance that they need, and the arms
are given at the moments of their blows, in turn. The rest is the network's.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from motion.skeleton import SIDES
from motion.transforms import heading_matrix
from motion.vectors import Array, bearing, floor_points

from .gestures import Place
from .places import Course
from .poses import BOTH_SIDES, HANDS, JOINT, TRUNK, bending
from .postures import DUCKING
from .score import Score, Strike
from .window import KnownFrames, Stretch

_Given = dict[tuple[int, tuple[str, ...]], tuple[tuple[int, ...], Array]]
"""Frames with the poses at them, by person and their hands."""


@dataclass(frozen=True)
class Bout:
    """A kind of blows or throws.

    Attributes:
        apart: metres between the pelvises of the two.
        period: frames from one blow to the next.
        drawn: metres from the pelvis to the left wrist before a blow.
        landed: the same as it lands; None on the other's head.
        circling: turns a second of the two around the middle between them.
    """

    apart: float
    period: int
    drawn: Place
    landed: Place | None = None
    circling: float = 0.0


BOUTS: Mapping[str, Bout] = {
    "fists": Bout(0.75, 22, drawn=(0.14, 0.4, 0.14), circling=0.03),
    "slaps": Bout(0.65, 24, drawn=(0.5, 0.5, 0.08)),
    "weapons": Bout(1.3, 26, drawn=(0.12, 0.78, 0.02), landed=(0.02, 0.4, 0.5), circling=0.03),
    "rackets": Bout(3.0, 36, drawn=(0.45, 0.3, -0.1), landed=(-0.05, 0.4, 0.45)),
    "throws": Bout(2.2, 48, drawn=(0.22, 0.68, -0.12), landed=(0.05, 0.5, 0.48)),
}
"""The kinds by their names in the lexicon."""


@dataclass(frozen=True)
class Blow:
    """One blow or throw: the frame of the beat at which it lands, who strikes, and the hand."""

    frame: int
    person: int
    side: str


FIRST = 20
"""Frames before the first blow."""
_DRAWN = 5
"""Frames before a blow in which the arm is drawn back."""
_FLIGHT = 16
"""Frames for which what was thrown is in the air."""
_READY = np.array([0.12, 0.2, 0.28])
"""Metres from the pelvis to the left wrist between two blows."""
_RECOVERS = 11
"""Frames after a blow in which the arm is ready again."""
CATCHING = np.array([0.12, 0.35, 0.4])
"""Metres from the pelvis to the left wrist of hands that catch."""
_TWIST, _LEAN = 0.4, 0.12
"""Radians by which the shoulder goes ahead with the fist, and by which the trunk leans forward."""
_ARM = 0.5
"""Metres from the shoulder to the wrist of an arm that strikes."""
_FIST = 0.1
"""Metres from the wrist to what its fist hits."""
_CHEEK = np.array([0.11, 0.0, 0.05])
"""Metres from the other's head to the left wrist of a flat hand on the cheek: aside, up, and back to the shoulder."""
LATE = 0.5
"""Share of a beat after which a blow comes that something else goes on until."""
_NEARLY = 0.15
"""Metres from the distance of a blow at which it is struck."""
RESTS, EVERY = 20, 8
"""Frames from the last pose of a blow to a pose at rest, and between two of these."""


def blows(struck: Strike, frames: int, *, first: int) -> list[Blow]:
    """The blows of a beat of so many frames, from its ``first`` frame at which the two are at their distance."""
    period = BOUTS[struck.bout].period * (1 if len(set(struck.turns)) > 1 or struck.hands else 2)
    if struck.bout == "throws" and not struck.goes_on:  # each in its own share of the beat
        period = max(period, frames // len(struck.turns))
    last = frames - (_FLIGHT + 6 if struck.bout == "throws" else _DRAWN)
    at = range(first + FIRST, last, period)
    made = [
        Blow(frame, "ab".index(struck.turns[i % len(struck.turns)]), _hand(struck, i)) for i, frame in enumerate(at)
    ]
    return made if struck.goes_on else made[: len(struck.turns)]


def _hand(struck: Strike, number: int) -> str:
    """The hand that the words name; else fists take turns; weapons, rackets and balls are in the right hand."""
    if (named := "".join(struck.hands[number : number + 1])) in ("left", "right"):
        return named
    left = struck.bout == "fists" and number // len(struck.turns) % 2
    return "left" if left else "right"


def poses(bout: str, side: str, place: Array, other: Array) -> tuple[tuple[int, ...], Array]:
    """A blow or throw as frames beside the one at which it lands, and poses of the one who strikes.

    Args:
        bout: of :data:`BOUTS`.
        side: "left" or "right".
        place: (2,) x and z of the one who strikes, in metres.
        other: (2,) of the other.

    Returns:
        N frames, and (N, 22, 3) metres, of which only the trunk and the wrist of that side are meant.
    """
    line = np.asarray(other) - place
    angle, sign = bearing(line), 1.0 if side == "left" else -1.0
    wrist, turn = JOINT[f"{side}_wrist"], heading_matrix(angle)
    back, ahead = BOUTS[bout].drawn, BOUTS[bout].landed
    drawn = bending(place, angle + sign * _TWIST / 2, _LEAN)
    drawn[wrist] = drawn[0] + turn @ (np.array(back) * [sign, 1.0, 1.0])
    landed = bending(place, angle - sign * _TWIST, _LEAN)
    if ahead is None:
        pose = bending(np.asarray(other), angle + np.pi, _LEAN)
        head = pose[JOINT["head"]] + landed[0] - pose[0] + floor_points(line)
        if bout == "slaps":
            head = head + turn @ (_CHEEK * [sign, 1.0, -1.0])
        shoulder = landed[JOINT[f"{side}_shoulder"]]
        length = float(np.linalg.norm(head - shoulder))
        near = 0.0 if bout == "slaps" else _FIST
        landed[wrist] = shoulder + (head - shoulder) * min(_ARM, length - near) / length
    else:
        landed[wrist] = landed[0] + turn @ (np.array(ahead) * [sign, 1.0, 1.0])
    after = drawn if ahead is None else ready(place, other)
    return (-_DRAWN, -1, 1, _RECOVERS), np.stack([drawn, landed, landed, after])


def ready(place: Array, other: Array, reach: Array = _READY) -> Array:
    """A pose (22, 3) of a person with both hands ready, towards the other; places as above."""
    angle = bearing(np.asarray(other) - place)
    pose = bending(place, angle, _LEAN)
    for side, sign in BOTH_SIDES:
        pose[JOINT[f"{side}_wrist"]] = pose[0] + heading_matrix(angle) @ (reach * [sign, 1.0, 1.0])
    return pose


def catching(place: Array, other: Array, *, up: bool = False) -> tuple[tuple[int, ...], Array]:
    """Both hands that catch what is thrown, or thrown up, as :func:`poses` from the frame at which it is thrown."""
    flight = 2 * _FLIGHT if up else _FLIGHT
    return (flight - 6, flight, flight + 6), np.stack([ready(place, other, CATCHING)] * 3)


def strike_parts(struck: Strike, score: Score, stretch: Stretch) -> list[KnownFrames]:
    """The trunks and arms of people who strike or throw, and the hands that catch.

    Args:
        struck: the blows of the beat.
        score: of the beat.
        stretch: the beat.
    """
    courses = [stretch.course(person) for person in (0, 1)]
    first = _first(struck, score, courses)
    given: dict[tuple[int, tuple[str, ...]], dict[int, Array]] = {}
    if not stretch.start:
        for person in {"ab".index(who) for who in struck.turns}:
            pose = ready(*(courses[i].places[0] for i in (person, 1 - person)))
            if stretch.shows(0):
                given[(person, SIDES)] = {0: pose}
    after: dict[int, int] = {}
    listed = blows(struck, stretch.frames, first=first)
    for blow in listed:
        places = [course.places[blow.frame] for course in courses]
        own, other = places[blow.person], places[1 - blow.person]
        made: _Given = {(blow.person, (blow.side,)): poses(struck.bout, blow.side, own, other)}
        if struck.up:
            made[blow.person, SIDES] = catching(own, other, up=True)
        elif struck.bout == "throws":
            made[1 - blow.person, SIDES] = catching(other, own)
        after |= {person: blow.frame + beside[-1] for (person, _), (beside, _) in made.items()}
        for whose, (beside, known) in made.items():
            at = [(blow.frame + frame, pose) for frame, pose in zip(beside, known, strict=True)]
            given.setdefault(whose, {}).update((frame, pose) for frame, pose in at if stretch.shows(frame))
    if struck.bout == "throws" and not struck.goes_on and listed:
        catcher = listed[-1].person if struck.up else 1 - listed[-1].person
        own, other = (courses[person].places for person in (catcher, 1 - catcher))
        held = stretch.shown(np.arange(after.pop(catcher) + EVERY, stretch.frames, EVERY))
        given.setdefault((catcher, SIDES), {}).update(
            {int(frame): ready(own[frame], other[frame], CATCHING) for frame in held}
        )
    return [
        stretch.known(
            person, list(known), np.stack(list(known.values())), [*TRUNK, *(JOINT[f"{side}_wrist"] for side in sides)]
        )
        for (person, sides), known in given.items()
        if known
    ] + _rests(struck, after, stretch)


def _rests(struck: Strike, after: Mapping[int, int], stretch: Stretch) -> list[KnownFrames]:
    """The bodies of people once their last blow or throw is over, where the network would strike again.

    Args:
        struck: the blows of the beat.
        after: the last frame that is given of each person.
        stretch: the beat.
    """
    parts: list[KnownFrames] = []
    for person in () if struck.goes_on else after:
        frames = stretch.shown(np.arange(after[person] + RESTS, stretch.frames, EVERY))
        parts.append(stretch.still(person, frames, [*TRUNK, *HANDS]))
    return parts


def _first(struck: Strike, score: Score, courses: Sequence[Course]) -> int:
    """The frame of the beat at which the two are near, or so long before the first blow that it meets its answer."""
    apart, frames = np.linalg.norm(courses[0].places - courses[1].places, axis=1), len(courses[0].places)
    there = np.flatnonzero(np.abs(apart - BOUTS[struck.bout].apart) < _NEARLY)
    near = int(there[0]) if len(there) else 0
    if not struck.answered:
        return max(near, round(LATE * frames)) if struck.late else near
    change = next(iter(score.changes.get("b" if struck.turns[0] == "a" else "a", ())), None)
    at = round((0.35 if change is None else change.after) * frames)
    if change is not None and change.passing:  # the fist goes over them
        at = min(at + DUCKING + (frames - at) // 4, frames - DUCKING)
    return max(at - FIRST, near - FIRST // 2)
