"""Feet that stand: contact detection, planting by analytic leg IK, nothing below the floor."""

from __future__ import annotations

import numpy as np
import scipy  # its parts are loaded with their first use
from numpy.typing import NDArray

from .easing import smoothstep
from .heels import heel_raised
from .skeleton import SMPL22, Skeleton
from .smoothing import REACH, frames_from, least_jerk, led
from .transforms import facing
from .vectors import runs, unit

Array = NDArray[np.floating]

# Heights below which a joint can stand on the floor, as in InterGen's contact features (metres).
ANKLE_HEIGHT, TOE_HEIGHT = 0.12, 0.05
# How much faster and higher than a standing joint must be one that has left the floor.
_LOOSE = 1.5
_SIDES = ("left", "right")
_BENT, _STRAIGHT, _STEADY = 0.12, 1e-3, 0.1
"""Metres of a joint beside the line of its limb from which its side is certain, the weight of the side of a straight
limb, and the weight of what was made against least jerk."""
_FOLDED = (0.15, 0.35)
"""Shares of a limb's length between its ends up to which it is folded, and from which it is not."""
_LEANS = 0.03
"""Metres by which the side of a limb leans towards the one to which people bend it."""
# A foot that drifts further than this within one contact was stepping or turning, not standing (metres).
_MAX_DRIFT = 0.25
# What a correction may move a joint from frame to frame (metres).
_MAX_STEP = 0.03
_REST_ANKLE = (0.03, 0.09)
_SOFT = 0.01
"""Share of a leg's length by which it is never straight: its knee would tremble."""


def foot_contacts(
    positions: Array, fps: float, *, speed: float = 0.4, skeleton: Skeleton = SMPL22
) -> NDArray[np.bool_]:
    """Detects the foot joints that stand on the floor.

    A joint stands where it is near the floor and slower than ``speed``, and goes on standing until it is
    clearly faster or higher, so that noise does not cut a contact. Gaps of up to two frames are closed,
    contacts shorter than three frames dropped.

    Args:
        positions: (T, J, 3) metres, floor at 0.
        fps: frames a second.
        speed: m/s; 0.4 suits generated motion, whose standing feet glide.

    Returns:
        (T, 4) bool: left ankle, left toe, right ankle, right toe.
    """
    feet = positions[:, _feet(skeleton)]
    heights = np.array([ANKLE_HEIGHT, TOE_HEIGHT] * 2)
    if len(feet) < 2:
        return feet[..., 1] < heights
    velocity = np.linalg.norm(np.gradient(feet, axis=0), axis=-1) * fps
    certain = (velocity < speed) & (feet[..., 1] < heights)
    possible = (velocity < _LOOSE * speed) & (feet[..., 1] < _LOOSE * heights)
    in_time = np.ones((3, 1))
    standing = scipy.ndimage.binary_propagation(certain, in_time, mask=possible)
    standing = np.pad(standing, ((2, 2), (0, 0)), mode="edge")
    standing = scipy.ndimage.binary_closing(standing, in_time)
    return scipy.ndimage.binary_opening(standing, in_time)[2:-2]


