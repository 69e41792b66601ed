"""Constructed motions whose measures are known beforehand."""

from __future__ import annotations

import numpy as np

from motion import SMPL22, Duet

FPS = 30


def face_to_face(distance: float = 2.0, *, frames: int = 60) -> np.ndarray:
    """(2, T, 22, 3) two people who stand still in T-pose and face each other."""
    a = SMPL22.standing()
    b = a * [-1.0, 1.0, -1.0] + np.array([0.0, 0.0, distance])
    return np.stack([np.tile(a, (frames, 1, 1)), np.tile(b, (frames, 1, 1))])


def duet(positions: np.ndarray) -> Duet:
    return Duet.from_positions(positions, fps=FPS)


def put_wrist(positions: np.ndarray, person: int, name: str, point: np.ndarray, frames: slice) -> None:
    """Places a wrist at ``point`` (3,) with its elbow 25 cm straight above, so the palm is 8 cm below."""
    side = name.split("_")[0]
    positions[person, frames, SMPL22.index(f"{side}_wrist")] = point
    positions[person, frames, SMPL22.index(f"{side}_elbow")] = point + np.array([0.0, 0.25, 0.0])
