"""Footsteps for bodies that glide: where both feet go along with the body, they step instead.

A network that is held to a way over the floor sometimes moves a standing body along it. Its own feet then say where
they would stand at any moment, so each is set down where it will be in the middle of its stance, and stays there while
the other swings. Lengths and times of the steps follow the speed, as people's do.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy  # its parts are loaded with their first use
from numpy.typing import NDArray

from .cleaning import solve_two_bones
from .easing import minimum_jerk
from .skeleton import SMPL22, Skeleton
from .transforms import facing
from .vectors import runs

Array = NDArray[np.floating]

_MOVES = 0.25
"""Metres a second of a body that goes somewhere."""
_RUNS = 2.3
"""Metres a second of a body whose feet leave the floor: steps would be too long for it."""
_GLIDES = 0.55
"""Share of the body's speed that both feet have at least where it glides."""
UPRIGHT, ON_FLOOR = 0.7, 0.08
"""Heights in metres of the pelvis at least, and of the lower toe at most: people who run, jump or lie do not glide."""
_GAP, _SHORTEST, _WAY = 0.2, 0.15, 0.1
"""Seconds between two glides that are one, seconds of the shortest, and metres of its way."""
_PERIOD = (0.36, 0.75)
"""Seconds of a step; in it a foot swings for the share :data:`SWING`."""
SWING = 0.8
_LENGTH = (0.2, 0.3)
"""Metres of a step at rest, and what it grows by with each metre a second (recorded walks: 0.5 to 0.65 m at 1.2)."""
_LONGEST, _QUICKEST = 0.65, 0.22
"""Metres of a step at most, and seconds at least, where a body surges ahead."""
_FASTEST, _PEAK = 6.5, 1.875
"""Metres a second of a foot at most, and how much faster than on average a swing of least jerk is."""
_STANDS = 3
"""Frames of a stance, at least: fewer do not count as standing."""
_RISE = 0.06
"""Metres by which an ankle rises in its swing."""
TOE, ANKLE = 0.02, 0.09
"""Heights in metres of a foot that is set down, at most."""


@dataclass(frozen=True)
class Step:
    """A foot (0 left, 1 right) that leaves at one frame, lands at another, and where it is at ``goal``, a third."""

    foot: int
    leaves: int
    lands: int
    goal: int


def stepping(positions: Array, fps: float, *, skeleton: Skeleton = SMPL22) -> Array:
    """Gives steps to people who glide over the floor; all others stay as they are.

    Args:
        positions: (T, J, 3) metres on a skeleton of constant bones, floor at 0.
        fps: frames a second.

    Returns:
        (T, J, 3) with the bone lengths of the input; knees, ankles and toes moved.
    """
    result = np.array(positions, dtype=np.float64)
    if len(result) < 4:
        return result
    feet = feet_of(result, skeleton)
    found = feet.copy()
    for start, stop in _glides(result, feet, fps):
        steps = _steps(feet, result[:, 0], start, stop, fps)
        found[start:stop] = walked(feet, feet, steps, start, stop)[start:stop]
    return with_feet(result, found, skeleton)


def feet_of(positions: Array, skeleton: Skeleton = SMPL22) -> Array:
    """(T, 2 sides, ankle and toe, 3) the feet of a person (T, J, 3)."""
    return np.stack([positions[:, leg[2:]] for leg in _legs(skeleton)], axis=1)


def _legs(skeleton: Skeleton) -> list[list[int]]:
    return [
        [skeleton.index(f"{side}_{part}") for part in ("hip", "knee", "ankle", "foot")] for side in ("left", "right")
    ]


def with_feet(positions: Array, found: Array, skeleton: Skeleton = SMPL22) -> Array:
    """A person (T, J, 3) whose feet are as they were ``found`` (T, 2, 2, 3), as far as legs reach."""
    result, forward = np.array(positions, dtype=np.float64), facing(positions, skeleton)
    legs, feet = _legs(skeleton), feet_of(result, skeleton)
    moved = np.abs(found - feet).max(axis=(2, 3)) > 1e-6
    for side, (hip, knee, ankle, toe) in enumerate(legs):
        own = moved[:, side]
        if not own.any():
            continue
        bent, met = solve_two_bones(
            result[own, hip], result[own, knee], result[own, ankle], found[own, side, 0], forward[own]
        )
        bone = found[own, side, 1] - found[own, side, 0]
        length = np.linalg.norm(feet[own, side, 1] - feet[own, side, 0], axis=-1, keepdims=True)
        result[own, knee], result[own, ankle] = bent, met
        result[own, toe] = met + bone * length / np.maximum(np.linalg.norm(bone, axis=-1, keepdims=True), 1e-9)
    return result


