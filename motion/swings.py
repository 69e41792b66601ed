"""Feet in the air swing as people's do, and bodies that lie stay above the floor."""

from __future__ import annotations

import numpy as np
import scipy  # its parts are loaded with their first use
from numpy.typing import NDArray

from .limbs import solve_two_bones
from .skeleton import ARMS, LEGS, SMPL22
from .smoothing import begun_before, frames_from, least_jerk, smoothstep
from .transforms import facing
from .vectors import FLAT, Array, floor_speed, runs, square_to, unit

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


def lift_swinging_feet(positions: Array, fps: float) -> Array:
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
    forward = facing(result)
    hips = floor_speed(result[:, 0], fps)
    for *_, ankle, toe in LEGS:
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
    return np.where(moved[:, None], ankle + unit(bone) * length, toe)


def _heights(toe: Array, hips: Array, upright: NDArray[np.bool_], forward: Array, fps: float) -> Array:
    """(T,) heights that a toe (T, 3) should have at least; none where it does not swing."""
    speed, heights = floor_speed(toe, fps), np.full(len(toe), -np.inf)
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
        heights[frames] = np.maximum(heights[frames], lift + rest)
    return heights


def _raised(ankle: Array, toe: Array, lift: Array, forward: Array) -> Array:
    """(T, 3) places of a toe (T, 3) that is turned about its ankle and so raised by ``lift`` (T,) metres."""
    bone = toe - ankle
    length = np.linalg.norm(bone, axis=-1)
    drop = np.clip(-bone[:, 1] - lift, -0.5 * length, length)
    along = bone * FLAT
    # A foot that hangs straight down has no direction of its own.
    along += np.maximum(_HANGS - np.linalg.norm(along, axis=-1, keepdims=True), 0.0) * forward
    turned = ankle + unit(along) * np.sqrt(np.maximum(length**2 - drop**2, 0.0))[:, None]
    turned[:, 1] = ankle[:, 1] - drop
    return np.where((lift > _LEAST)[:, None], turned, toe)


# ---- Bodies that lie, fall and get up --------------------------------------------------------------------------------
_DEEP = {
    "pelvis": 0.08,
    "hip": 0.05,
    "spine1": 0.07,
    "spine2": 0.07,
    "spine3": 0.07,
    "neck": 0.05,
    "head": 0.07,
    "collar": 0.05,
    "shoulder": 0.05,
}
"""Metres from the joints of the trunk and the head, of either side, to the skin of a body that lies."""
_TRUNK = {j: _DEEP[part] for j, name in enumerate(SMPL22.joint_names) if (part := name.split("_")[-1]) in _DEEP}
_THIN = 0.03
"""The same for elbows, wrists and knees."""
_REACH = 4
"""Frames over which a body is raised and let down again."""
_FLIP = 0.8
"""Change of an elbow's direction from its arm, from frame to frame, at which it goes to the other side."""
_OVER = 8
"""Frames before and after in which it goes over the top instead."""
_LOOSE, _STAYS = 1e-3, 1e6
"""Weights of its direction against least jerk there, and elsewhere."""


def above_floor(positions: Array) -> Array:
    """Raises a body whose trunk is in the floor, and turns limbs that are in it about their ends.

    A body that stays above the floor is not changed. Feet are left to :func:`motion.cleaning.plant_feet`.

    Args:
        positions: (T, J, 3) metres on constant bones, floor at 0.

    Returns:
        (T, J, 3) with the bone lengths of the input.
    """
    result = np.array(positions, dtype=np.float64)
    need = np.max(np.array([*_TRUNK.values()]) - result[:, [*_TRUNK], 1], axis=1).clip(min=0.0)
    if need.any():
        result[..., 1] += begun_before(need, _REACH, 0.5 * _REACH)[:, None]
    for root, middle, wrist in ARMS:
        goal = result[:, wrist].copy()
        goal[:, 1] = np.maximum(goal[:, 1], _THIN)
        moved = goal[:, 1] > result[:, wrist, 1]
        up = np.broadcast_to([0.0, 1.0, 0.0], goal.shape)
        bent, met = solve_two_bones(result[:, root], result[:, middle], result[:, wrist], goal, up)
        result[moved, middle], result[moved, wrist] = bent[moved], met[moved]
    for root, middle, end, *_ in (*ARMS, *LEGS):
        result[:, middle] = _turned_up(result[:, root], result[:, middle], result[:, end])
    return result


def _turned_up(root: Array, middle: Array, end: Array) -> Array:
    """(T, 3) the middle joint of a limb, turned about the line between its ends until it is above the floor.

    One that went to the limb's other side under the floor goes there over its top.
    """
    low = middle[:, 1] < _THIN
    if not low.any():
        return middle
    axis = unit(end - root)
    out = square_to(middle - root, axis)
    on_axis, aside = middle - out, np.linalg.norm(out, axis=-1)
    rising = square_to(np.broadcast_to([0.0, 1.0, 0.0], axis.shape), axis)
    top = unit(rising)
    side = np.cross(axis, top)
    rises = (_THIN - on_axis[:, 1]) / np.maximum(aside * top[:, 1], 1e-9)
    room = np.arccos(np.clip(rises, -1.0, 1.0))

    def above(way: Array) -> Array:
        angle = np.clip(np.arctan2(np.sum(way * side, axis=-1), np.sum(way * top, axis=-1)), -room, room)[:, None]
        return np.cos(angle) * top + np.sin(angle) * side

    way = above(out)
    flips = (np.linalg.norm(np.diff(way, axis=0, prepend=way[:1]), axis=-1) > _FLIP) & (low | np.roll(low, 1))
    over = smoothstep(1 - frames_from(flips) / (_OVER + 1)) if flips.any() else np.zeros(len(way))
    if flips.any():
        way = above(least_jerk(way, np.where(over > 0, _LOOSE, _STAYS)) + 2 * over[:, None] * rising)
    return np.where((low | (over > 0))[:, None], on_axis + aside[:, None] * way, middle)
