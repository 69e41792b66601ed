"""Corpus → tensors → checkpoint → shipped folder, on a corpus that takes a moment to make."""

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch
from safetensors import SafetensorError
from safetensors.torch import load_file

from models.intergen.compact import CompactInterGen
from models.weights_io import load_network
from motion import InputError
from tests.training.trainers.runs import SETTINGS, SIZES, begin, flags, prepared, resumed, write_corpus
from training import prepare
from training.core import checkpoint
from training.evaluate import held_out
from training.trainers import intergen, touch
from webdemo.inference import GenerateRequest, Result
from webdemo.inference.engine import Engine

SIZED = flags(SETTINGS, *SIZES)


@pytest.fixture(scope="module")
def scenes(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return prepared(tmp_path_factory.mktemp("made"))


@pytest.fixture(scope="module")
def trained(scenes: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a run of six steps, made by the command."""
    out = tmp_path_factory.mktemp("run")
    assert intergen.main(["--scenes", str(scenes), "--out", str(out), *SIZED, "--steps", "6"]) == 0
    return out


def export(scenes: Path, run: Path, out: Path) -> None:
    words = ["--scenes", str(scenes), "--out", str(run), *SIZED, "--steps", "6", "--export", str(out)]
    assert intergen.main(words) == 0


def test_a_run_that_stops_goes_on_as_if_it_never_had(scenes: Path, tmp_path: Path) -> None:
    _, kept = resumed(lambda out: begin(scenes, out), tmp_path)
    assert {key.split("/")[0] for key in kept} == {"model", "ema", "optimizer"}
    fresh = begin(scenes, tmp_path / "fresh").model.state_dict()
    assert any(not torch.equal(value, kept[f"model/{name}"]) for name, value in fresh.items())


def test_checkpoint_of_other_settings_is_refused(scenes: Path, trained: Path) -> None:
    with pytest.raises(InputError, match="run of other settings"):
        begin(scenes, trained, replace(SETTINGS, learning_rate=1e-3))


def test_init_begins_with_the_averaged_weights_of_another_run(scenes: Path, trained: Path, tmp_path: Path) -> None:
    other = load_file(trained / "last.safetensors")
    new = begin(scenes, tmp_path, replace(SETTINGS, learning_rate=1e-3), init=trained / "last.safetensors")
    assert new.step == 0
    for module in (new.model, new.ema):
        assert all(torch.equal(value, other[f"ema/{key}"]) for key, value in module.state_dict().items())
    with pytest.raises(InputError, match="other sizes"):
        begin(scenes, tmp_path / "b", replace(SETTINGS, latent_dim=64), init=trained / "last.safetensors")


def test_export_ships_what_the_engine_runs(scenes: Path, trained: Path, tmp_path: Path) -> None:
    out = tmp_path / "weights" / "intergen"
    export(scenes, trained, out)
    engine = Engine(out.parent)
    assert engine.info()["summary"] == intergen.SUMMARY
    *_, result = engine.run(GenerateRequest(prompt="They shake hands.", seconds=1.0, steps=2, damping=0.0))
    assert isinstance(result, Result)
    assert result.duets[0].positions.shape == (2, 30, 22, 3)
    assert np.isfinite(result.duets[0].positions).all()
    meta = json.loads((out / "config.json").read_text())
    assert meta["trained_steps"] == 6
    assert json.loads((out / "captions.json").read_text()) == ["One person waves the left hand.", "They shake hands."]


def test_a_network_of_fewer_blocks_learns_from_a_shipped_one(
    scenes: Path, trained: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("training.trainers.touch.RARE", 1)  # the teacher reads touches
    export(scenes, trained, tmp_path / "teacher")
    words = ["--scenes", str(scenes), *SIZED, "--steps", "6", "--teacher", str(tmp_path / "teacher"), "--blocks"]
    assert intergen.main([*words, "1", "--out", str(tmp_path / "run"), "--export", str(tmp_path / "made")]) == 0
    teacher, made = (load_network(tmp_path / name, CompactInterGen)[0] for name in ("teacher", "made"))
    assert (teacher.config.num_layers, made.config.num_layers) == (2, 1)
    again = begin(scenes, tmp_path / "again", teacher=tmp_path / "made")
    assert held_out.load_model(tmp_path / "run", again.data).config.num_layers == 1
    text = made.conditioner.state_dict()
    assert all(torch.equal(value, text[name]) for name, value in teacher.conditioner.state_dict().items())
    assert intergen.main([*words, "2", "--out", str(tmp_path / "other")]) == 2
    for blocks, alike in (((), True), ((1,), False)):
        run = begin(scenes, tmp_path / f"{alike}", teacher=tmp_path / "teacher", blocks=blocks)
        run.model.eval()
        drawn = run.next_draw()
        taught = run.terms(drawn, run.normal(drawn.batch.x0))["taught"]
        assert (taught.item() < 1e-6) is alike


def corpus_cut_short(folder: Path) -> None:
    write_corpus(folder)
    motions = np.load(folder / "motions.npy")
    np.save(folder / "motions.npy", motions[:50])


def corpus_of_one_person(folder: Path) -> None:
    write_corpus(folder)
    motions = np.load(folder / "motions.npy")
    np.save(folder / "motions.npy", motions[:, 0])


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (lambda folder: None, "holds no readable corpus"),
        (corpus_cut_short, "more frames than there are"),
        (corpus_of_one_person, "another kind of data"),
    ],
)
def test_bad_corpus_is_refused_in_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], make: Callable[[Path], None], says: str
) -> None:
    make(tmp_path / "corpus")
    out = tmp_path / "scenes.safetensors"
    assert prepare.main(["--corpus", str(tmp_path / "corpus"), "--out", str(out)]) == 2
    said = capsys.readouterr().err
    assert says in said
    assert said.count("\n") == 1
    assert not out.exists()


def test_a_full_disk_leaves_the_last_checkpoint(
    scenes: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["--scenes", str(scenes), "--out", str(tmp_path), *SIZED, "--steps", "4"]
    assert intergen.main([*words, "--minutes", "0"]) == 0
    before = (tmp_path / "last.safetensors").read_bytes()

    def fill(tensors: object, path: Path, metadata: object) -> None:
        Path(path).write_bytes(b"half")
        raise SafetensorError("I/O error: No space left on device (os error 28)")

    monkeypatch.setattr(checkpoint, "save_file", fill)
    assert intergen.main(words) == 2
    assert "free disk space" in capsys.readouterr().err
    assert (tmp_path / "last.safetensors").read_bytes() == before
    assert not list(tmp_path.glob(".last*"))


def test_a_shipped_network_can_be_trained_on(
    scenes: Path, trained: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("training.trainers.touch.RARE", 1)
    out = tmp_path / "weights"
    export(scenes, trained, out)
    shipped, _ = load_network(out, CompactInterGen)
    assert shipped.touch_reader is not None
    ours = begin(scenes, tmp_path / "on", init=out).model.state_dict()
    theirs = shipped.state_dict()
    assert set(theirs) - set(ours) == {key for key in theirs if key.startswith("touch_reader.")}
    assert all(torch.equal(value, theirs[key]) for key, value in ours.items())
    loaded, learned, examples = prepare.load(scenes), list[dict[str, Any]](), touch.examples
    loaded.rows[0] |= {"events": {}, "label": None}  # of which nobody knows what touches
    monkeypatch.setattr(touch, "examples", lambda rows: (learned.extend(rows), examples(rows))[1])
    monkeypatch.setattr(touch, "fit", lambda *_, **__: None)
    touch.with_touches(shipped, loaded)
    assert loaded.rows[1] in learned and loaded.rows[0] not in learned
    with pytest.raises(InputError, match="not InterGen weights of one size"):
        begin(scenes, tmp_path / "wide", replace(SETTINGS, latent_dim=64), init=out)
