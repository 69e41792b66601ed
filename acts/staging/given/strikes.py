"""Blows and throws, as the network is given them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from motion import FPS, SMPL22

from ..bodies.gestures import SIDES
from ..bodies.poses import HANDS, TRUNK, standing, upright
from ..bodies.strikes import CATCHING, FIRST, Blow, Bout, Strike, blows, catching, poses, ready
from ..parts import KnownFrames
from ..told import Told
from .postures import DUCKING
from .stretch import Course, Stretch

Array = NDArray[np.floating]
_Given = tuple[int, tuple[str, ...], tuple[tuple[int, ...], Array]]
"""A person, their hands, and frames with the poses at them."""
LATE = 0.5
"""Share of a beat after which a blow comes that something else goes on until."""
WAITS = 18
"""Frames before somebody makes ready for a single blow: that is when the network has the other answer it."""
_NEARLY = 0.15
"""Metres from the distance of a blow at which it is struck."""
RESTS, EVERY = 20, 8
"""Frames from the last pose of a blow to a pose at rest, and between two of these."""


def given_blows(struck: Strike, told: Told, stretch: Stretch) -> list[KnownFrames]:
    """The trunks and arms of people who strike or throw, and the hands that catch.

    Args:
        struck: the blows of the beat.
        told: by the beat.
        stretch: the beat.
    """
    courses = [stretch.course(person) for person in (0, 1)]
    first = _first(struck, told, courses)
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
        made: list[_Given] = [(blow.person, (blow.side,), poses(struck.bout, blow.side, own, other))]
        if struck.bout is Bout.THROWS:
            if struck.up:
                made.append((blow.person, SIDES, catching(own, other, up=True)))
            else:
                made.append((1 - blow.person, SIDES, catching(other, own)))
        after |= {person: blow.frame + beside[-1] for person, _, (beside, _) in made}
        for person, sides, (beside, known) in made:
            for frame, pose in zip(beside, known, strict=True):
                if stretch.shows(blow.frame + frame):
                    given.setdefault((person, sides), {})[blow.frame + frame] = pose
    if struck.bout is Bout.THROWS and not struck.goes_on and listed:
        catcher = listed[-1].person if struck.up else 1 - listed[-1].person
        own, other = (courses[person].places for person in (catcher, 1 - catcher))
        held = stretch.shown(np.arange(after.pop(catcher) + EVERY, stretch.frames, EVERY))
        given.setdefault((catcher, SIDES), {}).update(
            {int(frame): ready(own[frame], other[frame], CATCHING) for frame in held}
        )
    return [
        stretch.given(
            person,
            list(known),
            np.stack(list(known.values())),
            [*TRUNK, *(SMPL22.index(f"{side}_wrist") for side in sides)],
        )
        for (person, sides), known in given.items()
    ] + [*_rests(struck, after, courses, stretch), *_unwarned(struck, told, listed, stretch)]


def _rests(struck: Strike, after: Mapping[int, int], courses: Sequence[Course], stretch: Stretch) -> list[KnownFrames]:
    """The bodies of people once their last blow or throw is over, where the network would strike again.

    Args:
        struck: the blows of the beat.
        after: the last frame that is given of each person.
        courses: of the two people.
        stretch: the beat.
    """
    if struck.goes_on:
        return []
    found = []
    for person in {"ab".index(who) for who in struck.turns} & after.keys():
        frames = stretch.shown(np.arange(after[person] + RESTS, stretch.frames, EVERY))
        course = courses[person]
        poses = [
            standing(course.places[frame], float(course.headings[frame]), np.array([frame / FPS]), seed=person)
            for frame in frames
        ]
        if poses:
            still = np.concatenate(poses)
            found.append(stretch.given(person, frames, still - still[:, :1], [*TRUNK, *HANDS]))
    return found


def _is_single(struck: Strike) -> bool:
    """True for blows of one person with the hand, who does not go on."""
    by_hand = struck.bout in (Bout.FISTS, Bout.SLAPS)
    return by_hand and not struck.goes_on and len(set(struck.turns)) == 1


def _unwarned(struck: Strike, told: Told, listed: Sequence[Blow], stretch: Stretch) -> list[KnownFrames]:
    """The arms of a person who is hit, which hang up to the blow: the network raises them to a guard before it.

    Who is slapped keeps them down, and reaches for the other's hand no more.
    """
    if not _is_single(struck) or not listed:
        return []
    person = 1 - listed[-1].person
    if "ab"[person] in {*told.gestures, *told.changes, *told.limbs}:
        return []
    stop = stretch.frames if struck.bout is Bout.SLAPS else listed[-1].frame + 1
    frames = stretch.shown(np.arange(RESTS if stretch.start else 0, stop, EVERY))
    if not len(frames):
        return []
    course = stretch.course(person)
    poses = np.stack([upright(course.places[t], float(course.headings[t])) for t in frames])
    return [stretch.given(person, frames, poses - poses[:, :1], HANDS)]


def _first(struck: Strike, told: Told, courses: Sequence[Course]) -> int:
    """The frame of the beat at which the two are near, or so long before the first blow that it meets its answer."""
    apart, frames = np.linalg.norm(courses[0].places - courses[1].places, axis=1), len(courses[0].places)
    there = np.flatnonzero(np.abs(apart - struck.bout.value) < _NEARLY)
    near = int(there[0]) if len(there) else 0
    if not struck.answered:
        near = max(near, WAITS) if _is_single(struck) and frames > 4 * WAITS else near
        return max(near, round(LATE * frames)) if struck.late else near
    change = next(iter(told.changes.get("b" if struck.turns[0] == "a" else "a", ())), None)
    at = round((0.35 if change is None else change.after) * frames)
    if change is not None and change.passing:  # the fist goes over them
        at = min(at + DUCKING + (frames - at) // 4, frames - DUCKING)
    return max(at - FIRST, near - FIRST // 2)
