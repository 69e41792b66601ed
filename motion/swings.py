"""Limbs of people who walk: feet in the air and arms swing as people's do; and bodies that lie stay above the floor."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy  # its parts are loaded with their first use
from numpy.typing import NDArray

from .limbs import solve_two_bones
from .skeleton import ARMS, LEGS, SMPL22
from .smoothing import begun_before, least_jerk, smoothstep
from .transforms import facing
from .vectors import Array, floor_speed, runs, unit

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
    turned = ankle + bone * length / np.maximum(np.linalg.norm(bone, axis=-1, keepdims=True), 1e-9)
    return np.where(moved[:, None], turned, toe)


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
    along = bone * [1.0, 0.0, 1.0]
    # A foot that hangs straight down has no direction of its own.
    along += np.maximum(_HANGS - np.linalg.norm(along, axis=-1, keepdims=True), 0.0) * forward
    along = unit(along)
    turned = ankle + along * np.sqrt(np.maximum(length**2 - drop**2, 0.0))[:, None]
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
_LIMBS = (("shoulder", "elbow", "wrist"), ("hip", "knee", "ankle"))
_THIN = 0.03
"""The same for elbows, wrists and knees."""
_REACH = 4
"""Frames over which a body is raised and let down again."""
_HALVINGS = 12


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
    for parts in _LIMBS:
        for side in ("left", "right"):
            root, middle, end = (SMPL22.index(f"{side}_{part}") for part in parts)
            if parts[-1] == "wrist":
                goal = result[:, end].copy()
                goal[:, 1] = np.maximum(goal[:, 1], _THIN)
                moved = goal[:, 1] > result[:, end, 1]
                up = np.broadcast_to([0.0, 1.0, 0.0], goal.shape)
                bent, met = solve_two_bones(result[:, root], result[:, middle], result[:, end], goal, up)
                result[moved, middle], result[moved, end] = bent[moved], met[moved]
            result[:, middle] = _turned_up(result[:, root], result[:, middle], result[:, end])
    return result


def _turned_up(root: Array, middle: Array, end: Array) -> Array:
    """(T, 3) the middle joint of a limb, turned about the line between its ends until it is above the floor."""
    low = middle[:, 1] < _THIN
    if not low.any():
        return middle
    axis = end - root
    axis = unit(axis)
    on_axis = root + np.sum((middle - root) * axis, axis=-1, keepdims=True) * axis
    out = middle - on_axis
    aside = np.linalg.norm(out, axis=-1, keepdims=True)
    up = np.array([0.0, 1.0, 0.0]) - axis[:, 1:2] * axis
    up = unit(up) * aside
    low_share, high_share = np.zeros((len(root), 1)), np.ones((len(root), 1))
    for _ in range(_HALVINGS):
        share = (low_share + high_share) / 2
        under = _between(out, up, aside, share)[:, 1:2] + on_axis[:, 1:2] < _THIN
        low_share, high_share = np.where(under, share, low_share), np.where(under, high_share, share)
    return np.where(low[:, None], on_axis + _between(out, up, aside, high_share), middle)


def _between(first: Array, second: Array, length: Array, share: Array) -> Array:
    """(T, 3) vectors between two others, as long as they are."""
    mixed = first + share * (second - first)
    return unit(mixed) * length


# ---- Arms of people who walk: they swing against the legs, as wide as people's do at that speed ----------------------
# A network that is held to a way over the floor has the arms in time with the steps, but hardly moves them. What is
# missing is added: an arm goes forward with the other side's foot, by degrees a metre that its ankle is ahead. Swing
# and steps so begin and end together, and an arm that swings as far as people's already stays as it is. Arms that the
# network carries out to the side, or bent before the chest as runners do, hang first.

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
_ON_FEET = (0.7, 0.8)
"""Heights of the pelvis in metres: a person below the first is low, and one above the second walks upright."""
_LEAPS = (0.4, 0.8)
"""Vertical speeds of the pelvis in m/s: below the first a person walks, above the second they jump or get up."""
_HANGING, _RAISED = (0.35, 0.6), (-0.3, 0.0)
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
    walks = free * smoothstep(speed, *_WALKS) * smoothstep(result[:, 0, 1], *_ON_FEET)
    walks *= 1 - smoothstep(rises, *_LEAPS)
    if walks.max() < 1e-3:
        return result
    apart = np.sum((result[:, LEGS[0][2]] - result[:, LEGS[1][2]]) * ahead, axis=-1)
    later = np.minimum(np.arange(len(apart)) + round(_LEADS * fps), len(apart) - 1)
    foot = _smooth(apart, _STEADY, fps)[later]  # an arm is ahead of its foot
    wanted = np.interp(_smooth(speed, _EASES, fps), _SPEEDS, _SWINGS)
    for side, (arm, width) in enumerate(zip(ARMS, _widths(seed), strict=True)):
        with_foot = foot if side else -foot  # the right arm goes with the left foot
        walking = walks * (1 - smoothstep(speed, *_RUNS)) * _below(result, arm, _RAISED, fps)
        _lower(result, arm, _smooth(walking, _EASES, fps), ahead, -left if side else left, fps)
        own = _own_swing(result[:, arm[2]] - result[:, arm[0]], with_foot, walks, ahead, fps)
        share = _smooth(walks * _below(result, arm, _HANGING, fps), _EASES / 2, fps)
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
    straighter: Array = _turned_back(lower, np.minimum(over, np.maximum(bent - _STRAIGHT, 0.0)), hinge)
    mean = unit(_smooth(unit(upper), _STRIDE, fps))
    down = np.maximum(-mean[:, 1], 0.1)
    tilts = [np.arctan2(np.sum(mean * way, axis=-1), down) for way in (out, ahead)]
    aims = [tilt - _LOWERS * np.maximum(tilt - most, 0.0) for tilt, most in zip(tilts, (_OUT, _AHEAD), strict=True)]
    aim = unit(np.tan(aims[0])[:, None] * out + np.tan(aims[1])[:, None] * ahead - _UP)
    axis = np.cross(mean, aim)
    sine = np.linalg.norm(axis, axis=-1)
    angle = -share * np.arctan2(sine, np.sum(mean * aim, axis=-1))
    axis = unit(axis)
    person[:, elbow] = person[:, shoulder] + _turned_back(upper, angle, axis)
    person[:, wrist] = person[:, elbow] + _turned_back(straighter, angle, axis)


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
    person[:, elbow] = person[:, shoulder] + _turned_back(upper, _UPPER * angle, left)
    person[:, wrist] = person[:, elbow] + _turned_back(lower, _UPPER * angle + flexed, left)


def _turned_back(bone: Array, angle: Array, axis: Array) -> Array:
    """A bone (T, 3) turned back about axes (T, 3) by angles (T,)."""
    turns = scipy.spatial.transform.Rotation.from_rotvec(-angle[:, None] * axis)
    return np.asarray(turns.apply(bone))


def _smooth(values: Array, seconds: float, fps: float) -> Array:
    return np.asarray(scipy.ndimage.gaussian_filter1d(values, seconds * fps, axis=0, mode="nearest"))
