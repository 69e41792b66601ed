"""Trained predictors as folders: ``config.json`` and float16 ``model.safetensors``, checked by SHA-256."""

from __future__ import annotations

from pathlib import Path

from models.mawgan.network import PredictiveMAWGAN
from models.motion_mlp import MotionMLP
from models.weights_io import WeightsFolder, load_network

Predictor = MotionMLP | PredictiveMAWGAN
"""A network that continues positions: (B, past, J, 3) metres → (B, future, J, 3), sizes as in its ``config``."""


def load_predictor(folder: Path) -> tuple[Predictor, WeightsFolder]:
    """A predictor in float32, eval mode, and its folder.

    Raises:
        WeightsError: if a file is missing, altered or of another network.
    """
    if WeightsFolder(folder).meta.get("kind") == "mlp":
        return load_network(folder, MotionMLP)
    return load_network(folder, PredictiveMAWGAN)
