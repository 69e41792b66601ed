"""What the benchmark compares with computes the same as what is measured."""

from typing import Any

import pytest
import torch

from models.intergen import InterGenConfig, InterGenDenoiser
from webdemo.benchmark.suite import PlainSampler


@pytest.mark.parametrize("role_text", [False, True])
def test_the_plain_denoiser_is_the_shared_one(role_text: bool) -> None:
    torch.manual_seed(0)
    sizes: dict[str, Any] = {
        "input_features": 10,
        "latent_dim": 8,
        "ff_size": 8,
        "num_layers": 2,
        "num_heads": 2,
    }
    config = InterGenConfig(**sizes, cond_dim=6, role_embedding=True, role_text=role_text)
    network = InterGenDenoiser(config).eval().requires_grad_(False)
    for parameter in network.parameters():
        torch.nn.init.normal_(parameter, std=0.3)
    x, t, cond = torch.randn(1, 5, 20), torch.tensor([400]), torch.randn(1, 6)
    plain = PlainSampler(network, None, None).forward(x, t, cond)
    torch.testing.assert_close(plain, network(x, t, cond), atol=1e-5, rtol=1e-5)
