"""Errors on the test split: networks are compared on the same scenes and noise."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
import torch

from tests.training.trainers.runs import SETTINGS, begin, prepared, take
from training import prepare
from training.evaluate import held_out

SIXTEEN = 20


@pytest.fixture(scope="module")
def scenes(tmp_path_factory: pytest.TempPathFactory) -> Path:
    def edit(rows: list[dict[str, Any]]) -> None:
        for i, row in enumerate(rows):
            row["split"] = "test" if i < SIXTEEN else "train"

    return prepared(tmp_path_factory.mktemp("made"), scenes=SIXTEEN + 10, edit=edit)


def test_runs_are_compared_by_timestep(
    scenes: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(held_out, "TIMESTEPS", (5, 999))
    for seed in (0, 1):
        trainer = begin(scenes, tmp_path / f"run-{seed}", replace(SETTINGS, seed=seed))
        with torch.no_grad():  # a network that gives back what it sees: no error where nothing is noised
            for module in (trainer.model, trainer.ema):
                for parameter in module.denoiser.out.parameters():
                    parameter.zero_()
        take(trainer, 0)
    near, far = (held_out.errors(trainer.ema, trainer.data, "nothing", 1, k * trainer.data.std) for k in (1, 2))
    torch.testing.assert_close(near, 4 * far)  # in the units that are asked for, whatever the network's are
    runs = [str(tmp_path / f"run-{seed}") for seed in (0, 1)]
    words = ["--scenes", str(scenes), "--cache", str(tmp_path), "--batches", "1", "--models", *runs]
    capsys.readouterr()
    assert held_out.main([*words, "--given", "nothing", "person"]) == 0
    found = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert [(f["model"], f["given"]) for f in found] == [
        (f"run-{seed}", given) for seed in (0, 1) for given in ("nothing", "person")
    ]
    for plain, given in (found[:2], found[2:]):
        # A network that predicts the mean errs as much at every timestep, and half where one of two is given.
        assert plain["5"] == plain["999"] > 0.1
        assert given["5"] < 0.95 * plain["5"]
    assert found[0]["5"] == pytest.approx(found[2]["5"], rel=1e-3)


def test_too_few_scenes_are_refused(scenes: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    loaded = prepare.load(scenes)
    loaded.rows = loaded.rows[15:]
    prepare.save(loaded, tmp_path / "few.safetensors")
    words = ["--scenes", str(tmp_path / "few.safetensors"), "--cache", str(tmp_path), "--models", str(tmp_path)]
    assert held_out.main(words) == 2
    assert "holds 5 scenes" in capsys.readouterr().err
