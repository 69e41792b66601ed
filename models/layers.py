"""Layers that several of the networks share, by the names that their released weights use."""

from __future__ import annotations

import math

import torch
import torch.nn.functional as F
from torch import Tensor, nn

from motion.skeleton import Skeleton

TRACED_ROWS = 1024
"""Positions and timesteps that a traced network knows: all 1000 timesteps, and more tokens than any motion has."""


def neighbours(skeleton: Skeleton) -> Tensor:
    """(J, J) bool: each joint of a skeleton with itself and the joints it hangs on (Chopin's thesis, eq. 3.6)."""
    mask = torch.eye(skeleton.num_joints, dtype=torch.bool)
    for parent, child in skeleton.bones:
        mask[parent, child] = mask[child, parent] = True
    return mask


def sinusoids_at(positions: Tensor, width: int) -> Tensor:
    """Rows of the sinusoid table (Vaswani et al. 2017, section 3.5): (N,) positions → (N, width), float32.

    Sine on even channels, cosine on odd ones, base 10000. Where a network is traced, whole positions are looked up in
    a table of :data:`TRACED_ROWS` rows: a translation to bfloat16 would round the angles, of which 999 is 1000.
    """
    if torch.jit.is_tracing() and not positions.is_floating_point():
        return _rows(torch.arange(TRACED_ROWS, device=positions.device), width)[positions]
    return _rows(positions, width)


def _rows(positions: Tensor, width: int) -> Tensor:
    exponents = torch.arange(0, width, 2, device=positions.device, dtype=torch.float32)
    frequencies = torch.exp(exponents * (-math.log(10000.0) / width))
    angles = positions[:, None].float() * frequencies
    return torch.stack([angles.sin(), angles.cos()], dim=-1).flatten(1)[:, :width]


def sinusoids(length: int, width: int, *, device: torch.device | str = "cpu") -> Tensor:
    """The first rows of the sinusoid table, (length, width)."""
    return sinusoids_at(torch.arange(length, device=device), width)


def encoder_layer(
    width: int, num_heads: int, ff_size: int, dropout: float = 0.0, *, norm_first: bool = True
) -> nn.TransformerEncoderLayer:
    """PyTorch's layer with GELU, the batch first."""
    return nn.TransformerEncoderLayer(
        width, num_heads, ff_size, dropout, "gelu", batch_first=True, norm_first=norm_first
    )


class TimestepEmbedding(nn.Module):
    """A timestep's sinusoid row through Linear, SiLU, Linear: (B,) → (B, d)."""

    def __init__(self, latent_dim: int) -> None:
        super().__init__()
        self.latent_dim = latent_dim
        self.time_embed = nn.Sequential(nn.Linear(latent_dim, latent_dim), nn.SiLU(), nn.Linear(latent_dim, latent_dim))

    def forward(self, t: Tensor) -> Tensor:
        """Timesteps (B,) → (B, d)."""
        return self.time_embed(sinusoids_at(t, self.latent_dim))


class FeedForward(nn.Module):
    """Linear, GELU, dropout, Linear."""

    def __init__(self, latent_dim: int, ff_size: int, *, dropout: float = 0.0) -> None:
        super().__init__()
        self.linear1 = nn.Linear(latent_dim, ff_size)
        self.linear2 = nn.Linear(ff_size, latent_dim)
        self.dropout = dropout

    def forward(self, h: Tensor) -> Tensor:
        """h (…, d) → (…, d)."""
        return self.linear2(F.dropout(F.gelu(self.linear1(h)), self.dropout, self.training))
