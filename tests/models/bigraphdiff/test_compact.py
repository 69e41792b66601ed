"""The compact BiGraphDiff: classes as vectors, guidance, padding, and the folder that it is shipped in."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
import torch

from models.bigraphdiff.compact import CompactBiGraphDiff, CompactBiGraphDiffConfig
from models.errors import WeightsError
from models.weights_io import load_network, save_network

SHAKE = (("right_wrist", "right_wrist"),)
CONFIG = CompactBiGraphDiffConfig(
    ("shake hands", "wave"),
    (SHAKE, ()),
    latent_dim=32,
    ff_size=16,
    num_layers=2,
    num_heads=2,
    embed_dim=24,
    cond_dim=8,
    max_tokens=12,
)


@pytest.fixture
def model() -> CompactBiGraphDiff:
    torch.manual_seed(0)
    network = CompactBiGraphDiff(CONFIG)
    for parameter in network.parameters():  # the zero-initialised layers would hide what the input does
        torch.nn.init.normal_(parameter, std=0.1)
    return network.eval().requires_grad_(False)


def noised(model: CompactBiGraphDiff) -> tuple[torch.Tensor, torch.Tensor]:
    torch.manual_seed(1)
    return torch.randn(2, 6, 2 * model.layout.token_features), torch.tensor([10, 900])


def test_the_class_changes_what_is_predicted(model: CompactBiGraphDiff) -> None:
    x, t = noised(model)
    shake, wave = (model.condition([name]).expand(2, -1) for name in CONFIG.labels)
    out = model.denoiser(x, t, shake)
    assert out.shape == x.shape
    assert (out - model.denoiser(x, t, wave)).abs().max() > 1e-3
    with pytest.raises(ValueError):
        model.condition(["juggle"])


def test_a_folder_gives_the_same_network_back(model: CompactBiGraphDiff, tmp_path: Path) -> None:
    save_network(tmp_path, model.half().float())
    again, _ = load_network(tmp_path, CompactBiGraphDiff)
    assert again.config == CONFIG
    assert again.touches("shake hands") == SHAKE and again.touches("wave") == ()
    x, t = noised(model)
    cond = model.condition(["wave"]).expand(2, -1)
    assert torch.equal(again.denoiser(x, t, cond), model.denoiser(x, t, cond))
    meta = json.loads((tmp_path / "config.json").read_text())
    meta["model"]["latent_dim"] = 64
    (tmp_path / "config.json").write_text(json.dumps(meta))
    with pytest.raises(WeightsError, match="do not fit their config"):
        load_network(tmp_path, CompactBiGraphDiff)
