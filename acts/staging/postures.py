"""Postures: people who sit, kneel, crouch or lie down in a story and stay so until they get up.

A network that was trained on people who sit down and get up again does not leave them seated. Their pelvis and legs are
given, and the trunk and head of those who lie or bend down.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import pairwise

import numpy as np

from motion import FPS
from motion.skeleton import TOES
from motion.smoothing import minimum_jerk
from motion.transforms import heading
from motion.vectors import Array, direction

from .places import EVENLY, HALT, Standing
from .poses import (
    ALL,
    HANDS,
    JOINT,
    LOWER,
    LYING,
    STANCE,
    UPRIGHT,
    Pose,
    all_but,
    crouching,
    grounded,
    kneeling,
    lying,
    rising,
    seated,
    stooping,
    upright,
)
from .recordings import on_all_fours
from .score import Change, Score, at_start
from .window import GETS_DOWN, Part, Stretch

RISING = 54
"""Frames in which somebody gets up from the ground."""
LYING_DOWN = 84
"""Frames in which somebody lies down who does not fall, where there is time (recorded: 2.5 to 3.5 s)."""
DUCKING = 16
"""Frames in which somebody ducks, and as many in which they are up again."""
LOW = 0.5
"""Metres of the head over the pelvis below which somebody lies or is bent."""
_DROPS = 0.6
"""Exponent of the time of a fall, which begins slowly."""
_HEAD = JOINT["head"]
_LOW = ("lies", "sits on the ground")
"""Postures from which people sit up and get their feet under them before they stand."""
_MAKES: Mapping[str, Callable[[Array, float], Array]] = {
    "stands": upright,
    "sits": seated,
    "sits on the ground": grounded,
    "kneels": kneeling,
    "crouches": crouching,
    "bends down": stooping,
    "lies": lying,
    "on all fours": on_all_fours,
}


def postures(
    scores: Sequence[Score], beat: int, person: int, start: int, stop: int, stand: Standing, last: Array | None
) -> list[Pose]:
    """The poses by which a person's posture is held in a beat; none where the words leave them on their feet.

    Args:
        scores: of all beats.
        beat: which one.
        person: 0 for a, 1 for b.
        start, stop: the beat's first frame and the one after its last.
        stand: where the people are when it begins.
        last: the person's pose (22, 3) before it; None in a first beat.
    """
    who, score = "ab"[person], scores[beat]
    now = at_start(scores, beat)[who]
    own = [change for change in score.changes.get(who, ()) if not change.already]
    if last is not None and now != "stands" and last[0, 1] > UPRIGHT:  # as in a given motion
        now, own = "stands", [Change.model_validate({"posture": now}), *own]
    if now == "stands" and not own:
        return [(start, upright(*_place(person, stand, None)))] if last is None and score.changes else []
    place, angle = _place(person, stand, last)
    if last is None and now == "lies":  # across the other's way, and not with the feet towards them
        angle += math.pi / 2
        place = place + LYING * direction(angle)
    poses: dict[int, Array] = {}
    begins = start + 1 if last is not None else start
    pose = _MAKES[now](place, angle) if last is None or now == "stands" else last
    for change in own:
        at = start + round(change.after * (stop - start))
        if last is None and now != "stands":
            at = max(at, start + round(FPS))  # they are seen as they were
        if now != "stands" or (last is None and begins == start):
            poses |= _stays(pose, begins, at + 1)
        if change.passing:
            middle = min(at + DUCKING + (stop - at) // 4, stop - DUCKING)
            poses |= {middle: _MAKES[change.posture](place, angle), middle + DUCKING: upright(place, angle)}
            begins = middle + DUCKING
            continue
        ends, on_the_way = _on_the_way(now, change, at, stop, place, angle)
        poses |= on_the_way
        now, pose, begins = change.posture, _MAKES[change.posture](place, angle), ends
    poses |= _stays(pose, begins, stop)
    listed = [(frame, poses[frame]) for frame in sorted(poses) if start <= frame < stop]
    return sorted([*listed, *_in_between(listed)], key=lambda pose: pose[0])


def _in_between(poses: Sequence[Pose]) -> Iterator[Pose]:
    """Poses on the way down, up and from one low pose to another, on which the network would rise or sink at will."""
    for (first, pose), (last, then) in pairwise(poses):
        if min(pose[0, 1], then[0, 1]) <= UPRIGHT:
            for frame in range(first + EVENLY, last, EVENLY):
                yield frame, pose + float(minimum_jerk((frame - first) / (last - first))) * (then - pose)


def _on_the_way(
    now: str, change: Change, at: int, stop: int, place: Array, angle: float
) -> tuple[int, dict[int, Array]]:
    """The frame at which a change of posture is over that begins ``at`` one, and the poses on the way."""
    lies = "lies" in (now, change.posture)
    if now in _LOW and change.posture == "stands":
        ends = min(at + RISING, stop - 1)
        return ends, {at + round(share * (ends - at)): pose for share, pose in rising(place, angle, lies=lies)}
    ends = min(at + GETS_DOWN, stop - 1)
    if {now, change.posture} == {"bends down", "stands"}:
        shares = minimum_jerk(np.arange(EVENLY, ends - at, EVENLY) / (ends - at))
        down = shares if change.posture == "bends down" else 1 - shares
        return ends, {at + EVENLY * (i + 1): stooping(place, angle, float(share)) for i, share in enumerate(down)}
    falls = lies and not change.gently
    if now != "stands" or change.posture not in _LOW or not (change.gently or falls):
        return ends, {}
    ends = min(at + (GETS_DOWN if falls else LYING_DOWN if lies else RISING), stop - 1)
    pace = _DROPS if falls else 1.0
    on_the_way = reversed(rising(place, angle, lies=lies))
    return ends, {at + round((1 - share) ** pace * (ends - at)): pose for share, pose in on_the_way}


def posture_parts(poses: list[Pose], person: int, score: Score, stretch: Stretch, tail: int) -> list[Part]:
    """The parts of a person's posture, as far as they fall into a window and the ``tail`` frames behind it.

    Args:
        poses: as :func:`postures` gives them.
        person: 0 for a, 1 for b.
        score: of the beat.
        stretch: the beat.
        tail: frames that are made behind the window and thrown away.
    """
    who, window = "ab"[person], stretch.window
    busy = who in score.gestures or (score.touch is not None and score.touch.person == who)
    if tail and poses and poses[-1][0] == stretch.stop - 1 and poses[-1][1][0, 1] <= UPRIGHT:
        poses += sorted(_stays(poses[-1][1], stretch.stop, stretch.stop + tail).items())  # or the trunk sinks in
    return [
        stretch.known(person, np.asarray(frames) - stretch.start, known, joints)
        for joints, frames, known in posture_joints(poses, window.start, window.stop + tail, arms=not busy)
    ]


def posture_joints(
    poses: list[Pose], first: int, last: int, *, arms: bool = False
) -> Iterator[tuple[Sequence[int], list[int], Array]]:
    """The joints, frames and poses (N, 22, 3) from ``first`` to before ``last`` that are given.

    Pelvis and legs, and the trunk and head of those who lie or bend down, which the network would raise, with their
    ``arms`` or without.
    """
    for low, joints in ((False, LOWER), (True, ALL if arms else all_but(HANDS))):
        inside = [(frame, pose) for frame, pose in poses if bool(pose[_HEAD, 1] - pose[0, 1] < LOW) is low]
        inside = [(frame, pose) for frame, pose in inside if first <= frame < last]
        if inside:
            yield joints, [frame for frame, _ in inside], np.stack([pose for _, pose in inside])


def _stays(pose: Array, start: int, stop: int) -> dict[int, Array]:
    return dict.fromkeys({*range(start, stop, EVENLY), max(start, stop - 1)}, pose)


def _place(person: int, stand: Standing, last: Array | None) -> tuple[Array, float]:
    """The place (x, z) and heading of a standing person, or of a person who is down once they get up."""
    if last is None:
        return np.asarray(stand.places[person], dtype=float), float(stand.headings[person])
    pose = np.asarray(last, dtype=float)
    angle = float(heading(pose[None])[0])
    if pose[0, 1] > UPRIGHT:
        return np.asarray(stand.places[person] + HALT * stand.speeds[person], dtype=float), angle
    toes = pose[TOES].mean(axis=0)[[0, 2]]
    return toes - STANCE * direction(angle), angle
