"""Figures: what a body does key by key, such as a push-up, a kick, a raised leg or a nod, and its course over a beat.

No caption of the training data names them. ``figures.toml`` has them as poses (:mod:`.poses`) and the seconds from one
to the next; :mod:`.figure_floor` puts the body on the floor. Those of limbs go together,
and what they do not move is as it is of people who wait.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from typing import Any, Final, NamedTuple

import numpy as np
import scipy  # its parts are loaded with their first use
from numpy.typing import NDArray

from acts.shapes import Figure
from motion import FPS
from motion.kinematics import swing
from motion.skeleton import ARMS
from motion.smoothing import minimum_jerk
from motion.transforms import heading, heading_matrix
from motion.vectors import Array

from .figure_floor import grounded_poses
from .places import Way2D
from .poses import ALL, FILE, HANDS, JOINT, LOWER, NAMES, PAIRED, TRUNK, UPRIGHT, Pose, all_but, angles_of
from .postures import RISING, posture_joints, postures
from .recordings import LEGS, has_takes, performing, standing_by
from .score import Change, Score
from .window import OFTEN, SETTLES, Part, Stretch, late_by

_ASIDE = tuple(NAMES.index(name) for name in ("roll", "yaw", "lean", "twist", "tilt", "look", "aside"))
"""Those that change their sign in a mirror."""
_LEFT, _RIGHT = (
    slice(start, start + len(PAIRED)) for start in (len(NAMES) - 2 * len(PAIRED), len(NAMES) - len(PAIRED))
)
_OF_HEAD, _OF_ARMS = frozenset(("neck", "tilt", "look")), frozenset(("arm", "side", "rotate", "elbow"))
BEGINS, RESTS = 0.3, 0.15
"""Seconds of a beat before a figure begins, and after it."""
FASTEST, SLOWEST = 0.75, 1.25
"""Shares of their own seconds in which figures are done to fit into a beat."""
_EASES = 0.5
"""Seconds in which a person who stands by begins and ends one."""
_ROUND = 2.0
"""Frames over which the angles are rounded at a pose (the width of a Gaussian)."""
DOWN = 0.35
"""Height in metres of the pelvis of a person on the ground, who has to get up before a figure."""
_UPPER = (JOINT["pelvis"], *TRUNK)
DANCES: Final = "dances"
"""The figure that the network may dance as it likes, if not in time with another."""
JUMPS: Final = "jumps"
"""The figure of which only the legs are given."""
SHORTEST = 20
"""Frames for which a figure is begun, at least."""
_SEEN = 6
"""Frames between two poses of a figure that are looked at for the room that it needs."""
_DEEP = 0.08
"""Metres by which the pelvis may rise as a person who is down begins a figure."""
_HOLDS, _WAITS = 0.5, {"in": 0.2}
"""Seconds for which a limb is held, over and over, and the row of what comes before it and after it."""
LIMBS = frozenset(FILE["limbs"])
"""Movements of limbs, trunk or head, which leave the rest of the body as it is."""
_HELD = frozenset(name for name, rows in FILE["limbs"].items() if len(rows) == 1)


class Keys(NamedTuple):
    """A figure as it stands in the file: seconds from the pose before (N,) and angles (N, angles) in radians.

    Attributes:
        into: what is done once, from standing.
        again: what is then done over and over; empty for nothing.
        out: what leads back to standing.
    """

    into: tuple[Array, Array]
    again: tuple[Array, Array]
    out: tuple[Array, Array]


@lru_cache(maxsize=1)
def figures() -> Mapping[str, Keys]:
    """All figures by name."""
    rows = {name: [parts.get(part, ()) for part in ("into", "again", "out")] for name, parts in FILE["figures"].items()}
    for name, listed in FILE["limbs"].items():
        first, back = listed[0], {"in": listed[0]["in"]}
        held = [[_WAITS, first], [first | {"in": _HOLDS}], [back, _WAITS]]
        rows[name] = held if name in _HELD else [[], listed, [back]]
    return {name: Keys(*(_keys(part) for part in parts)) for name, parts in rows.items()}


def figured(listed: Sequence[Figure], place: Array, angle: float, frames: int) -> Array:
    """A person who does figures through a beat of so many frames, at the same time.

    Args:
        listed: which. Of what several move, the one that moves it the farthest counts, to either side.
        place: (2,) x and z of the pelvis in metres where they stand before.
        angle: heading in radians from +Z towards +X.
        frames: of the beat.

    Returns:
        (frames, 22, 3) metres; the body is on the floor, and what stands on it does not glide.
    """
    moved = np.stack([_course(figure, frames) - _STANDS for figure in listed])
    course = _STANDS + moved.max(axis=0).clip(min=0) + moved.min(axis=0).clip(max=0)
    return grounded_poses(course, place, angle)


def _course(figure: Figure, frames: int) -> Array:
    """The angles (frames, angles) of a figure through a beat."""
    times, rows = _scheduled(figure, frames / FPS)
    between = scipy.interpolate.PchipInterpolator(times, _mirrored(rows) if figure.mirrored else rows, axis=0)
    course = between(np.clip(np.arange(frames) / FPS, times[0], times[-1]))
    return np.asarray(scipy.ndimage.gaussian_filter1d(course, _ROUND, axis=0, mode="nearest"))


def _moved(listed: Sequence[Figure]) -> set[str]:
    """The names of what figures move."""
    rows = np.concatenate([_STANDS, *(rows for figure in listed for _, rows in figures()[figure.figure])])
    return {name.split("_")[-1] for name, moves in zip(NAMES, np.ptp(rows, axis=0) > 0, strict=True) if moves}


def has_side(name: str) -> bool:
    """True for a movement of limbs that one side does, or first: a raised leg, and no nod."""
    return name in LIMBS and any((rows[:, _LEFT] != rows[:, _RIGHT]).any() for _, rows in figures()[name])


def _scheduled(figure: Figure, length: float) -> tuple[Array, Array]:
    """Seconds (N,) of a beat and the angles (N, angles) at them, beginning and ending with standing."""
    course, times, late = figures()[figure.figure], figure.times, min(figure.late, length / 4)
    if times and figure.figure in _HELD:  # up and back so many times
        steps, rows = (np.concatenate(each) for each in zip(*course, strict=True))
        course = Keys(_keys(()), (steps, rows), _keys(()))
    room = max(length - late - BEGINS - RESTS, 0.1)
    cycle = float(course.again[0].sum())
    frame = float(course.into[0].sum() + course.out[0].sum())
    reps = 0
    if cycle:
        fits = int((room / FASTEST - frame) / cycle)
        reps = min(times or max(round((room - frame) / cycle), 1), max(fits, 1))
    parts = [course.into, *[course.again] * reps, course.out]
    steps, rows = (np.concatenate([part[i] for part in parts]) for i in (0, 1))
    pace = room / float(steps.sum())
    if pace < FASTEST:
        steps, rows = _cut(steps, rows, room)
        pace = 1.0
    at = late + BEGINS + np.cumsum(np.concatenate([[0.0], steps * min(pace, SLOWEST)]))
    return np.concatenate([[0.0], at + 1e-3]), np.concatenate([_STANDS, _STANDS, rows])


def _cut(steps: Array, rows: Array, room: float) -> tuple[Array, Array]:
    """The beginning of a figure for which there is no time, and the same way back."""
    fits = int(np.searchsorted(np.cumsum(2 * FASTEST * steps), room, side="right"))
    if not fits:
        return np.array([room]), _STANDS
    steps, rows = FASTEST * steps[:fits], rows[:fits]
    back = np.concatenate([rows[-2::-1], _STANDS])
    return np.concatenate([steps, steps[::-1]]), np.concatenate([rows, back])


def _keys(rows: Sequence[Mapping[str, Any]]) -> tuple[Array, Array]:
    """Seconds (N,) and angles (N, angles) of a part of a figure."""
    angles = [angles_of(row) for row in rows]
    return np.array([float(row["in"]) for row in rows]), np.array(angles).reshape(-1, len(NAMES))


_STANDS = angles_of({})[None]


def _mirrored(rows: Array) -> Array:
    """Angles (N, angles) with left and right exchanged."""
    mirrored = np.concatenate([rows[:, : _LEFT.start], rows[:, _RIGHT], rows[:, _LEFT]], axis=1)
    mirrored[:, _ASIDE] *= -1.0
    return mirrored


def figure_parts(scores: Sequence[Score], person: int, beat: Stretch, last: Array | None, seed: int) -> list[Part]:
    """The body of a person who does a figure, as far as it falls into a window; a person on the ground gets up first.

    Args:
        scores: of all beats.
        person: 0 for a, 1 for b.
        beat: the beat.
        last: (22, 3) the person before it; None in a first beat.
        seed: draws how late they are.
    """
    parts: list[Part] = []
    first = SETTLES // 2 if beat.start else 0
    if last is not None and last[0, 1] <= DOWN:
        first = min(RISING, beat.frames)
        rising = _getting_up(scores, person, beat, last)
        for joints, rises, known in posture_joints(rising, beat.window.start, beat.window.stop):
            parts.append(beat.known(person, np.asarray(rises) - beat.start, known, joints))
    who, score = "ab"[person], scores[beat.window.beat]
    frames, poses = _figure(score, person, beat, first, seed)
    high = poses[:, 0, 1]
    if last is not None and DOWN < last[0, 1] <= UPRIGHT and len(poses) and high.min() <= UPRIGHT:
        begins = int(np.argmax(high <= max(float(last[0, 1]), high.min()) + _DEEP))  # they do not get up before it
        frames, poses = _figure(score, person, beat, 2 * first - int(frames[begins]), seed)
        frames, poses = frames[frames >= first], poses[frames >= first]
    shown = np.isin(frames, beat.shown(frames))
    listed, at, poses = score.bodily(who), frames[shown], poses[shown]
    figure, taken = listed[0], has_takes(listed[0].figure)
    moved = set(_OF_HEAD) if taken else _moved(listed)
    busy = figure.meets or who in score.gestures or score.touch is not None
    body, bows = all_but(HANDS) if busy and not moved & _OF_ARMS else ALL, figure.figure.startswith("bows")
    if bows:  # the network has the legs
        body = [joint for joint in body if joint == JOINT["pelvis"] or joint not in LEGS]
    if not taken and moved <= _OF_HEAD:  # the trunk is held, and the limbs are a draft
        rest = beat.draft(person, at, poses, [joint for joint in body if joint not in _UPPER])
        return [*parts, beat.known(person, at, poses, _UPPER, kept=True), rest]
    part = beat.known(person, at, poses, LOWER if figure.figure == JUMPS else body, kept=not bows)
    if figure.in_time or figure.figure != DANCES:
        return [*parts, part]
    way = Way2D(person, at.tolist(), poses[:, 0][:, [0, 2]], heading(poses))
    return [*parts, *beat.known_way(way), replace(part, kept=False, soft=True, free=True)]


def figure_poses(score: Score, person: int, beat: Stretch, seed: int) -> list[Pose]:
    """Some poses of a figure, with their frames of the scene, that show the room it needs."""
    frames, poses = _figure(score, person, beat, 0, seed)
    return [(int(frame) + beat.start, pose) for frame, pose in zip(frames, poses, strict=True)][:: _SEEN // OFTEN]


def _figure(score: Score, person: int, beat: Stretch, first: int, seed: int) -> tuple[NDArray[np.integer], Array]:
    """Frames (N,) of a beat and the poses (N, 22, 3) of a figure that begins with its ``first`` frame, or later."""
    listed, angle = list(score.bodily("ab"[person])), float(beat.stand.headings[person])
    together = any(figure.meets or figure.in_time for figure in listed)
    late = 0.0 if together else late_by(seed, person, beat.frames)
    count = beat.frames - first
    if count < SHORTEST:
        return np.zeros(0, dtype=int), np.zeros((0, len(ALL), 3))
    listed = [figure.model_copy(update={"late": figure.late + late}) for figure in listed]
    if has_takes(listed[0].figure):
        own = seed if together else 2 * seed + person
        poses = performing(listed[0], beat.halt(person), angle, count, own)
    else:
        poses = _rested(figured(listed, beat.halt(person), angle, count), listed, first + beat.start, 2 * seed + person)
    frames = np.union1d(np.arange(0, count, OFTEN), [count - 1])
    return frames + first, poses[frames]


def _rested(poses: Array, listed: Sequence[Figure], start: int, seed: int) -> Array:
    """Figures (T, 22, 3) from a frame of the scene on, with the person standing by before and after them.

    Arms, or all but the head, stand by as well where no figure moves them; a person who reaches down keeps theirs.
    """
    moved = _moved(listed)
    if listed[0].figure in LIMBS and moved & _OF_ARMS:
        return poses
    seconds, frames = np.arange(len(poses)) / FPS, np.arange(len(poses)) + start
    times = [_scheduled(figure, len(poses) / FPS)[0] for figure in listed]
    begins, ends = min(each[1] for each in times), max(each[-1] for each in times)
    share = minimum_jerk((seconds - begins + BEGINS) / _EASES) * minimum_jerk((ends + _EASES - seconds) / _EASES)
    last = (seconds > (begins + ends) / 2)[:, None]
    places = np.where(last, poses[-1, 0, [0, 2]], poses[0, 0, [0, 2]])
    angles = np.where(last[:, 0], heading(poses[-1:]), heading(poses[:1]))
    stands = standing_by(places, angles, frames, seed)
    if moved <= _OF_HEAD:
        poses = _with_head(stands, poses, angles)
    elif not moved & _OF_ARMS:
        for shoulder, *arm in ARMS:
            poses[:, arm] = poses[:, [shoulder]] + stands[:, arm] - stands[:, [shoulder]]
    return np.asarray(stands + share[:, None, None] * (poses - stands))


def _with_head(body: Array, poses: Array, angles: Array) -> Array:
    """A body (N, 22, 3) that moves its head against its trunk as upright poses (N, 22, 3) of headings (N,) do."""
    neck, head = JOINT["neck"], JOINT["head"]
    ways = (poses[:, [neck, head]] - poses[:, [0, neck]]).swapaxes(1, 2)
    trunk, over = np.moveaxis(heading_matrix(heading(body) - angles) @ ways, -1, 0)
    moved = body.copy()
    moved[:, head] = body[:, neck] + np.einsum("nij,nj->ni", swing(trunk, body[:, neck] - body[:, 0]), over)
    return moved


def _getting_up(scores: Sequence[Score], person: int, beat: Stretch, last: Array) -> list[Pose]:
    """The poses of a person who gets up before a figure."""
    number = beat.window.beat
    up = replace(scores[number], figures={}, changes={"ab"[person]: (Change(posture="stands"),)})
    score = [*scores[:number], up, *scores[number + 1 :]]
    poses = postures(score, number, person, beat.start, beat.stop, beat.stand, last)
    return [pose for pose in poses if pose[0] < beat.start + min(RISING, beat.frames)]
