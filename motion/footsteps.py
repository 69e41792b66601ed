"""Footsteps for bodies that glide: where both feet go along with the body, they step instead.

A network that is held to a way over the floor sometimes moves a standing body along it. Its own feet then say where
they would stand at any moment, so each is set down where it will be in the middle of its stance, and stays there while
the other swings. Lengths and times of the steps follow the speed, as people's do.

A body that is turned over feet that stay crosses its legs and twists its knees. There the feet step, the one towards
which the body turns first, and are set down under the hips as these are turned by then.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy  # its parts are loaded with their first use
from numpy.typing import NDArray

from .limbs import solve_two_bones
from .skeleton import LEGS
from .smoothing import minimum_jerk
from .transforms import facing
from .vectors import FLAT, Array, floor_speed, heading_of, left_of, runs, unit, wrapped

_MOVES = 0.25
"""Metres a second of a body that goes somewhere."""
_RUNS = 2.3
"""Metres a second of a body whose feet leave the floor: steps would be too long for it."""
_GLIDES = 0.55
"""Share of the body's speed that both feet have at least where it glides."""
UPRIGHT, ON_FLOOR = 0.7, 0.08
"""Heights in metres of the pelvis at least, and of the lower toe at most: people who run, jump or lie do not glide."""
_GAP, _SHORTEST, _WAY = 0.2, 0.15, 0.1
"""Seconds between two glides or turns that are one, seconds of the shortest glide, and metres of its way."""
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


def stepping(positions: Array, fps: float) -> Array:
    """Gives steps to people who glide over the floor; all others stay as they are.

    Args:
        positions: (T, J, 3) metres on constant bones, floor at 0.
        fps: frames a second.

    Returns:
        (T, J, 3) with the bone lengths of the input; knees, ankles and toes moved.
    """
    result = np.array(positions, dtype=np.float64)
    if len(result) < 4:
        return result
    feet = feet_of(result)
    stepped = feet.copy()
    for start, stop in _glides(result, feet, fps):
        steps = _steps(feet, result[:, 0], start, stop, fps)
        stepped[start:stop] = walked(feet, feet, steps, start, stop)[start:stop]
    return with_feet(result, stepped)


def feet_of(positions: Array) -> Array:
    """(T, 2 sides, ankle and toe, 3) the feet of a person (T, J, 3)."""
    return np.stack([positions[:, list(leg[2:])] for leg in LEGS], axis=1)


def with_feet(positions: Array, places: Array) -> Array:
    """A person (T, J, 3) whose ankles and toes are at ``places`` (T, 2, 2, 3), as far as legs reach."""
    result, forward = np.array(positions, dtype=np.float64), facing(positions)
    feet = feet_of(result)
    moved = np.abs(places - feet).max(axis=(2, 3)) > 1e-6
    for side, (hip, knee, ankle, toe) in enumerate(LEGS):
        own = moved[:, side]
        if not own.any():
            continue
        bent, met = solve_two_bones(
            result[own, hip], result[own, knee], result[own, ankle], places[own, side, 0], forward[own]
        )
        length = np.linalg.norm(feet[own, side, 1] - feet[own, side, 0], axis=-1, keepdims=True)
        result[own, knee], result[own, ankle] = bent, met
        result[own, toe] = met + unit(places[own, side, 1] - places[own, side, 0]) * length
    return result


def _glides(positions: Array, feet: Array, fps: float) -> list[tuple[int, int]]:
    """(start, stop) of the stretches in which a body glides, long enough for two steps where there is room."""
    body = floor_speed(positions[:, 0], fps)
    slower = np.minimum(*(floor_speed(feet[:, side, 1], fps) for side in (0, 1)))
    low = np.minimum(feet[:, 0, 1, 1], feet[:, 1, 1, 1]) < ON_FLOOR
    gliding = (body > _MOVES) & (slower > _GLIDES * body) & low & (positions[:, 0, 1] > UPRIGHT) & (slower > 0.15)
    stretches: list[tuple[int, int]] = []
    for start, stop in runs(_closed(gliding, fps)):
        way = np.linalg.norm((positions[stop - 1, 0] - positions[start, 0])[[0, 2]])
        if stop - start < _SHORTEST * fps or way < _WAY or body[start:stop].mean() > _RUNS:
            continue
        more = max(0, round((2 * _PERIOD[0] * fps - (stop - start)) / 2))
        start = max(stretches[-1][1] if stretches else 0, start - more)
        stretches.append((start, min(len(positions), stop + more)))
    return stretches


