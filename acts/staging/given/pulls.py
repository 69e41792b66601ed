"""A person who is pulled up by the hand, or by both: the hands of both people, while they get up."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from motion import SMPL22

from ..bodies.poses import TRUNK, bending
from ..parts import KnownFrames
from .postures import UPRIGHT, Pose
from .stretch import Stretch

Array = NDArray[np.floating]

OFTEN = 4
"""Frames between two given places of the hands."""
BEFORE = 45
"""Frames before somebody is up in which their hand is held."""
_ARM = 0.48
"""Metres from the shoulder to the wrist of an arm that pulls."""
_NEARLY = 1.15
"""Times the length of both arms between two shoulders at which the hands begin to reach for each other."""
_LEANS = np.linspace(0.1, 1.2, 12)
"""Radians by which somebody leans forward who pulls the other up: as little as gets the hands together."""
_GAP = 0.03
"""Metres from where two hands meet to each wrist."""
_SHOULDERS = {side: SMPL22.index(f"{side}_shoulder") for side in ("left", "right")}
_WRISTS = {side: SMPL22.index(f"{side}_wrist") for side in ("left", "right")}


def given_pull(puller: str, poses: Sequence[Pose], stretch: Stretch, *, both: bool) -> list[KnownFrames]:
    """The hands of both, and the trunk of the one who pulls, as the network is given them.

    Args:
        puller: "a" or "b".
        poses: of the other, as :func:`~.scene_postures.postures` gives them.
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
    for frame in range(max(down[-1] - BEFORE, known[0]), up[0] + 1, OFTEN):
        if not stretch.shows(frame - stretch.start):
            continue
        last = int(np.searchsorted(known, frame).clip(1, len(known) - 1))
        share = (frame - known[last - 1]) / (known[last] - known[last - 1])
        pose = bodies[last - 1] + share * (bodies[last] - bodies[last - 1])
        t = frame - stretch.start
        place, angle = course.places[t], float(course.headings[t])
        one, other = _leaning_to(pose, place, angle), pose.copy()
        if _gap(one, other) > _NEARLY * 2 * _ARM:
            continue  # they are still on their way
        for mine, their in hands:
            line = one[_SHOULDERS[mine]] - other[_SHOULDERS[their]]
            meet, gap = other[_SHOULDERS[their]] + line / 2, _GAP * line / np.linalg.norm(line)
            one[_WRISTS[mine]], other[_WRISTS[their]] = meet + gap, meet - gap
        frames.append(t)
        own.append(one - one[0])
        theirs.append(other - other[0])
    if not frames:
        return []
    return [
        stretch.given(person, frames, np.stack(own), [*TRUNK, *(_WRISTS[mine] for mine, _ in hands)]),
        stretch.given(1 - person, frames, np.stack(theirs), [_WRISTS[their] for _, their in hands]),
    ]


def _leaning_to(pose: Array, place: Array, angle: float) -> Array:
    """The pose (22, 3) of a person at a place (2,) who leans forward as far as to reach the hand of another pose."""
    found = bending(place, angle, float(_LEANS[0]))
    for lean in _LEANS[1:]:
        if _gap(found, pose) <= 2 * _ARM:
            break
        found = bending(place, angle, float(lean))
    return found


def _gap(one: Array, other: Array) -> float:
    """Metres between the right shoulders of two poses (22, 3)."""
    return float(np.linalg.norm(one[_SHOULDERS["right"]] - other[_SHOULDERS["right"]]))