def plant_feet(
    positions: Array,
    contacts: NDArray[np.bool_],
    *,
    blend: int = 5,
    skeleton: Skeleton = SMPL22,
    held: NDArray[np.bool_] | None = None,
) -> Array:
    """Holds standing feet where they stand and keeps every foot above the floor.

    Through each contact the toe (or the ankle, where only that stands) is pinned to its median place on the
    floor; the correction fades in and out over ``blend`` frames. The leg follows by two-bone IK in the
    plane of the given knee. Where a pinned foot is out of reach the body sinks a little, smoothly.

    Args:
        positions: (T, J, 3) metres on a skeleton of constant bones, floor at 0.
        contacts: (T, 4) bool, as :func:`foot_contacts` gives.
        blend: frames over which a correction fades.
        held: (T,) frames that stay as they are. A contact beside them is pinned to its place there, and what is
            corrected fades towards them.

    Returns:
        (T, J, 3) with the bone lengths of the input.
    """
    result = np.array(positions, dtype=np.float64)
    stays = np.zeros(len(result), dtype=bool) if held is None else held
    ankles, toes = _goals(result, contacts, blend, stays, skeleton)
    # A leg is kept from being straight where its foot stands or is led to where it stands, and free frames stay free.
    near = smoothstep(1 - frames_from(np.asarray(contacts.any(axis=1))) / (REACH + 1))[:, None]
    soft = _SOFT * near * (1 - _fade(stays, blend))
    ankles = _over_toes(result, ankles, toes, soft, skeleton)
    sink = _needed_sink(result, ankles, soft, skeleton) * (1 - _fade(stays, blend)[:, 0])
    result[..., 1] -= sink[:, None]
    forward = facing(result, skeleton)
    for name, ankle_goal, toe_goal in zip(_SIDES, ankles, toes, strict=True):
        hip, knee, ankle, toe = (skeleton.index(f"{name}_{part}") for part in ("hip", "knee", "ankle", "foot"))
        new_knee, new_ankle = solve_two_bones(
            result[:, hip], result[:, knee], result[:, ankle], ankle_goal, forward, soft=soft
        )
        result[:, knee] = steadied(
            result[:, hip], new_knee, new_ankle, result[:, knee], forward, free=near[:, 0] * ~stays, hinged=True
        )
        result[:, ankle] = new_ankle
        result[:, toe] = toe_goal + (new_ankle - ankle_goal)
    result[stays] = positions[stays]
    return result


def solve_two_bones(
    root: Array, middle: Array, end: Array, goal: Array, pole: Array, *, soft: Array | float = 0.0
) -> tuple[Array, Array]:
    """Analytic IK of a limb of two bones.

    The middle joint of a limb that is nearly straight moves by centimetres where its end moves by a millimetre. With
    ``soft`` the last part of the reach is used up ever more slowly, and the limb is never quite straight (Nicholson
    2009, "Soft IK").

    Args:
        root, middle, end: (…, 3) the limb's joints; they give the bone lengths and the plane it bends in.
        goal: (…, 3) where the end should go; out of reach, it is drawn in along the line to the root.
        pole: (…, 3) the direction in which a straight limb bends.
        soft: share of the limb's length before its end that is softened, a number or (…, 1); the goal is missed by
            less than half of it.

    Returns:
        (…, 3) new middle joint, and (…, 3) new end.
    """
    upper = np.linalg.norm(middle - root, axis=-1, keepdims=True)
    lower = np.linalg.norm(end - middle, axis=-1, keepdims=True)
    reach = goal - root
    distance = np.linalg.norm(reach, axis=-1, keepdims=True)
    axis = reach / np.maximum(distance, 1e-9)
    margin = np.maximum(soft * (upper + lower), 1e-9)
    over = distance - (upper + lower - margin)
    distance = np.where(over > 0, upper + lower - margin * np.exp(-over.clip(0) / margin), distance)
    distance = np.clip(distance, np.abs(upper - lower) + 1e-6, upper + lower - 1e-6)
    along = (distance**2 + upper**2 - lower**2) / (2 * distance)
    aside = np.sqrt(np.maximum(upper**2 - along**2, 0.0))
    old_axis = end - root
    old_axis = unit(old_axis)
    bend = middle - root
    bend = bend - np.sum(bend * old_axis, axis=-1, keepdims=True) * old_axis
    # What the limb bends more than before goes towards the pole: the direction in which a nearly straight
    # limb bends is noise. A limb that need not bend more keeps its own.
    more = np.maximum(aside - np.linalg.norm(bend, axis=-1, keepdims=True), 0.0)
    bend = bend + more * pole
    bend = bend - np.sum(bend * axis, axis=-1, keepdims=True) * axis
    bend = unit(bend)
    return root + along * axis + aside * bend, root + distance * axis