def _closed(marked: NDArray[np.bool_], fps: float) -> NDArray[np.bool_]:
    """Marked frames (T,) without gaps of less than 0.2 s."""
    closing = np.ones(2 * round(_GAP * fps / 2) + 1)
    return np.asarray(scipy.ndimage.binary_closing(np.pad(marked, len(closing)), closing)[len(closing) : -len(closing)])


def _steps(feet: Array, pelvis: Array, start: int, stop: int, fps: float) -> list[Step]:
    """The steps of a stretch, the last two of which end where its feet are."""
    speed = scipy.ndimage.gaussian_filter1d(floor_speed(pelvis, fps), 0.2 * fps, mode="nearest")[start:stop]
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
    placed = feet.copy()
    held = [_set_down(feet[start, side]) for side in (0, 1)]
    for side in (0, 1):
        placed[start:stop, side] = held[side]
        for step in (step for step in steps if step.foot == side):
            goal = _set_down(stances[step.goal, side])
            lands = min(step.lands, stop - 1)
            share = (np.arange(step.leaves, lands + 1) - step.leaves) / max(lands - step.leaves, 1)
            eased = minimum_jerk(share)[:, None, None]
            swing = held[side] + eased * (goal - held[side])
            swing[:, 0, 1] += _RISE * np.sin(np.pi * share) ** 2
            placed[step.leaves : lands + 1, side] = swing
            placed[lands + 1 : stop, side] = goal
            held[side] = goal
    return placed


def _set_down(foot: Array) -> Array:
    """An ankle and a toe (2, 3) on the floor."""
    standing = np.array(foot)
    standing[:, 1] = np.minimum(standing[:, 1], [ANKLE, TOE])
    return standing


# ---- Turns -----------------------------------------------------------------------------------------------------------
_CROSSED, _TWISTED = 0.02, math.radians(50.0)
"""Metres by which the left ankle is to the left of the right one, and radians from the hips to a foot, where a turn has
left the feet behind."""
_OPEN, _ALONG = 0.09, math.radians(30.0)
"""The same where feet stand under the hips again."""
_BEGINS = math.radians(18.0)
"""Radians from the hips to a foot from which a turn begins."""
_TURNED, _STILL = math.radians(50.0), math.radians(12.0)
"""Radians of a turn in which feet are given steps, at least, and from which they are left to the end of a turn."""
_LATER = 0.7
"""Seconds before and after within which feet stand under the hips."""
_WALKS_ON = 0.9
"""Metres a second of a body that walks a curve and does not turn on the spot."""
_PIVOT, _PIVOT_TIME, _QUICKEST_PIVOT = math.radians(75.0), 0.3, 0.2
"""Radians of a turn in one step, seconds of a step where there is time, and at least."""
_BESIDE, _OUT = 0.1, math.radians(8.0)
"""Metres from the middle to an ankle of a foot under the hips, and the radians that its toes are turned out."""
_LEAVES = 0.4
"""Metres a second of a foot that leaves where it stood."""


@dataclass(frozen=True)
class Turn:
    """Frames of a body that turns over its feet.

    Attributes:
        start, stop: the first frame and the one after the last of its steps.
        lands: the feet were where a turn leaves them; otherwise they stay crossed, until they leave.
    """

    start: int
    stop: int
    lands: bool


def pivoting(positions: Array, fps: float) -> Array:
    """Gives steps to people who turn over their feet; all others stay as they are.

    Args:
        positions: (T, J, 3) metres on constant bones, floor at 0.
        fps: frames a second.

    Returns:
        (T, J, 3) with the bone lengths of the input; knees, ankles and toes moved.
    """
    feet = feet_of(positions)
    forward = facing(positions)
    stepped = feet.copy()
    for turn in _turns(positions, feet, forward, fps):
        under = _under(positions[:, 0], forward, feet)
        inside = slice(turn.start, turn.stop)
        if not turn.start:  # who begins in a turn begins with the feet under the hips
            stepped[0] = under[0]
        if turn.lands:
            under[turn.stop - 1] = feet[turn.stop - 1]
        stepped[inside] = walked(stepped, under, _pivot_steps(forward, turn, fps), turn.start, turn.stop)[inside]
        if not turn.lands:
            stepped[turn.stop :] = _left_standing(feet, stepped[turn.stop - 1], turn.stop, fps)
    return with_feet(positions, stepped) if (stepped != feet).any() else np.array(positions)


