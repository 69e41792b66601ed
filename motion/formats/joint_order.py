"""Finds the joint order of an array without joint names from its number of joints and its bones."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from motion.skeleton import POINTS17, SKELETONS, Skeleton

Array = NDArray[np.floating]

_FRAMES = 200
"""So many, spread over the motion, tell enough."""


def skeletons_of(joints: int) -> tuple[Skeleton, ...]:
    """The known skeletons of a number of joints: two share 15, SBU's order and K3HI's."""
    # Points of markers come with their names, so an array of 17 joints is CMU's.
    known = (skeleton for skeleton in SKELETONS.values() if skeleton is not POINTS17)
    return tuple(skeleton for skeleton in known if skeleton.num_joints == joints)


def likely_skeleton(positions: Array) -> Skeleton | None:
    """The skeleton under which the bones change least, and left and right are most alike.

    Args:
        positions: (…, T, J, 3) of any unit and axes.

    Returns:
        None where no skeleton has J joints.
    """
    if positions.ndim < 2:
        return None
    known = skeletons_of(positions.shape[-2])
    if len(known) < 2 or positions.ndim < 3 or positions.shape[-1] != 3 or 0 in positions.shape:
        return known[0] if known else None
    some = np.linspace(0, positions.shape[-3] - 1, _FRAMES).astype(int)
    frames = positions[..., some, :, :].astype(np.float64).reshape(-1, *positions.shape[-2:])
    return min(known, key=lambda skeleton: _strangeness(frames, skeleton))


def _strangeness(frames: Array, skeleton: Skeleton) -> float:
    """Variation of bone lengths over time and between the sides, relative to the lengths."""
    bones = {
        skeleton.joint_names[child]: np.linalg.norm(frames[:, child] - frames[:, parent], axis=-1)
        for parent, child in skeleton.bones
    }
    mean = float(np.mean([length.mean() for length in bones.values()])) + 1e-9
    change = float(np.mean([length.std() for length in bones.values()])) / mean
    pairs = [(name, name.replace("left_", "right_")) for name in bones if name.startswith("left_")]
    uneven = float(np.mean([abs(bones[a].mean() - bones[b].mean()) for a, b in pairs if b in bones])) / mean
    return change + uneven