def _feet(skeleton: Skeleton) -> list[int]:
    return [skeleton.index(f"{side}_{part}") for side in _SIDES for part in ("ankle", "foot")]


def _goals(
    positions: Array, contacts: NDArray[np.bool_], blend: int, held: NDArray[np.bool_], skeleton: Skeleton
) -> tuple[list[Array], list[Array]]:
    """Targets (T, 3) of the ankle and of the toe of each side."""
    ankles, toes = [], []
    for side, name in enumerate(_SIDES):
        ankle, toe = (positions[:, skeleton.index(f"{name}_{part}")] for part in ("ankle", "foot"))
        stands = contacts[:, 2 * side], contacts[:, 2 * side + 1]
        length = float(np.median(np.linalg.norm(toe - ankle, axis=-1)))
        ankle_goal, toe_goal = _foot_goals(ankle, toe, *stands, length, blend, held)
        ankles.append(ankle_goal)
        toes.append(toe_goal)
    return ankles, toes


def _foot_goals(
    ankle: Array,
    toe: Array,
    ankle_stands: NDArray[np.bool_],
    toe_stands: NDArray[np.bool_],
    foot_length: float,
    blend: int,
    held: NDArray[np.bool_],
) -> tuple[Array, Array]:
    """Targets of the ankle and the toe of one foot: (T, 3) each, at the distance of the bone's length."""
    toe_goal, toe_fixed = _pins(toe, toe_stands, blend, (0.0, 0.0), held)
    ankle_goal, ankle_fixed = _pins(ankle, ankle_stands, blend, _REST_ANKLE, held)
    # The foot first moves as a whole: where only one end is pinned, the other goes with it.
    share = np.stack([toe_fixed, ankle_fixed], axis=-1).astype(np.float64)
    wanted = share[:, :1] * (toe_goal - toe) + share[:, 1:] * (ankle_goal - ankle)
    middle = (toe + ankle) / 2
    pinned = middle + wanted / np.maximum(share.sum(axis=-1, keepdims=True), 1.0)
    moved = led(pinned, toe_fixed | ankle_fixed) - middle
    new_toe = led(np.where(toe_fixed[:, None], toe_goal, toe + moved), toe_fixed)
    new_ankle = led(np.where(ankle_fixed[:, None], ankle_goal, ankle + moved), ankle_fixed)
    for place, floor in ((new_toe, 0.0), (new_ankle, _REST_ANKLE[0])):
        lift = np.maximum(floor - place[:, 1], 0.0)
        place[:, 1] += _smooth(lift, blend) * (1 - _fade(held, blend)[:, 0]) if held.any() else lift
    bone = new_ankle - new_toe
    bone *= foot_length / np.maximum(np.linalg.norm(bone, axis=-1, keepdims=True), 1e-9)
    # The toe's place wins where both stand: a heel may lift, a toe must not glide.
    return new_toe + bone, new_toe


def _pins(
    joint: Array, stands: NDArray[np.bool_], blend: int, heights: tuple[float, float], held: NDArray[np.bool_]
) -> tuple[Array, NDArray[np.bool_]]:
    """Places (T, 3) of a joint that is still through each contact, and the frames (T,) at which it has to be there."""
    goal, fixed = np.array(joint), np.zeros(len(joint), dtype=bool)
    kept: list[tuple[int, int]] = []
    for start, stop in runs(stands & ~held):
        kept.extend(_split(joint, start, stop, blend))
    for start, stop in kept:
        goal[start:stop] = _goal(joint, start, stop, stands & held, heights)
    for start, stop in _with_room_to_step(goal - joint, sorted([*kept, *runs(held)]), held, stands & held):
        fixed[start:stop] = True
    goal[~fixed] = joint[~fixed]
    return goal, fixed


