"""The losses of PredictiveMA-WGAN, worked out by hand."""

from __future__ import annotations

import pytest
import torch
from scipy.spatial.transform import Rotation
from torch import nn

from models.mawgan.losses import (
    bone_loss,
    critic_loss,
    gradient_penalty,
    gram_distance,
    position_loss,
    reconstruction_loss,
    skeleton_loss,
)
from tests.models.mawgan.poses import poses


def test_gram_distance_knows_no_rotation() -> None:
    p = poses(3, 4, 17, 3).double()
    turned = p @ torch.from_numpy(Rotation.random(random_state=0).as_matrix())
    assert gram_distance(p, turned).abs().max() < 1e-9
    other = poses(4, 4, 17, 3).double()
    assert torch.all(gram_distance(p, other) <= (p - other).square().sum((-1, -2)) + 1e-9)
    assert torch.all(gram_distance(p, other) > 0.1)
    assert float(skeleton_loss(p, other)) == pytest.approx(float(gram_distance(p, other).mean()))


def test_losses_by_hand() -> None:
    made, real = torch.zeros(2, 4, 3), torch.full((2, 4, 3), 0.5)
    assert float(reconstruction_loss(made, real)) == pytest.approx(1.5)
    apart = torch.tensor([0.0, 0.3, 0.4]).expand(2, 4, 5, 3)
    assert float(position_loss(apart, torch.zeros_like(apart))) == pytest.approx(0.5, abs=1e-5)
    pose = torch.tensor([[0.0, 0, 0], [0, 2, 0], [0, 2, 1]]).expand(2, 4, 3, 3)
    assert float(bone_loss(pose * 1.1, pose, [(0, 1), (1, 2)])) == pytest.approx(0.15)
    assert float(bone_loss(pose.flip(-1), pose, [(0, 1), (1, 2)])) == pytest.approx(0, abs=1e-6)


def test_gradient_penalty_and_critic_loss_by_hand() -> None:
    class Slope(nn.Module):
        def forward(self, x: torch.Tensor) -> torch.Tensor:
            return 3 * x[:, 0, 0]  # its gradient has norm 3 everywhere

    real, made, share = torch.ones(4, 2, 2), torch.zeros(4, 2, 2), torch.rand(4)
    assert float(gradient_penalty(Slope(), real, made, share)) == pytest.approx(4, abs=1e-4)
    assert float(critic_loss(Slope(), real, made, share, penalty=10)) == pytest.approx(-3 + 40, abs=1e-3)
