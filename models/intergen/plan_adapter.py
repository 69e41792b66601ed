"""The part of the denoiser that reads the plan of acts."""

from __future__ import annotations

import torch
import torch.nn.functional as F
from torch import Tensor, nn

WIDTH = 192
"""Width of what is read of the plan."""
NEAR = 5
"""Tokens that are read together: what goes on, and what comes just before and after."""


class PlanAdapter(nn.Module):
    """A small network beside the denoiser, which can stay as it was trained without plans.

    As in Mou et al. 2023 ("T2I-Adapter"), what it finds is added to each person's tokens before every block, and as a
    whole to AdaLN. It adds nothing at the start of training, and never to a motion without a plan.

    Args:
        features: numbers a person and token, see :class:`models.intergen.plan_track.PlanTrack`.
        latent_dim: d.
        blocks: of the denoiser.
    """

    def __init__(self, features: int, latent_dim: int, blocks: int) -> None:
        super().__init__()
        self.features = features
        self.read = nn.Linear(2 * features, WIDTH, bias=False)
        self.near = nn.Conv1d(WIDTH, WIDTH, NEAR, padding=NEAR // 2)
        self.added = nn.ModuleList(nn.Linear(WIDTH, latent_dim, bias=False) for _ in range(blocks))
        self.whole = nn.Linear(WIDTH, latent_dim, bias=False)
        for layer in (*self.added, self.whole):
            nn.init.zeros_(layer.weight)

    def forward(self, plan: Tensor) -> tuple[list[Tensor], Tensor]:
        """plan (2, B, T, features) → what is added before each block (2, B, T, d), and to AdaLN (2, B, d).

        Each person reads their own track beside the other's.
        """
        own = F.gelu(self.read(torch.cat([plan, plan.flip(0)], -1)))
        near = self.near(own.flatten(0, 1).transpose(1, 2)).transpose(1, 2).view_as(own)
        planned = (plan != 0).flatten(2).any(-1).any(0)
        found = (own + F.gelu(near)) * planned[None, :, None, None]
        return [layer(found) for layer in self.added], self.whole(found.amax(2))