def _goal(joint: Array, start: int, stop: int, stood: NDArray[np.bool_], heights: tuple[float, float]) -> Array:
    """(1 or stop - start, 3) places of a joint in a contact: where it ``stood`` (T,) beside it, or its median."""
    beside = [joint[i] for i in (start - 1, stop) if 0 <= i < len(joint) and stood[i]]
    if not beside:
        goal: Array = np.median(joint[start:stop], axis=0)
        goal[1] = np.clip(goal[1], *heights)
        return goal[None]
    share = smoothstep(np.arange(1, stop - start + 1) / (stop - start + 1))[:, None]
    return beside[0] + share * (beside[-1] - beside[0])


def _with_room_to_step(
    shift: Array, contacts: list[tuple[int, int]], held: NDArray[np.bool_], stood: NDArray[np.bool_]
) -> list[tuple[int, int]]:
    """Shortens contacts that follow each other so closely that the correction between them would jump.

    Runs of ``held`` frames are left, a contact that goes on from where the joint ``stood`` in them, too; another one
    beside them may vanish.
    """
    contacts = list(contacts)
    for index in range(len(contacts) - 1):
        (start, stop), (next_start, next_stop) = contacts[index : index + 2]
        change = shift[next_start] - shift[stop - 1]
        # Smoothstep is one and a half times as steep in its middle as on average.
        missing = int(np.ceil(1.5 * np.linalg.norm(change) / _MAX_STEP)) - (next_start - stop)
        if missing <= 0 or (next_start == stop and (stood[stop - 1] or stood[next_start])):
            continue
        if held[stop - 1]:
            contacts[index + 1] = (min(next_start + missing, next_stop), next_stop)
        elif held[next_start]:
            contacts[index] = (start, max(stop - missing, start))
        else:
            half = (missing + 1) // 2
            contacts[index] = (start, max(stop - half, start + 1))
            contacts[index + 1] = (min(next_start + half, next_stop - 1), next_stop)
    return [(start, stop) for start, stop in contacts if start < stop]


