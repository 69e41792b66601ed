"""Trainings of predictors: they learn, stop and resume exactly, and write what the engine reads."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch

from models.motion_mlp import MotionMLP, MotionMLPConfig
from models.weights_io import save_network
from motion import SMPL22, InputError
from motion.transforms import heading
from tests.training.trainers.runs import flags, resumed
from training.evaluate import prediction as product
from training.trainers import mawgan
from training.trainers import motion_mlp as mlp
from training.trainers.prediction import PredictionTrainer, Windows
from webdemo.inference.pipelines.predictor import load_predictor

MLP = mlp.Settings(
    past=10,
    future=8,
    past_coefficients=6,
    future_coefficients=4,
    width=16,
    blocks=1,
    fit=64,
    batch=8,
    steps=6,
    warmup=1,
)
GAN = mawgan.Settings(past=10, future=8, fc=36, width=32, critic_fc=8, critic_steps=2, batch=4, steps=3)
LEAN_GAN = replace(GAN, critic_steps=1, final_rate=0.1, position=100.0, linear=True, length=True)


@pytest.fixture(scope="module")
def corpus(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two scenes of two people who sway; the second is of the test split."""
    folder = tmp_path_factory.mktemp("corpus")
    times = np.arange(120)[:, None, None, None] / 30
    phase = np.array([0.0, 1.0])[:, None, None]
    sway = 0.1 * np.sin(5 * times + phase) * np.linspace(0, 1, 22)[:, None]
    place = np.array([[0.0, 1.0, 0.0], [1.0, 1.0, 2.0]])[:, None]
    np.save(folder / "motions.npy", (SMPL22.rest_positions() + place + sway).astype(np.float32))
    rows = [{"start": 60 * i, "frames": 60, "split": split} for i, split in enumerate(("train", "test"))]
    (folder / "index.json").write_text(json.dumps(rows))
    return folder


def start(kind: str, corpus: Path, out: Path, **changed: int) -> PredictionTrainer:
    windows = Windows(corpus, 10, 8)
    if kind == "mlp":
        return mlp.Trainer(windows, replace(MLP, **changed), out)
    return mawgan.Trainer(windows, replace(LEAN_GAN if kind == "lean" else GAN, **changed), out)


def test_windows_are_of_one_split_in_the_frame_of_their_last_pose(corpus: Path) -> None:
    windows = Windows(corpus, 10, 8)
    assert windows.starts.min() == 0 and windows.starts.max() == 42
    batch = windows.batch(6, (0, 1))
    assert batch.shape == (6, 18, 22, 3) and torch.equal(batch, windows.batch(6, (0, 1)))
    assert not torch.equal(batch, windows.batch(6, (0, 2)))
    assert np.allclose(batch[:, 9, 0, [0, 2]], 0, atol=1e-6)
    assert np.allclose(heading(batch[:, 9].numpy().astype(float)), 0, atol=1e-5)


@pytest.mark.parametrize("kind", ["mlp", "mawgan", "lean"])
def test_a_run_that_stops_goes_on_as_if_it_had_not(kind: str, corpus: Path, tmp_path: Path) -> None:
    resumed(lambda out: start(kind, corpus, out), tmp_path, steps=3, stops=1)
    with pytest.raises(InputError, match="other settings"):
        start(kind, corpus, tmp_path / "parts", seed=1)


@pytest.mark.parametrize("kind", ["mlp", "mawgan"])
def test_the_shell_writes_a_predictor(kind: str, corpus: Path, tmp_path: Path) -> None:
    settings, main = (MLP, mlp.main) if kind == "mlp" else (GAN, mawgan.main)
    asked = flags(settings, *(name for name, value in vars(settings).items() if not isinstance(value, bool)))
    folders = ["--data", str(corpus), "--out", str(tmp_path / "run"), "--export", str(tmp_path / "folder")]
    assert main([*asked, *folders]) == 0
    predictor, source = load_predictor(tmp_path / "folder")
    sizes = predictor.config
    assert (sizes.past, sizes.future, sizes.joints) == (10, 8, 22)
    assert source.meta["training"]["steps"] == settings.steps
    assert main([*asked, *folders, "--data", str(tmp_path)]) == 2


def test_mean_speeds_are_matched_by_the_mean_of_what_may_follow() -> None:
    """Three of four people stand; their mean moves by a quarter of the one who walks."""
    ahead = torch.tensor([1.0, 0.0, 0.0])
    real = torch.zeros(4, 11, 22, 3)
    real[0] = 4 * ahead
    assert float(mlp.speed_gap(torch.zeros_like(real), real)) == pytest.approx(1.0, abs=1e-4)
    assert float(mlp.speed_gap(ahead.expand_as(real), real)) < 1e-4


def test_the_page_s_predictions_are_scored(tmp_path: Path) -> None:
    """On two people who glide off by 2 cm a frame."""
    folder = tmp_path / "corpus"
    folder.mkdir()
    along = 0.02 * np.arange(200)[:, None, None, None] * np.array([0.0, 0.0, 1.0])
    people = np.repeat(SMPL22.rest_positions()[None], 2, axis=0)
    np.save(folder / "motions.npy", (people + along).astype(np.float32))
    (folder / "index.json").write_text(json.dumps([{"start": 0, "frames": 200, "split": "test"}]))
    page = tmp_path / "page.md"
    tiny = MotionMLP(MotionMLPConfig(width=16, blocks=1))
    save_network(tmp_path / "tiny", tiny, kind="mlp", fps=30.0)
    asked = ["--data", str(folder), "--weights", str(tmp_path), "--model", "tiny", "--windows", "4"]
    assert product.main([*asked, "--table", str(page)]) == 0
    text = page.read_text()
    assert "| still, mm | 40 | 100 | 200 | 300 | 600 | 1200 | 1800 | 2400 |" in text
    assert "| tiny, mm |" in text and "still, speed" not in text
    assert "| first step within the past's largest | 100.0% | 100.0% | 100.0% |" in text
    assert "| slowest and fastest step over the truth's | 1.00 to 1.00 | 0.00 to 0.00 |" in text
    assert product.main([*asked, "--model", "missing"]) == 2
