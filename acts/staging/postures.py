"""Postures: people who sit, kneel, crouch or lie down in a story and stay so until they get up.

A network that was trained on people who sit down and get up again does not leave them seated. Their pelvis and legs are
given, and the trunk and head of those who lie or bend down.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from functools import lru_cache

import numpy as np
import scipy  # its parts are loaded with their first use

from motion import FPS
from motion.skeleton import TOES
from motion.smoothing import minimum_jerk
from motion.transforms import heading
from motion.vectors import Array, direction

from .figure_floor import grounded_poses
from .places import EVENLY, HALT, Standing
from .poses import ALL, HANDS, JOINT, LOWER, STANCE, UPRIGHT, Pose, all_but, angles_of, placed, posed, upright
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
_DROPS = 1.7
"""Exponent of the time of a fall, which begins slowly."""
_LYING = 0.6
"""Metres from where somebody stood to the pelvis when they lie."""
_HEAD = JOINT["head"]
_RISES: Mapping[str, Sequence[tuple[float, str]]] = {
    "lies": ((0.45, "sits up"), (0.75, "crouches")),
    "sits on the ground": ((0.25, "sits up"), (0.6, "crouches")),
}
"""Postures from which people sit up and get their feet under them before they stand: shares of the time, and poses."""


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
        now, own = "stands", [Change(posture=now), *own]
    if now == "stands" and not own:
        return [(start, upright(*_place(person, stand, None)))] if last is None and score.changes else []
    place, angle = _place(person, stand, last)
    if last is None and now == "lies":  # across the other's way, and not with the feet towards them
        angle += math.pi / 2
        place = place + _LYING * direction(angle)
    poses: dict[int, Array] = {}
    begins = start + 1 if last is not None else start
    pose = posed(now, place, angle) if last is None or now == "stands" else last
    for change in own:
        at = start + round(change.after * (stop - start))
        if last is None and now != "stands":
            at = max(at, start + round(FPS))  # they are seen as they were
        if now != "stands" or (last is None and begins == start):
            poses |= _stays(pose, begins, at + 1)
        goals = [(min(at + _frames(now, change), stop - 1), change.posture)]
        if change.passing:
            middle = min(at + DUCKING + (stop - at) // 4, stop - DUCKING)
            goals = [(middle, change.posture), (middle + DUCKING, "stands")]
        for ends, then in goals:
            falls = now == "stands" and then == "lies" and not change.gently
            way = placed(changing(now, then, max(ends - at, 1), falls=falls), place, angle)
            way += np.linspace(1, 0, len(way))[:, None, None] * (pose - way[0])
            poses |= {at + i: way[i] for i in {*range(0, len(way), EVENLY), len(way) - 1}}
            now, pose, at = then, way[-1], ends
        begins = at
    poses |= _stays(pose, begins, stop)
    return [(frame, poses[frame]) for frame in sorted(poses) if start <= frame < stop]


def _frames(now: str, change: Change) -> int:
    """The frames in which somebody in one posture changes to another."""
    if change.posture == "stands":
        return RISING if now in _RISES else GETS_DOWN
    if not change.gently:
        return GETS_DOWN
    return LYING_DOWN if change.posture == "lies" else RISING


@lru_cache(maxsize=64)
def changing(first: str, last: str, frames: int, *, falls: bool = False) -> Array:
    """The way from one posture to another: poses (frames + 1, 22, 3) of a person who stood at the origin, facing +Z.

    Who ``falls`` gets faster and faster.
    """
    up = _RISES.get(first, ()) if last == "stands" else ()
    down = [(1 - at, pose) for at, pose in reversed(_RISES.get(last, ()))] if first == "stands" else []
    times, names = zip(*((0.0, first), *up, *down, (1.0, last)), strict=True)
    time: Array = np.linspace(0, 1, frames + 1)
    share: Array = time**_DROPS if falls else minimum_jerk(time)
    rows = np.stack([angles_of({"pose": name}) for name in names])
    poses = grounded_poses(scipy.interpolate.PchipInterpolator(times, rows)(share), np.zeros(2), 0.0)
    begins, ends = (posed(name, np.zeros(2), 0.0)[0] - poses[at, 0] for name, at in ((first, 0), (last, -1)))
    return np.asarray(poses + ((1 - share)[:, None] * begins + share[:, None] * ends)[:, None])


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
