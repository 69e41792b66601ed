"""The default predictor: what it keeps by construction, its closed-form fit, and its folder."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import torch

from models.mawgan.network import MAWGANConfig, PredictiveMAWGAN
from models.motion_mlp import MotionMLP, MotionMLPConfig
from models.predictors import load_predictor, without_jump
from models.weights_io import save_network

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
    read = load_predictor(tmp_path)
    assert (read.past, read.future, read.fps, read.joints) == (10, 8, 30.0, 4)
    past = waves(2, 14)
    assert (read(past) - without_jump(past[:, -10:], made(past[:, -10:]))).abs().max() < 0.05


def test_the_first_step_is_no_larger_than_the_past_s_largest() -> None:
    past = waves(5, 12)
    largest = past.diff(dim=1).norm(dim=-1).mean(-1).amax(1)
    away = torch.tensor([0.0, 1.0, 0.0]) * torch.tensor([0.0, 0.5, 1.0, 2.0, 9.0])[:, None, None, None]
    steps = torch.arange(1, 9)[:, None, None]
    future = past[:, -1:] + largest[:, None, None, None] * away * steps
    made = without_jump(past, future)
    first = (made[:, 0] - past[:, -1]).norm(dim=-1).mean(-1)
    assert torch.allclose(first / largest, torch.tensor([0.0, 0.5, 1.0, 1.0, 1.0]), atol=1e-5)
    assert torch.allclose(made[:3], future[:3], atol=1e-6)
    assert (made[4] - future[4])[-1].norm(dim=-1).mean() < 0.1 * (made[4] - future[4])[0].norm(dim=-1).mean()
    standing = past[:, :1].expand(5, 12, 4, 3)
    assert torch.equal(without_jump(standing, standing[:, :8]), standing[:, :8])
