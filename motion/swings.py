"""Feet in the air: toes that rise over the floor as those of people do who walk."""

from __future__ import annotations

import numpy as np
import scipy  # its parts are loaded with their first use
from numpy.typing import NDArray

from motion.vectors import runs

from .skeleton import SMPL22, Skeleton
from .smoothing import least_jerk
from .transforms import facing
from .vectors import unit

Array = NDArray[np.floating]

_FAST = 0.6
"""Metres a second on the floor from which a foot swings."""
_TIME = (0.15, 0.8)
"""Seconds that a swing takes."""
_SHORT, _LONG = 0.15, 1.5
"""Metres of a swing: a shorter one is no step, and a toe rises no higher over a longer one."""
_OVERTAKES = 1.4
"""Times the speed of the hips that a foot reaches at least in its swing; a slower one glides along with the body."""
_SOFT = 0.035
"""Seconds over which what is raised begins and ends."""
_LEAST = 1e-4
"""Metres by which a toe is raised at least."""
_SOFT_TURN = 0.3
"""Weight of the raised toe against least jerk: a foot that hung behind its ankle comes forward in 0.1 s."""
_HANGS = 0.03
"""Metres over the floor between ankle and toe below which a foot hangs."""
_UPRIGHT = 0.6
"""Metres of the pelvis above the floor of those who walk."""
# Medians of 3,600 steps at walking pace in the Bandai-Namco recordings: from a fifth of the swing's time before it to a
# fifth after it, the height of the toe over where it stands, per metre of the swing. The toe hangs behind the heel,
# passes closest to the floor, and is up when the heel comes down (as in Winter 1992, "Foot trajectory in human gait").
_PHASES = np.linspace(-0.2, 1.2, 15)
_FORWARDS = np.array([0, 8, 35, 63, 70, 60, 43, 28, 20, 23, 38, 43, 24, 3, 0]) / 1000
_ASIDE = np.array([0, 5, 20, 35, 42, 45, 45, 42, 36, 30, 24, 17, 9, 2, 0]) / 1000


def lift_swinging_feet(positions: Array, fps: float, *, skeleton: Skeleton = SMPL22) -> Array:
    """Raises the toes of feet that swing to the height that people's have, where they are lower.

    Only toes move, about their ankles. Feet that stand, people who lie or crawl, and feet that glide along with the
    body stay as they are.

    Args:
        positions: (T, J, 3) metres, floor at 0.
        fps: frames a second.

    Returns:
        (T, J, 3) with the bone lengths of the input.
    """
    result = np.array(positions, dtype=np.float64)
    if len(result) < 3:
        return result
    forward = facing(result, skeleton)
    hips = _speed(result[:, 0], fps)
    for side in ("left", "right"):
        ankle, toe = (skeleton.index(f"{side}_{part}") for part in ("ankle", "foot"))
        height = _heights(result[:, toe], hips, result[:, 0, 1] > _UPRIGHT, forward, fps)
        lift = np.maximum(height - result[:, toe, 1], 0.0)
        lift = scipy.ndimage.gaussian_filter1d(lift, _SOFT * fps, mode="nearest")
        raised = _raised(result[:, ankle], result[:, toe], lift, forward)
        result[:, toe] = _turned(result[:, ankle], result[:, toe], raised, lift > _LEAST)
    return result


def _turned(ankle: Array, toe: Array, raised: Array, moved: NDArray[np.bool_]) -> Array:
    """(T, 3) a toe that goes to where it is ``raised`` and back no faster than feet turn."""
    if not moved.any():
        return toe
    bone = least_jerk(np.where(moved[:, None], raised, toe) - ankle, np.where(moved, _SOFT_TURN, 1e7))
    length = np.linalg.norm(toe - ankle, axis=-1, keepdims=True)
    turned = ankle + bone * length / np.maximum(np.linalg.norm(bone, axis=-1, keepdims=True), 1e-9)
    return np.where(moved[:, None], turned, toe)


def _heights(toe: Array, hips: Array, upright: NDArray[np.bool_], forward: Array, fps: float) -> Array:
    """(T,) heights that a toe (T, 3) should have at least; none where it does not swing."""
    speed, found = _speed(toe, fps), np.full(len(toe), -np.inf)
    for start, stop in runs(speed > _FAST):
        way = toe[stop - 1] - toe[start]
        way[1] = 0.0
        length = float(np.linalg.norm(way))
        inside = slice(start, stop)
        if (
            not _TIME[0] <= (stop - start) / fps <= _TIME[1]
            or length < _SHORT
            or not upright[inside].all()
            or speed[inside].max() < _OVERTAKES * hips[inside].mean()
        ):
            continue
        ahead = float(np.clip(way @ forward[inside].mean(0) / length, 0.0, 1.0))
        first = max(int(np.ceil(start - 0.5 + _PHASES[0] * (stop - start))), 0)
        last = min(int(np.floor(start - 0.5 + _PHASES[-1] * (stop - start))), len(toe) - 1)
        frames = np.arange(first, last + 1)
        profile = scipy.interpolate.PchipInterpolator(_PHASES, ahead * _FORWARDS + (1 - ahead) * _ASIDE)
        lift = min(length, _LONG) * profile((frames + 0.5 - start) / (stop - start))
        rest = np.interp(frames, [first, last], [toe[first, 1], toe[last, 1]])
        found[frames] = np.maximum(found[frames], lift + rest)
    return found


def _raised(ankle: Array, toe: Array, lift: Array, forward: Array) -> Array:
    """(T, 3) places of a toe (T, 3) that is turned about its ankle and so raised by ``lift`` (T,) metres."""
    bone = toe - ankle
    length = np.linalg.norm(bone, axis=-1)
    drop = np.clip(-bone[:, 1] - lift, -0.5 * length, length)
    along = bone * [1.0, 0.0, 1.0]
    # A foot that hangs straight down has no direction of its own.
    along += np.maximum(_HANGS - np.linalg.norm(along, axis=-1, keepdims=True), 0.0) * forward
    along = unit(along)
    turned = ankle + along * np.sqrt(np.maximum(length**2 - drop**2, 0.0))[:, None]
    turned[:, 1] = ankle[:, 1] - drop
    return np.where((lift > _LEAST)[:, None], turned, toe)


def _speed(place: Array, fps: float) -> Array:
    """(T,) metres a second over the floor."""
    return np.linalg.norm(np.gradient(place[:, [0, 2]], axis=0), axis=-1) * fps
