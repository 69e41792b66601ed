"""Trained predictors as folders: ``config.json`` and float16 ``model.safetensors``, checked by SHA-256."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import torch
from torch import Tensor, nn

from models.mawgan.network import MAWGANConfig, PredictiveMAWGAN
from models.motion_mlp import MotionMLP, MotionMLPConfig
from models.weights_io import WeightsFolder, load_network

_FADE = 0.7
"""Share of a correction at the seam that is left a frame later."""


@dataclass(frozen=True)
class Predictor:
    """A network that continues positions, and what it was made for.

    Attributes:
        network: (B, past, J, 3) metres → (B, future, J, 3).
        past, future: frames that it takes and gives.
        fps: of its frames.
        joints: J.
        name: of its folder.
        digest: SHA-256 of its weights.
        training: the settings it was trained with.
    """

    network: nn.Module
    past: int
    future: int
    fps: float
    joints: int
    name: str = ""
    digest: str = ""
    training: dict[str, Any] | None = None

    @torch.no_grad()
    def __call__(self, past: Tensor) -> Tensor:
        """(B, past or more, J, 3) metres, of which the last frames are used → (B, future, J, 3).

        The first step is no larger than the largest of those frames.
        """
        seen = past[:, -self.past :]
        return without_jump(seen, self.network(seen))


def without_jump(past: Tensor, future: Tensor) -> Tensor:
    """A future whose first step is at most the past's largest, as mean distances of joints.

    What is too much of it is taken away, and less and less so of the frames after.

    Args:
        past: (B, T, J, 3) metres.
        future: (B, F, J, 3) metres.

    Returns:
        (B, F, J, 3).
    """
    step = future[:, 0] - past[:, -1]
    largest = past.diff(dim=1).norm(dim=-1).mean(-1).amax(1)
    excess = torch.relu(1 - largest / step.norm(dim=-1).mean(-1).clamp_min(1e-9))[:, None, None] * step
    fade = _FADE ** torch.arange(future.shape[1]).to(future)
    return future - fade[:, None, None] * excess[:, None]


def load_predictor(folder: Path) -> Predictor:
    """A predictor in float32, eval mode.

    Raises:
        WeightsError: if a file is missing, altered or of another network.
    """
    network: MotionMLP | PredictiveMAWGAN
    if WeightsFolder(folder).meta.get("kind") == "mlp":
        network, source = load_network(folder, lambda sizes: MotionMLP(MotionMLPConfig(**sizes)))
    else:
        network, source = load_network(folder, lambda sizes: PredictiveMAWGAN(MAWGANConfig.from_dict(sizes)))
    config = network.config
    return Predictor(
        network,
        config.past,
        config.future,
        float(source.meta["fps"]),
        config.joints,
        folder.name,
        source.digest,
        source.meta.get("training"),
    )
