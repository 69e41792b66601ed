"""PredictiveMA-WGAN: sizes of the thesis, predictions that hang together."""

from __future__ import annotations

from dataclasses import astuple, replace

import pytest
import torch
from torch import nn

from models.mawgan.losses import MAWGANLossWeights
from models.mawgan.network import Critic, MAWGANConfig, PredictiveMAWGAN, to_curves
from models.mawgan.srvf import exp_map, inner, log_map, norm, to_srvf
from tests.models.mawgan.poses import poses

SMALL = MAWGANConfig(joints=5, past=8, future=12, fc=64, channels=(16, 8, 8, 4), critic=(4, 4, 4), critic_fc=8)


def motion(seed: int, count: int = 3) -> torch.Tensor:
    return 0.02 * poses(seed, count, SMALL.past, SMALL.joints, 3).cumsum(1) + 1


@pytest.fixture
def network() -> PredictiveMAWGAN:
    torch.manual_seed(0)
    return PredictiveMAWGAN(SMALL).eval()


def test_defaults_are_the_thesis_sizes() -> None:
    config = MAWGANConfig()
    with torch.device("meta"):
        generator, critic = PredictiveMAWGAN(config).generator, Critic(config)
    convolutions = [m.out_channels for m in generator.up if isinstance(m, nn.Conv2d)]
    assert generator.fc.out_features == 36_864 and convolutions == [512, 256, 128, 64, 1]
    assert sum(isinstance(m, nn.Upsample) for m in generator.up) == 5
    assert [m.out_channels for m in critic.down if isinstance(m, nn.Conv2d)] == [64, 32, 16]
    assert [m.out_features for m in critic.score if isinstance(m, nn.Linear)] == [1024, 1]
    weights = MAWGANLossWeights()
    assert astuple(weights) == (1, 1, 10, 10, 10, 0)
    assert not (config.linear or config.length)


def test_prediction_stays_on_the_sphere_and_goes_on_from_the_past(network: PredictiveMAWGAN) -> None:
    past = motion(1)
    s, longer = network.generate(to_curves(past))
    assert torch.equal(longer, torch.zeros(3))
    assert inner(s, network.future_mean).abs().max() < 1e-5
    assert torch.allclose(norm(exp_map(network.future_mean, s)), torch.ones(3), atol=1e-5)
    future = network(past)
    assert future.shape == (3, 12, 5, 3)
    path = to_curves(torch.cat([past[:, -1:], future], 1))
    travelled = torch.gradient(path, dim=1)[0].norm(dim=-1).mean(1)
    before = torch.gradient(to_curves(past), dim=1)[0].norm(dim=-1).mean(1)
    # As long a way a frame as before: the network foretells directions, not the length.
    assert torch.all(travelled / before < 1.5) and torch.all(travelled / before > 0.2)


@pytest.mark.parametrize(("past", "future"), [(25, 25), (5, 25), (10, 30)])
def test_the_true_point_of_the_sphere_gives_the_true_future_back(past: int, future: int) -> None:
    """A start and a length are all that the sphere has lost; both come back exactly."""
    network = PredictiveMAWGAN(replace(SMALL, past=past, future=future))
    times = torch.arange(past + future)[:, None] / 25
    curve = torch.cat([times, 2 * times, torch.zeros(past + future, 13)], 1)[None] + 1  # at one speed
    q, _ = to_srvf(curve[:, past - 1 :])
    network.future_mean.copy_(to_srvf(poses(8, 1, future + 1, 15))[0][0])
    seen = curve[:, :past]
    made = network.decode(log_map(network.future_mean, q), torch.zeros(1), seen)
    assert torch.allclose(made, curve[:, past:], atol=1e-5)
    longer = network.decode(log_map(network.future_mean, q), torch.full((1,), 0.3), seen)
    ratio = (longer - seen[:, -1:]).norm(dim=-1) / (made - seen[:, -1:]).norm(dim=-1)
    assert torch.allclose(ratio, torch.tensor(0.3).exp().expand_as(ratio), atol=1e-4)


def test_what_stands_still_stays_as_it_is(network: PredictiveMAWGAN) -> None:
    still = poses(2, 1, 1, 5, 3).expand(1, 8, 5, 3)
    assert torch.equal(network(still), still[:, :1].expand(1, 12, 5, 3))
