"""Motions made by formula, whose truth is known."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from motion import SMPL22, Clip, Duet
from motion.formats.importing import import_motion
from motion.kinematics import forward_kinematics

FPS = 30.0


def swaying(frames: int = 40, x: float = 0.0) -> np.ndarray:
    """(T, 22, 3) metres: a person in T-pose who sways, float32."""
    root = np.zeros((frames, 3))
    root[:, 0] = x + 0.05 * np.sin(np.linspace(0, 6, frames))
    root[:, 1] = 0.9562
    return forward_kinematics(np.tile(np.eye(3), (frames, 22, 1, 1)), root).astype(np.float32)


def marching(frames: int = 60, *, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Someone who marches forward, swings the arms and nods.

    Returns:
        (T, 22, 3) positions in metres, the lowest joint at 0, and (T, 22, 3, 3) local rotations.
    """
    rng = np.random.default_rng(seed)
    time = np.arange(frames) / FPS
    vectors = np.zeros((frames, 22, 3))

    def bend(name: str, axis: int, angle: np.ndarray) -> None:
        vectors[:, SMPL22.index(name), axis] = angle

    phase = 2 * np.pi * time + rng.uniform(0, 6)
    for sign, side in ((1, "left"), (-1, "right")):
        swing = np.sin(phase) * sign
        bend(f"{side}_hip", 0, -0.5 * np.maximum(swing, 0))
        bend(f"{side}_knee", 0, 0.9 * np.maximum(swing, 0))
        bend(f"{side}_shoulder", 2, np.full(frames, -1.1 * sign))
        bend(f"{side}_elbow", 1, -sign * (0.6 + 0.3 * swing))
    bend("pelvis", 1, 0.3 * np.sin(phase / 2))
    bend("spine3", 0, np.full(frames, 0.1))
    bend("neck", 0, 0.2 * np.sin(phase))
    rotations = Rotation.from_rotvec(vectors.reshape(-1, 3)).as_matrix().reshape(frames, 22, 3, 3)
    root = np.stack([0.05 * np.sin(phase), 0.95 + 0 * time, 0.4 * time], axis=-1)
    positions = forward_kinematics(rotations, root)
    positions[..., 1] -= positions[..., 1].min()
    return positions, rotations


def gliding(frames: int = 90, *, speed: float = 0.1, sink: float = 0.02) -> np.ndarray:
    """Someone who stands with bent knees while the whole body glides along X, sunk into the floor."""
    angles = np.zeros((22, 3))
    for side in ("left", "right"):
        angles[SMPL22.index(f"{side}_hip"), 0] = -0.15
        angles[SMPL22.index(f"{side}_knee"), 0] = 0.3
        angles[SMPL22.index(f"{side}_ankle"), 0] = -0.15
    rotations = Rotation.from_rotvec(angles).as_matrix()
    pose = forward_kinematics(rotations, np.zeros(3))
    pose[:, 1] -= pose[:, 1].min()
    time = np.arange(frames)[:, None, None] / FPS
    return pose + time * np.array([speed, 0, 0]) - np.array([0, sink, 0])


def as_stored(source: Path | bytes, name: str | None = None) -> Clip | Duet:
    """The one or two people of a file on the file's own joints, before they are brought onto SMPL22."""
    people = import_motion(source, name=name).people
    return Duet(people[0], people[1]) if len(people) == 2 else people[0]
