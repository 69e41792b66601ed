"""Calibration poses: a T-, A- or I-pose in the first frames of a file, from which its motion begins with a jump."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from motion.up import Places

Array = NDArray[np.floating]

_LIMBS = (("hip", "knee", "ankle"), ("shoulder", "elbow", "wrist"))
_LONGEST = 3.0
"""Seconds for which the pose is held, at most."""
_JUMP, _STILL = 6.0, 0.5
"""Metres a second against the pelvis, of an adult: of the jump at least, and of the pose before it at most."""
_ABRUPT = 4.0
"""So many times as fast as anything after it is the jump."""
_STRAIGHT = 0.95
_LEG = 0.81
"""Metres: an adult's."""


def calibration_frames(places: Places, fps: float) -> int:
    """Number of first frames of a motion that hold a pose of straight limbs which the next one jumps from; 0 for none.

    Args:
        places: (T, 3) of a person's joints, in any unit.
        fps: frames a second.
    """
    limbs = [[places[f"{side}_{part}"] for part in limb] for limb in _LIMBS for side in ("left", "right")]
    joints = np.stack([joint for limb in limbs for joint in limb], axis=1).astype(np.float64)
    joints -= (joints[:, :1] + joints[:, 3:4]) / 2
    leg = float(np.median(np.linalg.norm(np.diff(joints[:, :3], axis=1), axis=-1).sum(axis=1)))
    speed = np.linalg.norm(np.diff(joints, axis=0), axis=-1).max(axis=1, initial=0.0) * fps * _LEG / max(leg, 1e-9)
    if len(speed) < 4:
        return 0
    jump = int(np.argmax(speed[: max(1, round(_LONGEST * fps))]))
    after = speed[jump + 1 :].max(initial=0.0)
    abrupt = speed[jump] > max(_JUMP, _ABRUPT * after) and speed[:jump].max(initial=0.0) < _STILL
    if not abrupt or len(speed) - jump < 4:
        return 0
    bones = joints[jump].reshape(-1, 3, 3)
    reach = np.linalg.norm(bones[:, 2] - bones[:, 0], axis=-1)
    lengths = np.linalg.norm(np.diff(bones, axis=1), axis=-1).sum(axis=1)
    return jump + 1 if (reach > _STRAIGHT * lengths).all() else 0
