"""A person for the tests of reactions to react to."""

from __future__ import annotations

import numpy as np

from motion import SMPL22, Clip
from motion.kinematics import forward_kinematics
from motion.transforms import heading_matrix


def waver(seconds: float = 2.0, fps: float = 30.0) -> Clip:
    """A person a metre off the origin, turned by 50 degrees, who walks a little and lifts an arm."""
    frames = round(seconds * fps)
    rotations = np.tile(np.eye(3), (frames, 22, 1, 1))
    rotations[:, 0] = heading_matrix(np.radians(50))
    lift = np.sin(np.linspace(0, np.pi, frames))
    c, s = np.cos(lift), np.sin(lift)
    shoulder = rotations[:, SMPL22.index("right_shoulder")]
    shoulder[:, 0, 0], shoulder[:, 0, 1], shoulder[:, 1, 0], shoulder[:, 1, 1] = c, s, -s, c
    root = np.tile([1.0, 0.9562, -0.5], (frames, 1))
    root[:, 2] += np.linspace(0, 0.4, frames)
    return Clip(forward_kinematics(rotations, root), fps, name="waver")
