"""Detects planted feet and keeps them where they landed, by IK of the legs; blends poses."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d, maximum_filter1d
from scipy.spatial.transform import Rotation

from motion.limbs import solve_two_bones
from motion.skeleton import LEGS, SMPL22
from motion.smoothing import minimum_jerk
from motion.transforms import heading
from motion.vectors import runs

Array = NDArray[np.floating]
FPS = 30


def planted(positions: Array) -> NDArray[np.bool_]:
    """(T, 2) True where a foot rests on the floor: the toe under 5.5 cm and slower than 0.3 m/s.

    Gaps and runs shorter than four frames are closed and dropped.
    """
    toes = positions[:, [LEGS[0][3], LEGS[1][3]]]
    moving = np.linalg.norm(np.gradient(gaussian_filter1d(toes, 1.0, axis=0), axis=0)[..., [0, 2]], axis=-1)
    resting = (toes[..., 1] - np.percentile(toes[..., 1], 3) < 0.055) & (moving * FPS < 0.3)
    for foot in range(2):
        for value in (True, False):  # first close gaps, then drop short runs
            for start, stop in runs(resting[:, foot] != value):
                if stop - start < 4 and start > 0 and stop < len(resting):
                    resting[start:stop, foot] = value
    return resting


def plant_feet(positions: Array, contacts: NDArray[np.bool_], *, stride: float = 0.18) -> Array:
    """Holds every planted foot where it landed by bending the leg; bones keep their length.

    A "planted" foot that travels more than ``stride`` metres (a blend between two stances) takes a step
    instead of sliding. The body sinks a little where a leg would otherwise be too short.

    Args:
        positions: (T, 22, 3) metres.
        contacts: (T, 2) left and right foot planted.
    """
    positions = positions.copy()
    toes = [positions[:, leg[3]] for leg in LEGS]
    steps = one_after_the_other([steps_in(toes[f], contacts[:, f], stride=stride) for f in (0, 1)])
    targets = []
    for foot, (_, _, ankle, toe) in enumerate(LEGS):
        shift = foot_shift(toes[foot], contacts[:, foot], steps[foot])
        below = np.maximum(-toes[foot][:, 1], 0.04 - positions[:, ankle, 1])
        shift[:, 1] += gaussian_filter1d(np.maximum(below, 0), 1.5)
        targets.append(positions[:, [ankle, toe]] + shift[:, None])
    sink = np.zeros(len(positions))
    for target, (hip, knee, ankle, _) in zip(targets, LEGS, strict=True):
        longest = 0.998 * (SMPL22.bone_lengths[knee] + SMPL22.bone_lengths[ankle])
        gap = positions[:, hip] - target[:, 0]
        height = np.sqrt(np.maximum(longest**2 - gap[:, 0] ** 2 - gap[:, 2] ** 2, 0.3))
        sink = np.maximum(sink, gap[:, 1] - height)
    positions[..., 1] -= gaussian_filter1d(maximum_filter1d(np.clip(sink, 0, 0.15), 9), 3.0)[:, None]
    forward = np.stack([np.sin(heading(positions)), np.zeros(len(positions)), np.cos(heading(positions))], -1)
    for target, (hip, knee, ankle, toe) in zip(targets, LEGS, strict=True):
        positions[:, knee], positions[:, ankle] = solve_two_bones(
            positions[:, hip], positions[:, knee], positions[:, ankle], target[:, 0], forward
        )
        positions[:, toe] = positions[:, ankle] + target[:, 1] - target[:, 0]
    return positions


def steps_in(toe: Array, contact: NDArray[np.bool_], *, stride: float) -> list[int]:
    """Frames at which a "planted" foot is carried further than ``stride`` metres and so must step."""
    found, open_runs = [], runs(contact)
    while open_runs:
        start, stop = open_runs.pop()
        flat = toe[start:stop][:, [0, 2]]
        if stop - start < 4 or np.linalg.norm(np.ptp(flat, axis=0)) <= stride:
            continue
        speed = np.linalg.norm(np.gradient(flat, axis=0), axis=-1)
        middle = start + int(np.argmax(gaussian_filter1d(speed, 2.0)))
        found.append(middle)
        open_runs += [(start, middle - 8), (middle + 9, stop)]
    return sorted(found)


def one_after_the_other(steps: list[list[int]], *, apart: int = 12) -> list[list[int]]:
    """Step times of both feet, moved so that the two never step at once (``apart`` frames at least)."""
    left, right = (list(foot) for foot in steps)
    for i, one in enumerate(left):
        for j, other in enumerate(right):
            if abs(one - other) < apart:
                centre, sign = (one + other) / 2, 1 if one <= other else -1
                left[i], right[j] = int(centre - sign * apart / 2), int(centre + sign * apart / 2)
    return [left, right]


def foot_shift(toe: Array, contact: NDArray[np.bool_], steps: list[int], *, half: int = 6) -> Array:
    """(T, 3) shift of a foot in each frame that keeps it still while planted; smooth in between.

    Args:
        toe: (T, 3) the toe before.
        contact: (T,) where it should rest.
        steps: frames around which it is lifted and set down elsewhere, ``half`` frames before to after.
    """
    contact = contact.copy()
    lift = np.zeros(len(toe))
    carried = np.zeros(len(toe), dtype=bool)
    for middle in steps:
        low, high = max(middle - half, 0), min(middle + half + 1, len(toe))
        contact[low:high] = False
        carried[max(middle - 14, 0) : middle + 15] = True
        lift[low:high] = np.maximum(lift[low:high], 0.05 * np.sin(np.linspace(0, np.pi, high - low)) ** 2)
    shift = np.zeros_like(toe)
    known = np.zeros(len(toe), dtype=bool)
    for start, stop in runs(contact):
        settled = ~carried[start:stop]
        rest = toe[start:stop][settled] if settled.any() else toe[start:stop]
        shift[start:stop] = (rest.mean(axis=0) - toe[start:stop]) * np.array([1.0, 0.0, 1.0])
        known[start:stop] = True
    if known.any():
        for start, stop in runs(~known):
            before = shift[start - 1] if start else shift[stop] if stop < len(toe) else 0.0
            after = shift[stop] if stop < len(toe) else before
            shift[start:stop] = before + ease(stop - start)[:, None] * (after - before)
    shift[:, 1] += lift
    return gaussian_filter1d(shift, 0.7, axis=0, mode="nearest")


# ---- blending ------------------------------------------------------------------------------------


def slerp(first: Array, second: Array, weight: Array) -> Array:
    """Rotations (…, 3, 3) a share ``weight`` (broadcast over the leading axes) of the way to ``second``.

    By Rodrigues' formula; rotations within a hundredth of a radian of a half turn apart have no shortest
    way, there the axis is found through quaternions.
    """
    relative = np.swapaxes(first, -1, -2) @ second
    trace = relative[..., 0, 0] + relative[..., 1, 1] + relative[..., 2, 2]
    skew = (relative - np.swapaxes(relative, -1, -2)) / 2
    angle = np.arctan2(np.sqrt(skew[..., 2, 1] ** 2 + skew[..., 0, 2] ** 2 + skew[..., 1, 0] ** 2), (trace - 1) / 2)
    sine = np.sin(angle)
    share = np.broadcast_to(weight, angle.shape) * angle
    axis = skew / np.where(sine > 1e-7, sine, 1.0)[..., None, None]
    half_turn = angle > np.pi - 0.01
    if half_turn.any():
        vectors = Rotation.from_matrix(relative[half_turn]).as_rotvec()
        x, y, z = (vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)).T
        zero = np.zeros_like(x)
        axis[half_turn] = np.stack([zero, -z, y, z, zero, -x, -y, x, zero], axis=-1).reshape(-1, 3, 3)
    part = np.sin(share)[..., None, None] * axis + (1 - np.cos(share))[..., None, None] * (axis @ axis)
    return first + first @ part


def ease(steps: int) -> Array:
    """(steps,) from just above 0 to just below 1 with zero slope and curvature at both ends."""
    return minimum_jerk((np.arange(steps) + 1.0) / (steps + 1.0))
