"""Feet that stand: contact detection, planting by analytic leg IK, nothing below the floor."""

from __future__ import annotations

import numpy as np
import scipy  # its parts are loaded with their first use
from numpy.typing import NDArray

from .limbs import heel_raised, limb_length, sink, solve_two_bones, steadied
from .representation import CONTACT_HEIGHTS
from .skeleton import FEET, LEGS
from .smoothing import REACH, begun_before, frames_from, led, smoothstep
from .transforms import facing
from .vectors import Array, runs, unit

# How much faster and higher than a standing joint must be one that has left the floor.
_LOOSE = 1.5
# A foot that drifts further than this within one contact was stepping or turning, not standing (metres).
_MAX_DRIFT = 0.25
# What a correction may move a joint from frame to frame (metres).
_MAX_STEP = 0.03
_SINKS = 0.02
"""Metres by which a body goes down at most for its legs to reach."""
_REST_ANKLE = (0.03, 0.09)
_SOFT = 0.01
"""Share of a leg's length by which it is never straight: its knee would tremble."""


def foot_contacts(positions: Array, fps: float, *, speed: float = 0.4) -> NDArray[np.bool_]:
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
    feet = positions[:, list(FEET)]
    if len(feet) < 2:
        return np.asarray(feet[..., 1] < CONTACT_HEIGHTS)
    velocity = np.linalg.norm(np.gradient(feet, axis=0), axis=-1) * fps
    certain = (velocity < speed) & (feet[..., 1] < CONTACT_HEIGHTS)
    possible = (velocity < _LOOSE * speed) & (feet[..., 1] < _LOOSE * CONTACT_HEIGHTS)
    in_time = np.ones((3, 1))
    standing = scipy.ndimage.binary_propagation(certain, in_time, mask=possible)
    standing = np.pad(standing, ((2, 2), (0, 0)), mode="edge")
    standing = scipy.ndimage.binary_closing(standing, in_time)
    return scipy.ndimage.binary_opening(standing, in_time)[2:-2]


def plant_feet(
    positions: Array, contacts: NDArray[np.bool_], *, blend: int = 5, held: NDArray[np.bool_] | None = None
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
    ankles, toes = _goals(result, contacts, blend, stays)
    # A leg is kept from being straight where its foot stands or is led to where it stands, and free frames stay free.
    near = smoothstep(1 - frames_from(np.asarray(contacts.any(axis=1))) / (REACH + 1))[:, None]
    soft = _SOFT * near * (1 - _fade(stays, blend))
    hips = [result[:, leg[0]] for leg in LEGS]
    reaches = [(1 - soft) * limb_length(result, leg)[:, None] - 1e-3 for leg in LEGS]
    ankles = [heel_raised(*leg) for leg in zip(hips, ankles, toes, reaches, strict=True)]
    need = begun_before(sink(hips, ankles, reaches, _SINKS), 2, 1.5)
    result[..., 1] -= need[:, None] * (1 - _fade(stays, blend))
    forward = facing(result)
    for (hip, knee, ankle, toe), ankle_goal, toe_goal in zip(LEGS, ankles, toes, strict=True):
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


def _goals(
    positions: Array, contacts: NDArray[np.bool_], blend: int, held: NDArray[np.bool_]
) -> tuple[list[Array], list[Array]]:
    """Targets (T, 3) of the ankle and of the toe of each side."""
    ankles, toes = [], []
    for side, leg in enumerate(LEGS):
        ankle, toe = (positions[:, joint] for joint in leg[2:])
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
        place[:, 1] += begun_before(lift, blend, 0.75 * blend) * (1 - _fade(held, blend)[:, 0]) if held.any() else lift
    # The toe's place wins where both stand: a heel may lift, a toe must not glide.
    return new_toe + unit(new_ankle - new_toe) * foot_length, new_toe


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
    for start, stop in _with_room_to_step(
        goal - joint, sorted([*kept, *(runs(held) if held.any() else ())]), held, stands & held
    ):
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
    return smoothstep(1 - frames_from(stands) / (blend + 1))[:, None] * stands.any()