def _split(joint: Array, start: int, stop: int, blend: int) -> list[tuple[int, int]]:
    """Cuts a contact in which the joint drifts far into shorter ones, with room between to step."""
    inside = joint[start:stop]
    if np.ptp(inside, axis=0)[[0, 2]].max() <= _MAX_DRIFT:
        return [(start, stop)]
    if stop - start < 3 * blend:
        return []
    middle = (start + stop) // 2
    return _split(joint, start, middle - blend // 2, blend) + _split(joint, middle + (blend + 1) // 2, stop, blend)


def _fade(stands: NDArray[np.bool_], blend: int) -> Array:
    """(T, 1) 1 through contacts, easing to 0 over ``blend`` frames outside."""
    if not stands.any():
        return np.zeros((len(stands), 1))
    index = np.arange(len(stands))
    on = np.flatnonzero(stands)
    after = np.searchsorted(on, index).clip(0, len(on) - 1)
    before = (np.searchsorted(on, index, side="right") - 1).clip(0)
    distance = np.minimum(np.abs(on[after] - index), np.abs(index - on[before]))
    return smoothstep(1 - distance / (blend + 1))[:, None]


def _over_toes(
    positions: Array, ankles: list[Array], toes: list[Array], soft: Array, skeleton: Skeleton
) -> list[Array]:
    """Targets (T, 3) of both ankles, with heels that rise where a foot behind is out of reach."""
    return [
        heel_raised(hip, ankle, toe, reach)
        for (hip, reach), ankle, toe in zip(_reaches(positions, soft, skeleton), ankles, toes, strict=True)
    ]


def _reaches(positions: Array, soft: Array, skeleton: Skeleton) -> list[tuple[Array, Array]]:
    """The hip (T, 3) and the metres (T, 1) that a leg reaches, of each side."""
    found = []
    for name in _SIDES:
        hip, knee, ankle = (positions[:, skeleton.index(f"{name}_{part}")] for part in ("hip", "knee", "ankle"))
        leg = np.linalg.norm(knee - hip, axis=-1) + np.linalg.norm(ankle - knee, axis=-1)
        found.append((hip, (1 - soft) * leg[:, None] - 1e-3))
    return found


def _needed_sink(positions: Array, ankles: list[Array], soft: Array, skeleton: Skeleton) -> Array:
    """(T,) metres the body must go down for both legs to reach their goals, at most 0.12, smooth."""
    need = np.zeros(len(positions))
    for (hip, leg), goal in zip(_reaches(positions, soft, skeleton), ankles, strict=True):
        aside = hip - goal
        height = np.sqrt(np.maximum(leg[:, 0] ** 2 - aside[:, 0] ** 2 - aside[:, 2] ** 2, 0.0))
        need = np.maximum(need, aside[:, 1] - height)
    need = np.clip(need, 0.0, 0.12)
    if len(need) < 3 or not need.any():
        return need
    return _smooth(need, 2)


def _smooth(need: Array, reach: int) -> Array:
    """(T,) at least about ``need`` (T,), without kinks; it begins some 3 * ``reach`` frames earlier."""
    widened = scipy.ndimage.maximum_filter1d(need, 2 * reach + 1, mode="nearest")
    return scipy.ndimage.gaussian_filter1d(widened, 0.75 * reach, mode="nearest")


def steadied(
    root: Array,
    middle: Array,
    end: Array,
    guide: Array,
    pole: Array,
    *,
    free: Array | float = 1.0,
    hinged: bool = False,
) -> Array:
    """(T, 3) the middle joints of a limb, turned about the line between its ends so that they go round it smoothly.

    Where a limb is nearly straight, the side to which it bends is noise, and its middle joint jumps from one side to
    the other. There the side follows from the frames around it, and more and more from the pole.

    Args:
        root, middle, end: (T, 3) the limb's joints.
        guide: (T, 3) where the middle joint was seen, on bones of any length.
        pole: (T, 3) the direction in which a straight limb bends.
        free: (T,) from 1, where the joint may move, to 0, where it stays.
        hinged: the limb bends towards the pole alone, as a knee does: a joint seen on the other side is mirrored.
    """
    axis = end - root
    axis = unit(axis)
    along = _along(middle - root, axis)
    aside = np.linalg.norm(middle - root - along, axis=-1, keepdims=True)
    share = np.broadcast_to(np.asarray(free, dtype=np.float64), (len(root),))[:, None]
    share = share * open_limb(root, middle, end)
    out = guide - root - _along(guide - root, axis)
    if hinged:
        towards = pole - _along(pole, axis)
        out += 2 * np.maximum(-np.sum(out * towards, axis=-1, keepdims=True), 0.0) * towards
    out = share * (out + _LEANS * (pole - _along(pole, axis))) + (1 - share) * (middle - root - along)
    length = np.linalg.norm(out, axis=-1, keepdims=True)
    side = out / np.maximum(length, 1e-9)
    sure = np.clip((length[:, 0] / _BENT) ** 2, _STRAIGHT, 1.0) * _STEADY
    side = least_jerk(side, np.where(share[:, 0] > 0, sure, 1e6))
    side = side - _along(side, axis)
    length = np.linalg.norm(side, axis=-1, keepdims=True)
    found = root + along + aside * side / np.maximum(length, 1e-9)
    return np.where((length > 0.1) & (share > 0), found, middle)


def open_limb(root: Array, middle: Array, end: Array) -> Array:
    """(…, 1) from 0, where a limb is folded so far that the line between its ends has no direction, to 1."""
    length = np.linalg.norm(middle - root, axis=-1) + np.linalg.norm(end - middle, axis=-1)
    reach = np.linalg.norm(end - root, axis=-1) / np.maximum(length, 1e-9)
    return smoothstep((reach - _FOLDED[0]) / (_FOLDED[1] - _FOLDED[0]))[..., None]


def _along(vector: Array, axis: Array) -> Array:
    return np.asarray(np.sum(vector * axis, axis=-1, keepdims=True) * axis)