def _turns(positions: Array, feet: Array, forward: Array, fps: float) -> list[Turn]:
    """The turns of a body over its feet, from and, where they come there, to where these are under it."""
    yaw = np.unwrap(heading_of(forward))
    apart = np.sum((feet[:, 0, 0] - feet[:, 1, 0]) * left_of(forward), axis=-1)
    off = np.abs(wrapped(heading_of(feet[:, :, 1] - feet[:, :, 0]) - yaw[:, None])).max(axis=1)
    stands = (positions[:, 0, 1] > UPRIGHT) & (feet[:, :, 1, 1].min(axis=1) < ON_FLOOR)
    behind, under = stands & ((apart < _CROSSED) | (off > _TWISTED)), (apart > _OPEN) & (off < _ALONG)
    at_rest = under & (off < _BEGINS)
    turns: list[Turn] = []
    room, least, low = round(_LATER * fps), round(2 * _PIVOT_TIME * fps), 0
    for first, last in runs(_closed(behind, fps)):
        if first < low:
            continue
        before, after = np.flatnonzero(at_rest[low:first]), np.flatnonzero(under[last : last + room])
        begins = low + int(before[-1]) if len(before) else first - room
        start = max(low, first - room, begins)
        lands = bool(len(after)) and last - first <= room
        stop = last + int(after[0]) + 1 if lands else first + _ends(yaw[first : last + room]) + 1
        start = max(low, min(start, stop - least))
        if not lands:  # the last steps may end after the turn
            stop = min(max(stop, start + round(_wanted(yaw[stop - 1] - yaw[start]) * _PIVOT_TIME * fps)), len(yaw))
        steps = np.diff(positions[start:stop, 0][:, [0, 2]], axis=0)
        if np.linalg.norm(steps, axis=-1).mean() * fps > _WALKS_ON:
            continue  # its steps are those of a walk
        if abs(yaw[stop - 1] - yaw[start]) > _TURNED and stands[start:stop].all() and stop - start >= least:
            turns.append(Turn(start, stop, lands))
            low = stop
    return turns


def _wanted(turned: float) -> int:
    """The steps of a turn by so many radians."""
    return max(2, math.ceil(abs(turned) / _PIVOT) + 1)


def _ends(yaw: Array) -> int:
    """The frame of headings (T,) from which a body turns no more."""
    return int(np.argmax(np.abs(yaw - yaw[-1]) < _STILL))


def _pivot_steps(forward: Array, turn: Turn, fps: float) -> list[Step]:
    """The steps of a turn, the last two of which end at its end."""
    yaw = np.unwrap(heading_of(forward[turn.start : turn.stop]))
    frames, turned = turn.stop - turn.start, float(yaw[-1] - yaw[0])
    count = min(_wanted(turned), max(2, int(frames / (_QUICKEST_PIVOT * fps))))
    first, each = 0 if turned > 0 else 1, frames / count
    steps = []
    for i in range(count):
        leaves, lands = turn.start + i * each, turn.start + (i + SWING) * each
        goal = turn.stop - 1 if i >= count - 2 else min(lands + 0.5 * each, turn.stop - 1)
        steps.append(Step((first + i) % 2, round(leaves), max(round(lands), round(leaves) + 2), round(goal)))
    return steps


def _under(pelvis: Array, forward: Array, feet: Array) -> Array:
    """Feet (T, 2, 2, 3) that stand under the hips, as they are turned, and are as long as the feet were."""
    across = left_of(forward)
    standing = feet.copy()
    for side, out in ((0, 1.0), (1, -1.0)):
        along = math.cos(_OUT) * forward + out * math.sin(_OUT) * across
        length = np.linalg.norm((feet[:, side, 1] - feet[:, side, 0])[:, [0, 2]], axis=-1, keepdims=True)
        standing[:, side, 0] = pelvis + out * _BESIDE * across - 0.3 * length * forward
        standing[:, side, 1] = standing[:, side, 0] + length * along
        standing[:, side, :, 1] = [ANKLE, TOE]
    return standing


def _left_standing(feet: Array, stands: Array, stop: int, fps: float) -> Array:
    """The feet (N, 2, 2, 3) from a frame on, which stay as they ``stand`` (2, 2, 3) until their own next step."""
    placed = feet[stop:].copy()
    for side in (0, 1):
        goes = floor_speed(feet[:, side, 1], fps)[stop:] > _LEAVES
        leaves = int(np.argmax(goes)) if goes.any() else len(placed)
        rests = ~goes[leaves:]
        lands = leaves + max(int(np.argmax(rests)) if rests.any() else len(rests), 1)
        placed[:leaves, side] = stands[side]
        fade = 1 - minimum_jerk((np.arange(leaves, lands) - leaves + 1) / (lands - leaves))
        shift = (stands[side] - feet[min(stop + leaves, len(feet) - 1), side]) * FLAT
        placed[leaves:lands, side] += fade[:, None, None] * shift
    return placed
