"""Arms of people who walk: they swing against the legs, as wide as people's do at that speed.

A network that is held to a way over the floor has the arms in time with the steps, but hardly moves them. What is
missing is added: an arm goes forward with the other side's foot, by degrees a metre that its ankle is ahead. Swing and
steps so begin and end together, and an arm that swings as far as people's already stays as it is. Arms that the network
carries out to the side, or bent before the chest as runners do, hang first.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy  # its parts are loaded with their first use

from .skeleton import ARMS, LEGS, SMPL22
from .smoothing import smoothstep
from .transforms import facing
from .vectors import Array, unit

# Of 772 stretches of 2.5 s in which people walk ahead: means of the medians of four sets of recordings (Bandai-Namco's
# two, ACCAD and CMU), and quartiles of all.
_SPEEDS = np.array([0.62, 0.92, 1.12, 1.34])
"""Metres a second over the floor at which the swing is known."""
_SWINGS = np.radians([21.0, 38.0, 45.0, 55.0])
"""Radians between shoulder and wrist for each metre between the ankles, at these speeds."""
_UPPER, _LOWER = 0.78, 1.22
"""Shares of it by which the upper arm and the forearm turn: an elbow bends as it comes forward."""
_PERSONS, _SIDES = (0.79, 1.28), (-0.01, 0.26)
"""Quartiles of the swing among people, and of the logarithm of how much wider the left arm swings than the right."""
_LEADS = 0.07
"""Seconds by which an arm is ahead of the foot."""
_WALKS = (0.25, 0.6)
"""Metres a second of a body from which its arms begin to swing, and swing wholly."""
_UPRIGHT = (0.7, 0.8)
"""Heights of the pelvis in metres: a person below the first is low, and one above the second walks upright."""
_LEAPS = (0.4, 0.8)
"""Vertical speeds of the pelvis in m/s: below the first a person walks, above the second they jump or get up."""
_HANGS, _RAISED = (0.35, 0.6), (-0.3, 0.0)
"""Shares of an arm's length by which a wrist is below its shoulder: of an arm that hangs, and of one that is low."""
_OUT, _AHEAD, _BENT = np.radians([27.0, 20.0, 40.0])
"""Radians from the vertical out to the side and ahead, and of the elbow, of arms of people who walk, on the mean over a
stride (upper deciles)."""
_LOWERS = 0.9
"""Share of what is more by which an arm is lowered."""
_RUNS = (1.5, 2.0)
"""Metres a second of people who carry their arms bent: from none to all."""
_STRAIGHT = np.radians(8.0)
"""Radians of an elbow at least, however far the arm swings back."""
_STEADY, _STRIDE = 0.1, 0.6
"""Seconds (standard deviation) over which steps are smoothed, and over which an arm's own swing is measured."""
_EASES = 0.2
"""Seconds (the same) over which a swing begins and ends."""
_UP = np.array([0.0, 1.0, 0.0])


def swinging(person: Array, fps: float, free: Array, seed: int | Sequence[int] = 0) -> Array:
    """A person whose arms hang and swing as they walk.

    Args:
        person: (T, 22, 3) metres on constant bones, floor at 0.
        fps: frames a second.
        free: (T,) how far the arms have nothing else to do, 0 to 1.
        seed: draws how wide each arm swings.

    Returns:
        (T, 22, 3) on the same bones; elbows and wrists moved.
    """
    result = np.array(person, dtype=np.float64)
    ahead = unit(_smooth(facing(result), _EASES, fps))
    left = np.cross(_UP, ahead)
    velocity = np.gradient(_smooth(result[:, 0], _STEADY, fps), axis=0) * fps
    rises = scipy.ndimage.maximum_filter1d(np.abs(velocity[:, 1]), 2 * round(_EASES * fps) + 1, mode="nearest")
    speed = np.linalg.norm(_smooth(velocity[:, [0, 2]], _EASES, fps), axis=-1)
    walks = free * smoothstep(speed, *_WALKS) * smoothstep(result[:, 0, 1], *_UPRIGHT)
    walks *= 1 - smoothstep(rises, *_LEAPS)
    if walks.max() < 1e-3:
        return result
    apart = np.sum((result[:, LEGS[0][2]] - result[:, LEGS[1][2]]) * ahead, axis=-1)
    foot = _early(_smooth(apart, _STEADY, fps), round(_LEADS * fps))
    wanted = np.interp(_smooth(speed, _EASES, fps), _SPEEDS, _SWINGS)
    for side, (arm, width) in enumerate(zip(ARMS, _widths(seed), strict=True)):
        with_foot = foot if side else -foot  # the right arm goes with the left foot
        walking = walks * (1 - smoothstep(speed, *_RUNS)) * _below(result, arm, _RAISED, fps)
        _lower(result, arm, _smooth(walking, _EASES, fps), ahead, -left if side else left, fps)
        own = _own_swing(result[:, arm[2]] - result[:, arm[0]], with_foot, walks, ahead, fps)
        share = _smooth(walks * _below(result, arm, _HANGS, fps), _EASES / 2, fps)
        _swing(result, arm, share * np.maximum(width * wanted - own, 0.0) * with_foot, left)
    return result


