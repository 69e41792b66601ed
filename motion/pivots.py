"""Steps of a body that turns: a body that is turned over feet that stay crosses its legs and twists its knees.

A network that is held to a heading turns the hips there, and leaves the feet behind or puts them down crossed. There
they step, the one towards which the body turns first, and are set down under the hips as these are turned by then.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import scipy  # its parts are loaded with their first use
from numpy.typing import NDArray

from .easing import minimum_jerk
from .footsteps import ANKLE, ON_FLOOR, SWING, TOE, UPRIGHT, Step, feet_of, walked, with_feet
from .skeleton import SMPL22, Skeleton
from .transforms import facing
from .vectors import runs, wrapped

Array = NDArray[np.floating]

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
_WALKS = 0.9
"""Metres a second of a body that walks a curve and does not turn on the spot."""
_GAP = 0.2
"""Seconds between two stretches that are one."""
_PIVOT, _PIVOT_TIME, _QUICKEST = math.radians(75.0), 0.3, 0.2
"""Radians of a turn in one step, seconds of a step where there is time, and at least."""
_BESIDE, _OUT = 0.1, math.radians(8.0)
"""Metres from the middle to an ankle of a foot under the hips, and the radians that its toes are turned out."""
_LEAVES = 0.4
"""Metres a second of a foot that leaves where it stood."""
_UP = np.array([0.0, 1.0, 0.0])


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


def pivoting(positions: Array, fps: float, *, skeleton: Skeleton = SMPL22) -> Array:
    """Gives steps to people who turn over their feet; all others stay as they are.

    Args:
        positions: (T, J, 3) metres on a skeleton of constant bones, floor at 0.
        fps: frames a second.

    Returns:
        (T, J, 3) with the bone lengths of the input; knees, ankles and toes moved.
    """
    feet = feet_of(positions, skeleton)
    forward = facing(positions, skeleton)
    found = feet.copy()
    for turn in _turns(positions, feet, forward, fps):
        under = _under(positions[:, 0], forward, feet)
        inside = slice(turn.start, turn.stop)
        if not turn.start:  # who begins in a turn begins with the feet under the hips
            found[0] = under[0]
        if turn.lands:
            under[turn.stop - 1] = feet[turn.stop - 1]
        found[inside] = walked(found, under, _steps(forward, turn, fps), turn.start, turn.stop)[inside]
        if not turn.lands:
            found[turn.stop :] = _left_standing(feet, found[turn.stop - 1], turn.stop, fps)
    return with_feet(positions, found, skeleton) if (found != feet).any() else np.array(positions)


def _turns(positions: Array, feet: Array, forward: Array, fps: float) -> list[Turn]:
    """The turns of a body over its feet, from and, where they come there, to where these are under it."""
    yaw = np.unwrap(_bearing(forward))
    apart = np.sum((feet[:, 0, 0] - feet[:, 1, 0]) * np.cross(_UP, forward), axis=-1)
    off = np.abs(wrapped(_bearing(feet[:, :, 1] - feet[:, :, 0]) - yaw[:, None])).max(axis=1)
    stands = (positions[:, 0, 1] > UPRIGHT) & (feet[:, :, 1, 1].min(axis=1) < ON_FLOOR)
    behind, under = stands & ((apart < _CROSSED) | (off > _TWISTED)), (apart > _OPEN) & (off < _ALONG)
    at_rest = under & (off < _BEGINS)
    closing = np.ones(2 * round(_GAP * fps / 2) + 1)
    behind = scipy.ndimage.binary_closing(np.pad(behind, len(closing)), closing)[len(closing) : -len(closing)]
    found: list[Turn] = []
    room, least, low = round(_LATER * fps), round(2 * _PIVOT_TIME * fps), 0
    for first, last in runs(behind):
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
        if _speed(positions[start:stop, 0], fps) > _WALKS:
            continue  # its steps are those of a walk
        if abs(yaw[stop - 1] - yaw[start]) > _TURNED and stands[start:stop].all() and stop - start >= least:
            found.append(Turn(start, stop, lands))
            low = stop
    return found


def _speed(place: Array, fps: float) -> float:
    """Metres a second over the floor, on the mean, of a joint (T, 3)."""
    return float(np.linalg.norm(np.diff(place[:, [0, 2]], axis=0), axis=-1).mean() * fps)


def _wanted(turned: float) -> int:
    """The steps of a turn by so many radians."""
    return max(2, math.ceil(abs(turned) / _PIVOT) + 1)


def _ends(yaw: Array) -> int:
    """The frame of headings (T,) from which a body turns no more."""
    return int(np.argmax(np.abs(yaw - yaw[-1]) < _STILL))


def _steps(forward: Array, turn: Turn, fps: float) -> list[Step]:
    """The steps of a turn, the last two of which end at its end."""
    yaw = np.unwrap(_bearing(forward[turn.start : turn.stop]))
    frames, turned = turn.stop - turn.start, float(yaw[-1] - yaw[0])
    count = min(_wanted(turned), max(2, int(frames / (_QUICKEST * fps))))
    first, each = 0 if turned > 0 else 1, frames / count
    steps = []
    for i in range(count):
        leaves, lands = turn.start + i * each, turn.start + (i + SWING) * each
        goal = turn.stop - 1 if i >= count - 2 else min(lands + 0.5 * each, turn.stop - 1)
        steps.append(Step((first + i) % 2, round(leaves), max(round(lands), round(leaves) + 2), round(goal)))
    return steps


def _under(pelvis: Array, forward: Array, feet: Array) -> Array:
    """Feet (T, 2, 2, 3) that stand under the hips, as they are turned, and are as long as the feet were."""
    across = np.cross(_UP, forward)
    found = feet.copy()
    for side, out in ((0, 1.0), (1, -1.0)):
        along = math.cos(_OUT) * forward + out * math.sin(_OUT) * across
        length = np.linalg.norm((feet[:, side, 1] - feet[:, side, 0])[:, [0, 2]], axis=-1, keepdims=True)
        found[:, side, 0] = pelvis + out * _BESIDE * across - 0.3 * length * forward
        found[:, side, 1] = found[:, side, 0] + length * along
        found[:, side, :, 1] = [ANKLE, TOE]
    return found


def _left_standing(feet: Array, stands: Array, stop: int, fps: float) -> Array:
    """The feet (N, 2, 2, 3) from a frame on, which stay as they ``stand`` (2, 2, 3) until their own next step."""
    found = feet[stop:].copy()
    for side in (0, 1):
        speed = np.linalg.norm(np.gradient(feet[:, side, 1][:, [0, 2]], axis=0), axis=-1)[stop:] * fps
        goes = speed > _LEAVES
        leaves = int(np.argmax(goes)) if goes.any() else len(found)
        rests = ~goes[leaves:]
        lands = leaves + max(int(np.argmax(rests)) if rests.any() else len(rests), 1)
        found[:leaves, side] = stands[side]
        fade = 1 - minimum_jerk((np.arange(leaves, lands) - leaves + 1) / (lands - leaves))
        shift = (stands[side] - feet[min(stop + leaves, len(feet) - 1), side]) * [1.0, 0.0, 1.0]
        found[leaves:lands, side] += fade[:, None, None] * shift
    return found


def _bearing(line: Array) -> Array:
    """(…) radians from +Z towards +X of directions (…, 3) as seen from above."""
    return np.asarray(np.arctan2(line[..., 0], line[..., 2]))
