"""Follows people from picture to picture: the poses of a film as one track a person."""

from __future__ import annotations

import itertools
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from motion.errors import InputError

from .landmarks import TORSO, Landmarks

Array = NDArray[np.floating]

RATES = (5.0, 30.0)
"""Frames a second that a track may have."""
_BOTH = 0.4
"""Share of the pictures with anybody from which a second person is taken to be there."""
_SAME = 0.15
"""Two poses whose points lie this close together, in torso lengths, are of one person."""
_FAR = 3.0
"""Torso lengths that a person cannot have moved between two pictures without a doubt."""
_NOBODY = "Nobody was found in the film: film one or two people from head to feet, in good light."


@dataclass(frozen=True, eq=False)
class Track:
    """One person over a film, at even steps of time; NaN where they were not found.

    Attributes:
        fps: frames a second.
        start: seconds of the film at the first frame.
        world: (T, 33, 3) as in :class:`Landmarks`.
        pixels: (T, 33, 2) from the upper left corner.
        seen: (T, 33) 0 to 1; 0 where the person was not found.
    """

    fps: float
    start: float
    world: Array = field(repr=False)
    pixels: Array = field(repr=False)
    seen: Array = field(repr=False)

    def __len__(self) -> int:
        return len(self.world)

    @property
    def found(self) -> NDArray[np.bool_]:
        """(T,) whether the person was found."""
        return np.isfinite(self.pixels[:, 0, 0])

    def cut(self, start: int, stop: int) -> Track:
        """Frames ``start`` to ``stop`` (exclusive)."""
        part = slice(start, stop)
        return Track(self.fps, self.start + start / self.fps, self.world[part], self.pixels[part], self.seen[part])


def tracks_of(landmarks: Landmarks) -> tuple[Track, ...]:
    """One track for each of the one or two people in a film, the person further to the left first.

    Tracks begin and end where everybody was first and last found.

    Raises:
        InputError: where nobody was found, or for too short a time.
    """
    if len(landmarks.frames) == 0:
        raise InputError(_NOBODY)
    by_frame = [
        _distinct(landmarks, np.flatnonzero(landmarks.frames == frame)) for frame in range(len(landmarks.times))
    ]
    filled = [poses for poses in by_frame if len(poses)]
    people = 2 if sum(len(poses) > 1 for poses in filled) >= _BOTH * len(filled) else 1
    chosen = _follow(landmarks, by_frame, people)  # (people, F) index of a pose, or -1
    seen = np.asarray((chosen >= 0).all(axis=0))
    first, last = int(seen.argmax()), len(seen) - int(seen[::-1].argmax())
    if not seen.any() or last - first < 2:
        raise InputError(_NOBODY)
    tracks = [_even(landmarks, row, first, last) for row in chosen]
    middle = [float(np.nanmean(track.pixels[:, TORSO, 0])) for track in tracks]
    return tuple(tracks[i] for i in np.argsort(middle))


def _distinct(landmarks: Landmarks, poses: NDArray[np.integer]) -> NDArray[np.integer]:
    """Poses without those that lie on another of the same picture."""
    kept: list[int] = []
    for pose in poses:
        if all(_apart(landmarks, pose, other) > _SAME for other in kept):
            kept.append(int(pose))
    return np.array(kept, dtype=int)


def _torso(points: Array) -> float:
    """Length of the torso in pixels, at least 1."""
    left, right, left_hip, right_hip = points[TORSO]
    return max(float(np.linalg.norm((left + right - left_hip - right_hip) / 2)), 1.0)


def _apart(landmarks: Landmarks, one: int, other: int) -> float:
    """Median distance of two poses' points in torso lengths."""
    a, b = landmarks.pixels[one], landmarks.pixels[other]
    return float(np.median(np.linalg.norm(a - b, axis=-1)) / max(_torso(a), _torso(b)))


def _follow(landmarks: Landmarks, by_frame: list[NDArray[np.integer]], people: int) -> NDArray[np.integer]:
    """(people, F) which pose is whose, from the first picture that has everybody, forwards and backwards."""
    begin = next(frame for frame, poses in enumerate(by_frame) if len(poses) >= people)
    # Of too many, the largest: they stand nearest.
    first = sorted(by_frame[begin], key=lambda pose: -_torso(landmarks.pixels[pose]))[:people]
    chosen = np.full((people, len(by_frame)), -1)
    for frames in (range(begin, len(by_frame)), range(begin, -1, -1)):
        latest = list(first)
        since = [0] * people
        for frame in frames:
            poses = by_frame[frame]
            # A place is more certain than no place; a pose far from where the person was is somebody else.
            best = min(
                itertools.permutations([*poses, *([-1] * people)], people),
                key=lambda order: sum(_doubt(landmarks, latest[i], pose, since[i]) for i, pose in enumerate(order)),
            )
            for person, pose in enumerate(best):
                since[person] += 1
                if pose >= 0:
                    latest[person], since[person] = int(pose), 0
                    chosen[person, frame] = pose
    return chosen


def _doubt(landmarks: Landmarks, before: int, pose: int, missed: int) -> float:
    if pose < 0:
        return _FAR
    # Who was lost for a while may have gone further.
    return _apart(landmarks, before, pose) / (1 + 0.2 * missed)


def _even(landmarks: Landmarks, poses: NDArray[np.integer], first: int, last: int) -> Track:
    """A person's poses at even steps of time: between pictures by straight lines, but not across gaps."""
    times = landmarks.times
    step = float(np.median(np.diff(times)))
    fps = float(np.clip(round(1 / step), *RATES))
    start, end = times[first], times[last - 1]
    grid = start + np.arange(max(2, int(np.floor((end - start) * fps + 1e-6)) + 1)) / fps
    mine = np.flatnonzero(poses >= 0)
    known = times[mine]
    after = np.clip(np.searchsorted(known, grid - 1e-9), 0, len(known) - 1)
    before = np.clip(after - (known[after] > grid + 1e-9), 0, None)
    gap = known[after] - known[before]
    share = np.where(gap > 0, (grid - known[before]) / np.where(gap > 0, gap, 1.0), 0.0)
    away = np.where(gap > 0, gap > 2.5 * max(step, 1 / fps), np.abs(known[after] - grid) > 1.5 / fps)

    def between(values: Array) -> Array:
        weight = share.reshape(-1, *[1] * (values.ndim - 1))
        mixed = values[poses[mine[before]]] * (1 - weight) + values[poses[mine[after]]] * weight
        mixed[away] = np.nan
        return mixed

    seen = np.nan_to_num(between(landmarks.seen))
    return Track(fps, float(start), between(landmarks.world), between(landmarks.pixels), seen)