def _glides(positions: Array, feet: Array, fps: float) -> list[tuple[int, int]]:
    """(start, stop) of the stretches in which a body glides, long enough for two steps where there is room."""
    body = _speed(positions[:, 0], fps)
    slower = np.minimum(*(_speed(feet[:, side, 1], fps) for side in (0, 1)))
    low = np.minimum(feet[:, 0, 1, 1], feet[:, 1, 1, 1]) < ON_FLOOR
    gliding = (body > _MOVES) & (slower > _GLIDES * body) & low & (positions[:, 0, 1] > UPRIGHT) & (slower > 0.15)
    closing = np.ones(2 * round(_GAP * fps / 2) + 1)
    gliding = scipy.ndimage.binary_closing(np.pad(gliding, len(closing)), closing)[len(closing) : -len(closing)]
    found: list[tuple[int, int]] = []
    for start, stop in runs(gliding):
        way = np.linalg.norm((positions[stop - 1, 0] - positions[start, 0])[[0, 2]])
        if stop - start < _SHORTEST * fps or way < _WAY or body[start:stop].mean() > _RUNS:
            continue
        more = max(0, round((2 * _PERIOD[0] * fps - (stop - start)) / 2))
        start = max(found[-1][1] if found else 0, start - more)
        found.append((start, min(len(positions), stop + more)))
    return found


def _steps(feet: Array, pelvis: Array, start: int, stop: int, fps: float) -> list[Step]:
    """The steps of a stretch, the last two of which end where its feet are."""
    speed = scipy.ndimage.gaussian_filter1d(_speed(pelvis, fps), 0.2 * fps, mode="nearest")[start:stop]
    period = np.clip((_LENGTH[0] + _LENGTH[1] * speed) / np.maximum(speed, 0.1), *_PERIOD)
    phase = np.concatenate([[0.0], np.cumsum(1 / (period * fps))])
    way = float(np.linalg.norm((pelvis[stop - 1] - pelvis[start])[[0, 2]]))
    most = max(2, int((stop - start) / (_QUICKEST * fps)))
    count = min(max(2, round(float(phase[-1])), math.ceil(way / _LONGEST) + 1), most)
    at = np.interp(np.arange(0, count + 1) * phase[-1] / count, phase, np.arange(len(phase)))
    ahead = pelvis[stop - 1] - pelvis[start]
    first = int(np.argmin([feet[start, side, 1] @ ahead for side in (0, 1)]))  # the foot that is behind
    places = list(feet[start, :, 0])
    steps = []
    for i in range(count):
        foot, lands = (first + i) % 2, start + at[i] + SWING * (at[i + 1] - at[i])
        leaves = max(start + at[i], _STANDS)  # a step that begins the motion starts from a standing foot
        goal = round(stop - 1 if i >= count - 2 else min(lands + 0.5 * (at[i + 1] - at[i]), stop - 1))
        least = max(2, math.ceil(_PEAK * np.linalg.norm(feet[goal, foot, 0] - places[foot]) / _FASTEST * fps))
        again = start + at[min(i + 2, count)]  # when the foot leaves next
        steps.append(Step(foot, round(leaves), round(max(lands, min(leaves + least, again))), goal))
        places[foot] = feet[goal, foot, 0]
    return steps


def walked(feet: Array, stances: Array, steps: Sequence[Step], start: int, stop: int) -> Array:
    """The feet (T, 2, 2, 3) with the steps of a stretch, set down as in ``stances`` (T, 2, 2, 3)."""
    found = feet.copy()
    held = [_set_down(feet[start, side]) for side in (0, 1)]
    for side in (0, 1):
        found[start:stop, side] = held[side]
        for step in (step for step in steps if step.foot == side):
            goal = _set_down(stances[step.goal, side])
            lands = min(step.lands, stop - 1)
            share = (np.arange(step.leaves, lands + 1) - step.leaves) / max(lands - step.leaves, 1)
            eased = minimum_jerk(share)[:, None, None]
            swing = held[side] + eased * (goal - held[side])
            swing[:, 0, 1] += _RISE * np.sin(np.pi * share) ** 2
            found[step.leaves : lands + 1, side] = swing
            found[lands + 1 : stop, side] = goal
            held[side] = goal
    return found


def _set_down(foot: Array) -> Array:
    """An ankle and a toe (2, 3) on the floor."""
    found = np.array(foot)
    found[:, 1] = np.minimum(found[:, 1], [ANKLE, TOE])
    return found


def _speed(place: Array, fps: float) -> Array:
    """(T,) metres a second over the floor."""
    return np.asarray(np.linalg.norm(np.gradient(place[:, [0, 2]], axis=0), axis=-1) * fps)
