"""The authors' ReGenNet: its file, and its representation of a person.

A frame is 56 rows of 6 numbers: rotations of SMPL-X's 55 joints against their parents, and one row with the root's
place in its first 3 numbers. The 6 numbers are a matrix' first two *rows*, as in PyTorch3D, on which the code that
ReGenNet builds on relies. The first 22 joints of SMPL-X are SMPL's; jaw, eyes and fingers are at rest here.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import torch
from torch import Tensor

from models.errors import WeightsError
from models.released import read_tensors
from models.weights_io import Uninitialised
from motion import SMPL22
from motion.kinematics import fit_rotations, forward_kinematics
from motion.representation import from_6d
from motion.vectors import Array

from .network import NETWORK, ReGenNet, from_released

JOINTS, ROWS = 55, 56
BODY = SMPL22.num_joints
HEAD_WIDTH = 128
"""Channels of a head in the released network."""


def load_released(checkpoint: Path) -> ReGenNet:
    """The network of the authors' file.

    Raises:
        WeightsError: if the file is missing, damaged, another network's, or of people with other joints.
    """
    tensors = read_tensors(checkpoint, network=NETWORK, mark="input_process.")
    latent_dim = len(tensors.get("input_process.poseEmbedding.weight", ()))
    with Uninitialised():
        network = from_released(tensors, num_heads=max(1, latent_dim // HEAD_WIDTH))
    if network.config.rows != ROWS:
        raise WeightsError(
            f"{checkpoint.name} was trained on people of {network.config.rows - 1} joints: use a checkpoint of "
            f"SMPL-X's {JOINTS}."
        )
    return network.requires_grad_(False)


def rows_of(rotations: Array, root: Array) -> Array:
    """Rotations against the parents (T, J, 3, 3) of the first J joints and the root's path (T, 3) as (T, 56, 6).

    Joints left out are at rest.
    """
    rows = np.tile(np.array([1.0, 0, 0, 0, 1, 0]), (len(root), ROWS, 1))
    rows[:, : rotations.shape[1]] = rotations[..., :2, :].reshape(*rotations.shape[:2], 6)
    rows[:, -1] = 0.0
    rows[:, -1, :3] = root
    return rows


def encode(positions: Array) -> Tensor:
    """One person (T, 22, 3) in metres → (56, 6, T)."""
    return torch.from_numpy(rows_of(fit_rotations(positions), positions[:, 0])).float().permute(1, 2, 0)


def decode(rows: Tensor) -> Array:
    """(…, 56, 6, T) → positions (…, T, 22, 3) in metres, on SMPL22's constant bones."""
    frames = rows.double().numpy()
    numbers = np.moveaxis(frames, -1, -3)  # (…, T, 56, 6)
    rotations = np.swapaxes(from_6d(numbers[..., :BODY, :]), -1, -2)  # rows, where from_6d takes columns
    return forward_kinematics(rotations, numbers[..., -1, :3])
