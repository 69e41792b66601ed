"""Recognises a person's gesture from one observed second and two predicted seconds.

The action recognition module of the virtual agent in Chopin's thesis (section 5.5.3, figure 5.11): a
Transformer encoder with spatial attention over the skeleton's joints, masked to the skeleton as in
InterFormer (eq. 3.6), and a multi-layer perceptron on top. Ours differs
in three points: the joints within a frame attend to each other before the frames do, layers are pre-norm, and
only every third frame is used.

Shapes: B batch, T frames, J = 22 joints, L labels, d latent width. Positions are in metres in the frame of
the last observed pose: that person at the origin, facing +Z.
"""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor, nn

from models.layers import encoder_layer, neighbours, sinusoids
from motion.skeleton import SMPL22

JOINTS = SMPL22.num_joints
OBSERVED, PREDICTED = 30, 60
"""Numbers of observed and of predicted frames, at 30 fps."""
EVERY = 3
FRAMES = (OBSERVED + PREDICTED) // EVERY


@dataclass(frozen=True)
class RecogniserConfig:
    """Sizes of a :class:`Recogniser`, and its classes.

    labels: names of the gestures; the first one needs no response.
    sentences: for each gesture, the prompt that describes the gesture and the response to it.
    """

    labels: tuple[str, ...] = ()
    sentences: tuple[str, ...] = ()
    joint_width: int = 16
    latent_dim: int = 160
    ff_size: int = 320
    num_layers: int = 2
    num_heads: int = 4
    dropout: float = 0.2


def sampled(positions: Tensor) -> Tensor:
    """(B, OBSERVED + PREDICTED, J, 3) → the frames that the network sees, (B, FRAMES, J, 3)."""
    return positions[:, EVERY - 1 :: EVERY]


class Recogniser(nn.Module):
    """Spatial attention within frames, temporal attention over them, a perceptron on their mean."""

    sizes = RecogniserConfig
    graph: Tensor

    def __init__(self, config: RecogniserConfig) -> None:
        super().__init__()
        self.config = config
        width = config.joint_width
        self.joint = nn.Linear(6, width)
        self.joint_place = nn.Parameter(0.02 * torch.randn(JOINTS, width))
        self.space = encoder_layer(width, 2, 2 * width)
        self.frame = nn.Linear(JOINTS * width, config.latent_dim)
        layer = encoder_layer(config.latent_dim, config.num_heads, config.ff_size, config.dropout)
        self.time = nn.TransformerEncoder(layer, config.num_layers, enable_nested_tensor=False)
        self.top = nn.Sequential(
            nn.LayerNorm(config.latent_dim),
            nn.Linear(config.latent_dim, config.latent_dim),
            nn.GELU(),
            nn.Dropout(config.dropout),
            nn.Linear(config.latent_dim, len(config.labels)),
        )
        self.register_buffer("graph", ~neighbours(SMPL22), persistent=False)  # true where two may not attend

    def forward(self, positions: Tensor) -> Tensor:
        """(B, FRAMES, J, 3) of :func:`sampled` → logits (B, L)."""
        steps = torch.cat([torch.zeros_like(positions[:, :1]), 10 * positions.diff(dim=1)], dim=1)
        local = torch.cat([positions[:, :, :1], positions[:, :, 1:] - positions[:, :, :1]], dim=2)
        joints = self.joint(torch.cat([local, steps], dim=-1)) + self.joint_place
        seen = self.space(joints.flatten(0, 1), src_mask=self.graph).unflatten(0, joints.shape[:2])
        frames = self.frame(seen.flatten(2))
        frames = frames + sinusoids(frames.shape[1], frames.shape[2], device=frames.device)
        return self.top(self.time(frames).mean(1))
