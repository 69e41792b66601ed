"""The ablations' networks, and the command on a corpus that takes a moment."""

import argparse
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch

from models.intergen import InterGenConfig, InterGenDenoiser
from models.motion_tokens import TokenLayout, encode, foot_contacts
from motion import SMPL22, InputError
from training.evaluate import ablations
from training.evaluate.ablations import SMALL, VARIANTS, ConcatDenoiser, UnsharedDenoiser
from training.evaluate.extractor import Extractor, save
from training.evaluate.extractor import Settings as ExtractorSettings
from training.evaluate.judge import retrieval
from training.prepare import Scenes
from training.prepare import save as save_scenes

SIZES = {"latent_dim": 32, "ff_size": 32, "num_layers": 2, "num_heads": 2, "cond_dim": 32}
CONFIG = InterGenConfig(input_features=20, role_embedding=True, **SIZES)


@pytest.mark.parametrize("network", [ConcatDenoiser, UnsharedDenoiser])
def test_networks_see_the_other_person_but_no_padding(network: type[InterGenDenoiser]) -> None:
    torch.manual_seed(0)
    model = network(CONFIG).eval()
    for parameter in model.parameters():
        torch.nn.init.normal_(parameter, std=0.2)
    x, t, cond = torch.randn(2, 6, 40), torch.tensor([3, 700]), torch.randn(2, 32)
    mask = torch.ones(2, 6, 2)
    mask[:, 4:] = 0
    base = model(x, t, cond, mask)
    assert base.shape == x.shape
    other, padded = x.clone(), x.clone()
    other[:, 1, 20:] += 1
    padded[:, 5] += 1
    assert not torch.allclose(model(other, t, cond, mask)[:, :4, :20], base[:, :4, :20])
    torch.testing.assert_close(model(padded, t, cond, mask)[:, :4], base[:, :4])


def test_unshared_has_layers_for_each_person_and_concat_no_mutual_attention() -> None:
    whole = sum(p.numel() for p in InterGenDenoiser(CONFIG).blocks.parameters())
    assert sum(p.numel() for p in UnsharedDenoiser(CONFIG).blocks.parameters()) == 2 * whole
    assert not any("ca_block" in name for name in ConcatDenoiser(CONFIG).state_dict())


def test_variants_differ_from_the_whole_in_one_thing() -> None:
    for variant in VARIANTS.values():
        assert len(variant.changes) + (variant.denoiser is not InterGenDenoiser) <= 1
    for name, variant in VARIANTS.items():
        settings = variant.settings(SMALL)
        assert settings.noisiest == (0.0 if name.startswith("even") else SMALL.noisiest)
        t_bar = float(name.rpartition("t_bar_")[2]) if "t_bar_" in name else SMALL.t_bar
        assert settings == replace(SMALL, noisiest=settings.noisiest, t_bar=t_bar, weights=settings.weights)
    assert VARIANTS["no_distance_map"].changes["weights"] == replace(SMALL.weights, distance_map=0.0)


@pytest.fixture
def options(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> argparse.Namespace:
    layout, rng = TokenLayout(), np.random.default_rng(0)
    rest = SMPL22.rest_positions() + np.array([0, 0.98, 0])
    frames, parts, rows = layout.num_frames(6), [], []
    for i in range(12):
        pair = np.stack([rest, rest + np.array([0, 0, 1.2])])[:, None] + rng.normal(
            0, 0.02, (2, frames, 1, 3)
        )
        pair = torch.tensor(pair, dtype=torch.float32)
        parts.append(encode(pair, foot_contacts(pair), layout).transpose(0, 1).half())
        rows.append(
            {"start": 12 * i, "tokens": 6, "family": "stand", "captions": [f"Two people stand, {i}."]}
            | {"events": {"facing": True}, "split": "test" if i < 4 else "train", "sources": []}
        )
    save_scenes(Scenes(torch.cat(parts), rows, layout), tmp_path / "scenes.safetensors")
    save(Extractor(ExtractorSettings(width=32, num_layers=1, features=8), layout), tmp_path / "e.safetensors")
    monkeypatch.setattr(retrieval, "POOL", 4)
    return argparse.Namespace(
        scenes=tmp_path / "scenes.safetensors", extractor=tmp_path / "e.safetensors", out=tmp_path / "runs",
        table=tmp_path / "table.md", variants=["whole", "concat"], steps=2, prompts=4, repeats=1,
        sampling_steps=2, device="cpu",
    )  # fmt: skip


def test_command_trains_judges_and_goes_on(
    options: argparse.Namespace, capsys: pytest.CaptureFixture[str]
) -> None:
    small = replace(SMALL, batch=4, warmup=1, **SIZES)
    options.variants = ["concat"]
    ablations._run(options, small)
    first = (options.out / "concat" / "scores.json").read_text()
    options.variants = ["whole", "concat"]
    ablations._run(options, small)
    assert (options.out / "concat" / "scores.json").read_text() == first
    lines = options.table.read_text().splitlines()
    assert [line.split(" | ")[0] for line in lines if line.startswith("| ")] == [
        "| Variant", "| real motion", "| whole, t̄ = 0.7", "| concatenation for mutual attention",
    ]  # fmt: skip
    assert "2 steps of 4" in lines[0]
    assert json.loads(first)["features"]["generated"]["FID"][0] > 0


def test_damaged_scores_are_named(options: argparse.Namespace) -> None:
    options.variants = ["whole"]
    (options.out / "whole").mkdir(parents=True)
    (options.out / "whole" / "scores.json").write_text("{")
    with pytest.raises(InputError, match="delete it to judge whole again"):
        ablations._run(options)
