"""The mean of two predictors lies between them."""

from __future__ import annotations

from pathlib import Path

import pytest
import torch

from models.motion_mlp import MotionMLP, MotionMLPConfig
from models.predictors import load_predictor, save_predictor
from training.trainers.prediction import mean


@pytest.fixture
def folders(tmp_path: Path) -> list[Path]:
    """Two networks of one size and one of another, of constant weights 0, 1 and 1."""
    found = []
    for name, width, value in (("zero", 16, 0.0), ("one", 16, 1.0), ("wide", 24, 1.0)):
        network = MotionMLP(MotionMLPConfig(width=width, blocks=1))
        for parameter in network.parameters():
            torch.nn.init.constant_(parameter, value)
        found.append(tmp_path / name)
        save_predictor(found[-1], network, kind="mlp", fps=30.0, training={"steps": len(found)})
    return found


def test_the_mean_lies_between(folders: list[Path], tmp_path: Path) -> None:
    zero, one, _ = map(str, folders)
    for share, asked in ((0.5, []), (0.25, ["--share", "0.25"])):
        assert mean.main([zero, one, *asked, "--out", str(tmp_path / "out")]) == 0
        made = load_predictor(tmp_path / "out")
        assert all(torch.all(value == share) for value in made.network.parameters())
        assert (made.fps, made.training) == (30.0, {"steps": 2})


def test_what_has_no_mean_is_one_sentence(
    folders: list[Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    zero, one, wide = map(str, folders)
    for asked, sentence in (([zero, wide], "not of one network"), ([zero, one, "--share", "2"], "from 0 to 1")):
        assert mean.main([*asked, "--out", str(tmp_path / "out")]) == 2
        assert sentence in capsys.readouterr().err
        assert not (tmp_path / "out").exists()
