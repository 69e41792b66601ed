"""The trainer of the virtual agent's recogniser, on a corpus that takes a moment to make."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import torch
from safetensors.torch import load_file

from models.agent.recogniser import FRAMES, load_folder
from motion import InputError
from tests.training.trainers.runs import write_corpus
from training.trainers import recogniser
from training.trainers.recogniser import GESTURES, Settings, Trainer, cut, scores
from webdemo.inference.pipelines.predictor import PredictorPipeline

SETTINGS = Settings(windows=2, seen="known", batch=8, steps=4, warmup=2)
STILL = PredictorPipeline(None)


@pytest.fixture(scope="module")
def corpus(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Scenes of 40 to 60 frames, a wave and a bow in turn, the last two of the test split."""
    folder = write_corpus(tmp_path_factory.mktemp("gestures") / "corpus", scenes=30)
    rows = json.loads((folder / "index.json").read_text())
    motions = np.load(folder / "motions.npy")
    long = []  # twice as long, so that the agent may look
    for i, row in enumerate(rows):
        motion = motions[row["start"] : row["start"] + row["frames"]]
        long.append(np.concatenate([motion, motion[::-1]]))
        row |= {"family": ("wave-back", "bow-back")[i % 2], "split": "test" if i > 27 else "train"}
        row |= {"start": sum(map(len, long[:-1])), "frames": len(long[-1])}
    np.save(folder / "motions.npy", np.concatenate(long))
    (folder / "index.json").write_text(json.dumps(rows))
    return folder


def test_windows_are_of_first_people_and_of_one_split(corpus: Path) -> None:
    windows, labels = cut(corpus, SETTINGS, "train", STILL)
    assert windows.shape[1:] == (FRAMES, 22, 3) and len(windows) == len(labels)
    names = list(GESTURES)
    assert {names[i] for i in labels.tolist()} == {"wave", "bow"}
    known = 9  # the last known frame, in whose pose the person stands over the origin
    assert windows[:, known, 0, [0, 2]].abs().max() < 1e-5
    held = windows[:, known:].diff(dim=1).abs().amax()
    assert held == 0
    recorded, _ = cut(corpus, Settings(windows=2, seen="recorded"), "train", STILL)
    assert recorded[:, known:].diff(dim=1).abs().amax() > 1e-3
    assert len(cut(corpus, SETTINGS, "test", STILL)[0]) < len(windows)


def test_a_corpus_without_gestures_is_refused(corpus: Path, tmp_path: Path) -> None:
    rows = json.loads((corpus / "index.json").read_text())
    (tmp_path / "index.json").write_text(json.dumps([row | {"family": "sequence"} for row in rows]))
    (tmp_path / "motions.npy").write_bytes((corpus / "motions.npy").read_bytes())
    with pytest.raises(InputError, match="no scenes of the train split with a known gesture"):
        cut(tmp_path, SETTINGS, "train", STILL)
    with pytest.raises(InputError, match="give predicted, recorded or known"):
        Settings(seen="dreamt")


def test_a_family_is_of_one_gesture_and_the_first_asks_for_no_answer() -> None:
    families = [family for _, found in GESTURES.values() for family in found]
    assert len(families) == len(set(families))
    assert next(iter(GESTURES)) == recogniser.NOTHING


def test_a_run_that_stops_goes_on_as_if_it_never_had(corpus: Path, tmp_path: Path) -> None:
    torch.set_num_threads(1)
    data = cut(corpus, SETTINGS, "train", STILL)
    straight = Trainer(data, SETTINGS, tmp_path / "straight")
    losses = [terms["loss"] for terms in straight.run(minutes=10)]
    assert len(losses) == 4 and losses[-1] < losses[0]
    stopped = Trainer(data, SETTINGS, tmp_path / "stopped")
    stopped.train_step()
    stopped.save()
    resumed = Trainer(data, SETTINGS, tmp_path / "stopped")
    assert resumed.step == 1 and len(list(resumed.run(minutes=10))) == 3
    one, other = (load_file(tmp_path / name / "last.safetensors") for name in ("straight", "stopped"))
    assert [key for key in one if not torch.equal(one[key], other[key])] == []
    found = scores(straight.ema, *data)
    assert 0 <= found["named"] <= found["among three"] <= 1 and set(found["by gesture"]) == {"wave", "bow"}


def test_the_shell_writes_the_folder_that_is_shipped(
    corpus: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["--corpus", str(corpus), "--out", str(tmp_path / "run"), "--export", str(tmp_path / "agent")]
    assert recogniser.main([*words, "--seen", "known", "--windows", "1", "--batch", "4", "--steps", "2"]) == 0
    printed, answers = map(json.loads, capsys.readouterr().out.splitlines()[-2:])
    network, source = load_folder(tmp_path / "agent")
    assert network.config.labels == tuple(GESTURES)
    assert source.meta["test"]["named"] == round(printed["named"], 3)
    assert answers["scenes"] == 2 and answers["named"] in (0, 0.5, 1) and 1.5 <= answers["stops"] <= 4
