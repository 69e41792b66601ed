"""Bodies that lie, fall and get up on the floor instead of in it."""

from __future__ import annotations

import numpy as np
import scipy  # its parts are loaded with their first use
from numpy.typing import NDArray

from .cleaning import solve_two_bones
from .skeleton import SMPL22, Skeleton
from .vectors import unit

Array = NDArray[np.floating]

_DEEP = {
    "pelvis": 0.08,
    "left_hip": 0.05,
    "right_hip": 0.05,
    "spine1": 0.07,
    "spine2": 0.07,
    "spine3": 0.07,
    "neck": 0.05,
    "head": 0.07,
    "left_collar": 0.05,
    "right_collar": 0.05,
    "left_shoulder": 0.05,
    "right_shoulder": 0.05,
}
"""Metres from the joints of the trunk and the head to the skin of a body that lies."""
_LIMBS = (("shoulder", "elbow", "wrist"), ("hip", "knee", "ankle"))
_THIN = 0.03
"""The same for elbows, wrists and knees."""
_REACH = 4
"""Frames over which a body is raised and let down again."""
_HALVINGS = 12


def above_floor(positions: Array, *, skeleton: Skeleton = SMPL22) -> Array:
    """Raises a body whose trunk is in the floor, and turns limbs that are in it about their ends.

    A body that stays above the floor is not changed. Feet are left to :func:`motion.cleaning.plant_feet`.

    Args:
        positions: (T, J, 3) metres on a skeleton of constant bones, floor at 0.

    Returns:
        (T, J, 3) with the bone lengths of the input.
    """
    result = np.array(positions, dtype=np.float64)
    trunk = [skeleton.index(name) for name in _DEEP]
    need = np.max(np.array(list(_DEEP.values())) - result[:, trunk, 1], axis=1).clip(min=0.0)
    if need.any():
        widened = scipy.ndimage.maximum_filter1d(need, 2 * _REACH + 1, mode="nearest")
        result[..., 1] += scipy.ndimage.gaussian_filter1d(widened, 0.5 * _REACH, mode="nearest")[:, None]
    for parts in _LIMBS:
        for side in ("left", "right"):
            root, middle, end = (skeleton.index(f"{side}_{part}") for part in parts)
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