def _widths(seed: int | Sequence[int]) -> tuple[float, float]:
    """The swing of the left and of the right arm of a person, as shares of the median."""
    rng = np.random.default_rng(seed)
    both, sides = np.exp(rng.uniform(*np.log(_PERSONS))), rng.uniform(*_SIDES)
    return float(both * np.exp(sides / 2)), float(both * np.exp(-sides / 2))


def _below(person: Array, arm: Sequence[int], span: tuple[float, float], fps: float) -> Array:
    """(T,) from 0 to 1 over a span of how far a hand is below its shoulder, and as little shortly before and after."""
    drop = (person[:, arm[0]] - person[:, arm[2]])[:, 1] / sum(SMPL22.bone_lengths[joint] for joint in arm[1:])
    share = smoothstep(drop, *span)
    return np.asarray(scipy.ndimage.minimum_filter1d(share, 2 * round(_EASES * fps) + 1, mode="nearest"))


def _lower(person: Array, arm: Sequence[int], share: Array, ahead: Array, out: Array, fps: float) -> None:
    """Has an arm of a person (T, 22, 3) hang by a share (T,), where it is carried through a stride."""
    shoulder, elbow, wrist = arm
    upper, lower = person[:, elbow] - person[:, shoulder], person[:, wrist] - person[:, elbow]
    bent = _bent(upper, lower)
    over = share * _LOWERS * np.maximum(_smooth(bent, _STRIDE, fps) - _BENT, 0.0)
    hinge = unit(np.cross(upper, lower))
    straighter: Array = _turned(lower, np.minimum(over, np.maximum(bent - _STRAIGHT, 0.0)), hinge)
    mean = unit(_smooth(unit(upper), _STRIDE, fps))
    down = np.maximum(-mean[:, 1], 0.1)
    tilts = [np.arctan2(np.sum(mean * way, axis=-1), down) for way in (out, ahead)]
    aims = [tilt - _LOWERS * np.maximum(tilt - most, 0.0) for tilt, most in zip(tilts, (_OUT, _AHEAD), strict=True)]
    aim = unit(np.tan(aims[0])[:, None] * out + np.tan(aims[1])[:, None] * ahead - _UP)
    axis = np.cross(mean, aim)
    sine = np.linalg.norm(axis, axis=-1)
    angle = -share * np.arctan2(sine, np.sum(mean * aim, axis=-1))
    axis = unit(axis)
    person[:, elbow] = person[:, shoulder] + _turned(upper, angle, axis)
    person[:, wrist] = person[:, elbow] + _turned(straighter, angle, axis)


def _bent(upper: Array, lower: Array) -> Array:
    """(T,) radians by which an elbow is bent."""
    return np.asarray(np.arccos(np.clip(np.sum(unit(upper) * unit(lower), axis=-1), -1.0, 1.0)))


def _own_swing(arm: Array, foot: Array, walks: Array, ahead: Array, fps: float) -> Array:
    """(T,) radians by which an arm (T, 3) swings already for each metre that its foot (T,) is ahead."""
    angle = np.arctan2(np.sum(arm * ahead, axis=-1), -arm[:, 1])
    swing, step = (each - _smooth(each, _STRIDE, fps) for each in (angle, foot))
    alike, size = (_smooth(walks * step * each, _STRIDE, fps) for each in (swing, step))
    return np.asarray(alike / (size + 1e-3))


def _swing(person: Array, arm: Sequence[int], angle: Array, left: Array) -> None:
    """Turns an arm of a person (T, 22, 3) forward by angles (T,) about the axis to the left (T, 3)."""
    shoulder, elbow, wrist = arm
    upper, lower = person[:, elbow] - person[:, shoulder], person[:, wrist] - person[:, elbow]
    flexed = np.maximum((_LOWER - _UPPER) * angle, np.minimum(_STRAIGHT - _bent(upper, lower), 0.0))
    person[:, elbow] = person[:, shoulder] + _turned(upper, _UPPER * angle, left)
    person[:, wrist] = person[:, elbow] + _turned(lower, _UPPER * angle + flexed, left)


def _turned(bone: Array, angle: Array, axis: Array) -> Array:
    """A bone (T, 3) turned back about axes (T, 3) by angles (T,)."""
    turns = scipy.spatial.transform.Rotation.from_rotvec(-angle[:, None] * axis)
    return np.asarray(turns.apply(bone))


def _early(values: Array, frames: int) -> Array:
    """Values (T,) so many frames before their time; the last one stays."""
    return values[np.minimum(np.arange(len(values)) + frames, len(values) - 1)]


def _smooth(values: Array, seconds: float, fps: float) -> Array:
    return np.asarray(scipy.ndimage.gaussian_filter1d(values, seconds * fps, axis=0, mode="nearest"))
