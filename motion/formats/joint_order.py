"""Finds the joint order of an array without joint names from its number of joints and its bones."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from motion.clip import Clip
from motion.skeleton import POINTS17, SKELETONS, Skeleton
from motion.up import places_of
from motion.vectors import unit

Array = NDArray[np.floating]

_FRAMES = 200
"""So many, spread over the motion, tell enough."""
_SURE = 0.05
"""By so much the second best order is stranger, where the best is sure."""
_SHAPE = 0.2
"""Weight of how the parts lie to one another beside how the bones change."""


def skeletons_of(joints: int) -> tuple[Skeleton, ...]:
    """The known skeletons of a number of joints: SBU's order and K3HI's share 15; CMU's, Human3.6M's and COCO's 17."""
    # Points of markers come with their names.
    known = (skeleton for skeleton in SKELETONS.values() if skeleton is not POINTS17)
    return tuple(skeleton for skeleton in known if skeleton.num_joints == joints)


def likely_skeleton(positions: Array) -> tuple[Skeleton | None, Skeleton | None]:
    """The skeleton under which the bones change least, left and right are most alike, and the body is a body.

    Args:
        positions: (…, T, J, 3) of any unit and axes.

    Returns:
        None where no skeleton has J joints; and another that it may as well be.
    """
    if positions.ndim < 2:
        return None, None
    known = skeletons_of(positions.shape[-2])
    if len(known) < 2 or positions.ndim < 3 or positions.shape[-1] != 3 or 0 in positions.shape:
        return (known[0] if known else None), None
    some = np.linspace(0, positions.shape[-3] - 1, _FRAMES).astype(int)
    frames = positions[..., some, :, :].astype(np.float64).reshape(-1, *positions.shape[-2:])
    strange = {skeleton.name: _strangeness(frames, skeleton) for skeleton in known}
    best, second, *_ = sorted(known, key=lambda skeleton: strange[skeleton.name])
    return best, None if strange[second.name] - strange[best.name] > _SURE else second


def _shape(frames: Array, skeleton: Skeleton) -> float:
    """0 to 4: the hips lie across as the shoulders do, which are above them, knees bend forwards, the head is up."""
    at = places_of(Clip(frames.astype(np.float32), 30.0, skeleton))
    hips, shoulders, knees, ankles = (
        (at[f"left_{part}"] + at[f"right_{part}"]) / 2 for part in ("hip", "shoulder", "knee", "ankle")
    )
    across = unit(at["left_hip"] - at["right_hip"])
    trunk = unit(shoulders - hips)
    ahead = np.cross(across, trunk)

    def against(one: Array, other: Array) -> float:
        return float(np.mean(1 - np.sum(one * other, axis=-1))) / 2

    bent = np.sum((knees - (hips + ankles) / 2) * ahead, axis=-1) / np.linalg.norm(hips - ankles, axis=-1).clip(1e-9)
    return (
        against(across, unit(at["left_shoulder"] - at["right_shoulder"]))
        + against(trunk, unit(hips - ankles))
        + against(trunk, unit(at["head"] - hips))
        + float(np.clip(-10 * np.mean(bent), 0.0, 1.0))
    )


def _strangeness(frames: Array, skeleton: Skeleton) -> float:
    """Variation of bone lengths over time and between the sides, relative to them, and what no body looks like."""
    bones = {
        skeleton.joint_names[child]: np.linalg.norm(frames[:, child] - frames[:, parent], axis=-1)
        for parent, child in skeleton.bones
    }
    mean = float(np.mean([length.mean() for length in bones.values()])) + 1e-9
    change = float(np.mean([length.std() for length in bones.values()])) / mean
    pairs = [(name, name.replace("left_", "right_")) for name in bones if name.startswith("left_")]
    uneven = float(np.mean([abs(bones[a].mean() - bones[b].mean()) for a, b in pairs if b in bones])) / mean
    return change + uneven + _SHAPE * _shape(frames, skeleton)
