"""Recorded people who stand by, walk, run, gesture and dance: drafts that the network makes its motion from.

A gesture is a take of recorded people, chosen by the seed: a hand that goes up, what it does there, and the way down.
What it does is played to and fro as long as the gesture lasts. What nobody was recorded in, such as a limp, a crawl or
a person on another's back, was drawn, and is kept and played in the same way.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

from acts.shapes import Figure, Gesture
from motion import FPS
from motion.smoothing import minimum_jerk
from motion.transforms import heading, heading_matrix, mirrored
from motion.vectors import FLAT, Array, bearing, direction, floor_points

from .places import Course, Standing
from .poses import JOINT, LOWER, WRISTS, placed
from .window import Frames, late_by

RATE = 15
"""Poses a second of a recording."""
BLENDS = 0.3
"""Seconds in which a gesture begins and ends."""
TALKS = "talks"
"""The gesture in which two people take turns."""
HELD = "up"
"""The gesture that is held as long as the beat lasts."""
LOWERS, RAISED = "lowers", 1.0
"""The gesture that ends it, and seconds before it in which the hand went up."""
LEGS = [joint for joint in LOWER if joint != JOINT["spine1"]]
_FOLDER = Path(__file__).parents[1] / "recordings"
_UP = 0.6
"""Share of the way of a hand from where it is lowest to where it is highest, from which it is up."""
_RISES = 12
"""Poses of a take before and after those in which a hand is up, at most."""
_TURN = 0.55
"""Share of the time for which the one who talks first does so, and the other after them."""
_WALKS, _AHEAD = 0.4, 0.7
"""Metres a second from which somebody walks, and the share of their way that is ahead of them, at least."""
_RUNS, _CREEPS = 1.75, 0.15
"""Metres a second from which somebody runs, and from which they limp, creep or crawl."""
_FASTEST = 1.4
"""How much faster a recording is played, at most."""
_FITTING = 8
"""Takes of a gesture that fit best into its time, of which the seed chooses."""
_MEETS = 1.0
"""Seconds in which two who dance come to where the recorded couple is."""


@dataclass(frozen=True, eq=False)
class GestureTake:
    """A recorded gesture.

    Attributes:
        poses: (T, 22, 3) metres at :data:`RATE`, around the origin and facing +Z in the mean.
        up, down: the first and the last pose at which a hand is up.
    """

    poses: Array
    up: int
    down: int

    def over(self, seconds: Array, length: float, *, sinks: bool = True) -> Array:
        """The poses (N, 22, 3) at moments (N,) of a gesture of some length in seconds; held where it never sinks."""
        last = len(self.poses) - 1
        rise, fall = self.up / RATE, (last - self.down) / RATE if sinks else 0.0
        pace = float(np.clip((rise + fall) / (0.7 * length), 1.0, _FASTEST))
        rise, fall = rise / pace, fall / pace
        lasts = max(length - rise - fall, 1.0 / RATE)
        middle = min(self.down - self.up, _FASTEST * RATE * lasts)
        passes = RATE * lasts / max(middle, 1.0)
        if sinks:  # to and fro, and to the end
            passes = max(2 * round((passes - 1) / 2) + 1, 1)
        since = np.asarray(seconds, dtype=float) - rise
        goes = passes * np.clip(since / lasts, 0.0, 1.0)
        at = self.up + middle * (1 - np.abs(goes % 2 - 1))
        at = np.where(since < 0, self.up + since * pace * RATE, at)
        at = np.where(since > lasts, self.up + middle + (since - lasts) * pace * RATE, at) if sinks else at
        return sampled(self.poses, np.clip(at, 0.0, last))


def sampled(poses: Array, at: Array) -> Array:
    """Poses (T, 22, 3) at places (N,) between their frames."""
    before = np.minimum(at.astype(int), len(poses) - 2)
    share = (at - before)[:, None, None]
    return np.asarray((1 - share) * poses[before] + share * poses[before + 1])


@cache
def _kept(name: str) -> Mapping[str, Array]:
    """The recordings (T, …, 22, 3) of a file in metres at :data:`RATE`, by name."""
    with np.load(_FOLDER / f"{name}.npz", allow_pickle=False) as kept:
        return {each: kept[each].astype(float) / 1000 for each in sorted(kept.files)}


def drawn(name: str) -> Array:
    """A pose (22, 3) or several (N, 22, 3) that were drawn, in metres around the origin, facing +Z."""
    return _kept("drawn")[name]


@cache
def _read(name: str) -> Mapping[str, Array]:
    """Poses (T, 22, 3) in metres at :data:`RATE`, around the origin and facing +Z in the mean, by name."""
    clips = {}
    for each, poses in _kept(name).items():
        facing = heading(poses)
        mean = float(np.arctan2(np.sin(facing).mean(), np.cos(facing).mean()))
        clips[each] = (poses - poses[:, :1].mean(0) * FLAT) @ heading_matrix(-mean).T
    return clips


@dataclass(frozen=True, eq=False)
class Gait:
    """Recorded strides that end as they begin.

    Attributes:
        poses: (T, 22, 3) metres at :data:`RATE`, the pelvis over the origin, facing +Z.
        along: (T,) metres that it has gone.
        pace: metres a second.
    """

    poses: Array
    along: Array
    pace: float


@cache
def _read_gaits(action: str) -> tuple[Gait, ...]:
    gaits = []
    for kept in map(_kept, ("gaits", "drawn")):
        for name in sorted(name for name in kept if name.rpartition("-")[0] == action):
            poses = kept[name]
            along = poses[:, 0, 2] + 1e-6 * np.arange(len(poses))
            gaits.append(Gait(poses - poses[:, :1] * FLAT, along, along[-1] * RATE / (len(along) - 1)))
    return tuple(gaits)


@cache
def takes(gesture: str, hands: str) -> tuple[GestureTake, ...]:
    """The takes of a gesture of the left hand, the right one, or both; those of the left are mirrored."""
    side = "right" if hands == "left" else hands
    clips = [poses for name, poses in _read("gestures").items() if name.startswith(f"{gesture}-{side}-")]
    return tuple(_marked(mirrored(poses) if hands == "left" else poses) for poses in clips)


def _marked(poses: Array) -> GestureTake:
    wrists = poses[:, WRISTS, 1] - poses[:, :1, 1]
    height = (wrists - wrists.min()).max(axis=1)
    up = np.flatnonzero(height >= _UP * height.max())
    first = max(int(up[0]) - _RISES, 0)
    return GestureTake(poses[first : int(up[-1]) + _RISES + 1], int(up[0]) - first, int(up[-1]) - first)


@dataclass(frozen=True, eq=False)
class Performance:
    """A person's recorded gesture in a beat.

    Attributes:
        take: of it.
        begins, lasts: seconds of the beat.
        sinks: the hands sink again before it ends; others are held.
    """

    take: GestureTake
    begins: float
    lasts: float
    sinks: bool

    def poses(self, seconds: Array) -> Array:
        """The poses (N, 22, 3) around the origin, facing +Z, at moments (N,) of the beat."""
        return self.take.over(np.asarray(seconds) - self.begins, self.lasts, sinks=self.sinks)

    def share(self, seconds: Array) -> Array:
        """How far (N,) it is shown at moments of the beat, from 0 to 1."""
        since = np.asarray(seconds) - self.begins
        begun = minimum_jerk(since / BLENDS)
        if self.begins < 0:  # who lowers the hands lets them hang
            return np.ones_like(begun)
        return begun * minimum_jerk((self.lasts - since) / BLENDS) if self.sinks else begun

    def over(self, bodies: Array, seconds: Array, angle: float) -> Array:
        """Bodies (N, 22, 3) of one who stands by with a heading, who makes the gesture at moments (N,) of the beat.

        Their legs go on standing by.
        """
        poses = self.poses(seconds)
        shown = bodies[:, :1] + placed(poses - poses[:, :1], np.zeros(2), angle)
        shown[:, LEGS] = bodies[:, LEGS]
        share = self.share(seconds)[:, None, None]
        return (1 - share) * bodies + share * shown


def performance(gestures: Mapping[str, Gesture], person: int, frames: int, seed: int) -> Performance | None:
    """A person's gesture in a beat; None where its strokes are counted, or none is recorded.

    Args:
        gestures: of both people, by "a" and "b".
        person: 0 for a, 1 for b.
        frames: of the beat.
        seed: chooses the take, how late it begins, and who of two that talk does so first.
    """
    gesture = gestures["ab"[person]]
    lowers = gesture.gesture == LOWERS
    known = () if gesture.times else takes(HELD if lowers else gesture.gesture, gesture.sides)
    if not known:
        return None
    length, begins = frames / FPS, gesture.late + late_by(seed, person, frames)
    stops = length
    if lowers:  # the hand is up when the beat begins
        begins, stops = -RAISED, 0.5 * length
    if [each.gesture for each in gestures.values()] == [TALKS, TALKS]:
        begins, stops = (0.0, _TURN * length) if (seed + person) % 2 == 0 else ((1 - _TURN) * length, length)
    lasts = max(stops - begins, 2 * BLENDS)
    fitting = sorted(known, key=lambda take: abs(len(take.poses) / RATE - lasts))[:_FITTING]
    take = fitting[int(np.random.default_rng([seed, person, 3]).integers(len(fitting)))]
    return Performance(take, begins, lasts, sinks=gesture.gesture != HELD)


def standing_by(place: Array, angle: float | Array, frames: Frames, seed: int) -> Array:
    """A person who stands by.

    Args:
        place: (2,) or (N, 2) x and z in metres, around which the pelvis sways.
        angle: heading, or (N,) headings, in radians from +Z towards +X.
        frames: (N,) frames of the scene.
        seed: chooses the recording, and where it begins.

    Returns:
        (N, 22, 3) metres.
    """
    dice, known = np.random.default_rng([seed, 2]), tuple(_read("idle").values())
    poses = known[int(dice.integers(len(known)))]
    begins = dice.uniform(0, len(poses)) * FPS / RATE
    return placed(sampled(poses, _to_and_fro(np.asarray(frames) + begins, len(poses))), place, angle)


def _to_and_fro(frames: Array | Frames, count: int) -> Array:
    """Where frames (N,) of a scene are among so many poses that are played to their end and back."""
    last = count - 1
    return np.asarray(last - np.abs((np.asarray(frames) * RATE / FPS) % (2 * last) - last))


def has_takes(figure: str) -> bool:
    """True for a figure of a whole body that was recorded."""
    return any(name.startswith(f"{figure}-") for name in _read("figures"))


def performing(figure: Figure, place: Array, angle: float, frames: int, seed: int) -> Array:
    """A person (T, 22, 3) who does a recorded figure around a place (2,), from where they stand by and back to it."""
    known = [poses for name, poses in _read("figures").items() if name.startswith(f"{figure.figure}-")]
    if figure.times:  # those that fit best into their time
        each = (frames / FPS - figure.late) / figure.times * RATE
        known = sorted(known, key=lambda poses: abs(len(poses) - each))[: _FITTING // 2]
    poses, at = known[int(np.random.default_rng([seed, 6]).integers(len(known)))], np.arange(frames)
    if figure.mirrored:
        poses = mirrored(poses)
    since, left = at - figure.late * FPS, frames - 1 - figure.early * FPS - at
    goes = _to_and_fro(since.clip(min=0), len(poses))
    if figure.times:  # so often, one after another
        once = len(poses) / RATE * FPS
        once = max(min(once, (frames - figure.late * FPS) / figure.times), once / _FASTEST)
        goes, left = (since.clip(min=0) % once) / once * (len(poses) - 1), figure.times * once - since
    stands = standing_by(place, angle, at, seed)
    shown = placed(sampled(poses, goes), place, angle)
    share = (minimum_jerk(since / FPS / BLENDS) * minimum_jerk(left / FPS / BLENDS))[:, None, None]
    return np.asarray((1 - share) * stands + share * shown)


def dancing(stand: Standing, frames: int, seed: int) -> Array:
    """Two who dance with each other (2, T, 22, 3) as a recorded couple does, from where they stand."""
    dice, known = np.random.default_rng([seed, 5]), list(_kept("couples").values())
    couple = known[int(dice.integers(len(known)))].swapaxes(0, 1)[:: int(dice.choice([1, -1]))]
    at = np.arange(frames)
    first = couple[:, 0, 0][:, [0, 2]]
    turn = bearing(stand.towards(0)) - bearing(first[1] - first[0])
    spots, middle = floor_points(first) @ heading_matrix(turn).T, stand.places.mean(axis=0)
    shift = floor_points(middle) - spots.mean(axis=0)
    poses = np.stack([sampled(one, _to_and_fro(at, len(one))) for one in couple]) @ heading_matrix(turn).T + shift
    apart = floor_points(stand.places) - (spots + shift)
    return np.asarray(poses + apart[:, None, None] * (1 - minimum_jerk(at / FPS / _MEETS))[:, None, None])


def walking(course: Course, seed: int, gait: str = "") -> tuple[Array, Array]:
    """A person on a way over the floor: (T,) whether they walk or run ahead, or go, and (T, 22, 3) metres as they do.

    Strides near their pace go on by as much as they do, so that feet stay where they stand.

    Args:
        course: of the person.
        seed: chooses the recording, and where it begins.
        gait: as in :class:`acts.shapes.Go`; "" for a walk or a run.
    """
    steps = np.gradient(course.places, axis=0) if len(course.places) > 1 else np.zeros((1, 2))
    ahead = np.sum(steps * direction(course.headings), axis=1)
    gone = np.linalg.norm(steps, axis=1)
    walks = gone * FPS > _CREEPS if gait else (gone * FPS > _WALKS) & (ahead > _AHEAD * gone)
    pace = max(float(gone[walks].sum()) / max(int(walks.sum()), 1) * FPS, _CREEPS)
    dice = np.random.default_rng([seed, 4])
    known = _read_gaits(gait or ("run" if pace > _RUNS else "walk"))
    fitting = sorted(known, key=lambda strides: abs(math.log(pace / strides.pace)))[:_FITTING]
    strides = fitting[int(dice.integers(len(fitting)))]
    length = strides.along[-1]
    at = np.interp((dice.uniform(0, length) + np.cumsum(gone)) % length, strides.along, np.arange(len(strides.along)))
    return walks, placed(sampled(strides.poses, at), course.places, course.headings)


def carried(carry: str, places: Array, headings: Array) -> tuple[Array, Array]:
    """The poses of a person carried, and the carrier's.

    Args:
        carry: as in :class:`acts.shapes.Lift`.
        places: (N, 2) x and z of the carrier, on their feet, in metres.
        headings: (N,) the carrier's headings in radians.

    Returns:
        (N, 22, 3) metres in the world, with wrists where they hold on and elbows below, and (N, 22, 3) of the carrier,
        of which the trunk and the arms are meant.
    """
    carrier, pose = drawn(carry)
    return placed(pose, places, headings), placed(carrier, places, headings)
