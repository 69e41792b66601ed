"""The plain run of the benchmark computes what the measured network computes."""

from typing import Any

import pytest
import torch

from models.intergen import InterGenConfig, InterGenDenoiser
from models.intergen.words import WordDenoiser
from webdemo.benchmark.plain import PlainSampler

SIZES: dict[str, Any] = {
    "input_features": 10,
    "latent_dim": 8,
    "ff_size": 8,
    "num_layers": 2,
    "num_heads": 2,
    "cond_dim": 6,
    "role_embedding": True,
}


def ready(network: InterGenDenoiser) -> InterGenDenoiser:
    """The network with weights none of which is zero."""
    for parameter in network.eval().requires_grad_(False).parameters():
        torch.nn.init.normal_(parameter, std=0.3)
    return network


@pytest.mark.parametrize("role_text", [False, True])
def test_denoiser_of_one_vector(role_text: bool) -> None:
    torch.manual_seed(0)
    network = ready(InterGenDenoiser(InterGenConfig(**SIZES, role_text=role_text)))
    x, t, cond = torch.randn(1, 5, 20), torch.tensor([400]), torch.randn(1, 6)
    plain = PlainSampler(network, None, None).forward(x, t, cond)
    torch.testing.assert_close(plain, network(x, t, cond), atol=1e-5, rtol=1e-5)


def test_denoiser_of_words() -> None:
    torch.manual_seed(0)
    network = ready(WordDenoiser(InterGenConfig(**SIZES, role_text=True), 3))
    x, t, cond = torch.randn(1, 5, 20), torch.tensor([400]), torch.randn(1, 3, 4, 6)
    cond[:, 2, 2:] = 0  # a shorter sentence for b
    plain = PlainSampler(network, None, None).forward(x, t, cond)
    torch.testing.assert_close(plain, network(x, t, cond), atol=1e-5, rtol=1e-5)
    other = PlainSampler(network, None, None).forward(x, t, torch.zeros_like(cond))
    assert not torch.allclose(plain, other, atol=1e-2)
