"""The default predictor: what it keeps by construction, its closed-form fit, and its folder."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import torch

from models.mawgan.network import MAWGANConfig, PredictiveMAWGAN
from models.motion_mlp import MotionMLP, MotionMLPConfig
from models.weights_io import save_network
from webdemo.inference.pipelines.predictor import load_predictor

SMALL = MotionMLPConfig(joints=4, past=10, future=8, past_coefficients=5, future_coefficients=4, width=16, blocks=1)


def waves(count: int, frames: int = 18) -> torch.Tensor:
    """People whose joints swing about in their own rhythm (count, frames, 4, 3)."""
    rng = np.random.default_rng(0)
    phase, pace = rng.uniform(0, 6.3, size=(count, 1, 1, 1)), 0.25
    time = np.arange(frames)[None, :, None, None]
    amplitude = np.linspace(0.1, 0.3, 12).reshape(4, 3)
    return torch.from_numpy(amplitude * np.sin(pace * time + phase) + np.arange(4)[:, None]).float()


@pytest.fixture
def network() -> MotionMLP:
    torch.manual_seed(0)
    made = MotionMLP(SMALL).eval()
    with torch.no_grad():
        for parameter in made.parameters():
            parameter.normal_(std=0.3)
    return made


def test_a_prediction_begins_at_the_last_pose(network: MotionMLP) -> None:
    """Whatever the weights, its low-frequency velocities cannot jump."""
    past = waves(5)[:, :10]
    future = network(past).detach()
    steps = torch.cat([past[:, -1:], future], dim=1).diff(dim=1).norm(dim=-1)
    assert future.shape == (5, 8, 4, 3)
    assert float(steps[:, 0].max()) < 1.5 * float(steps.max(dim=1).values.max())
    assert torch.allclose(network.decode(torch.zeros(5, SMALL.outputs), past[:, -1]), past[:, -1:])


def test_the_linear_part_predicts_waves() -> None:
    network = MotionMLP(SMALL).eval()
    windows = waves(400)
    network.fit_linear(windows, ridge=1e-6)
    error = (network(windows[:, :10]) - windows[:, 10:]).norm(dim=-1).mean()
    still = (windows[:, 9:10] - windows[:, 10:]).norm(dim=-1).mean()
    assert float(error) < 0.1 * float(still)


@pytest.mark.parametrize("kind", ["mlp", "mawgan"])
def test_folder_round_trip(tmp_path: Path, network: MotionMLP, kind: str) -> None:
    made = network if kind == "mlp" else PredictiveMAWGAN(MAWGANConfig(4, 10, 8, fc=64, channels=(8, 8, 4, 4))).eval()
    save_network(tmp_path, made, kind=kind, fps=30.0)
    read, source = load_predictor(tmp_path)
    assert (read.config.past, read.config.future, read.config.joints, source.meta["fps"]) == (10, 8, 4, 30.0)
    past = waves(2, 10)
    assert (read(past) - made(past)).abs().max() < 0.05
