"""A corpus from a few made-up recordings to classes of prepared scenes: motion, labels, captions, all anew."""

from __future__ import annotations

import json
from collections import Counter
from pathlib import Path

import numpy as np
import pytest

from acts.reading import read
from models.motion_tokens import TokenLayout
from tests.training.corpus.recorded import SOURCES
from training.corpus import __main__ as command
from training.corpus import build
from training.corpus.cues import Label, class_of
from training.corpus.library import Library
from training.prepare import prepare
from training.trainers.bigraphdiff import labels_of, of_classes


@pytest.fixture(scope="module")
def corpus(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """144 seconds of beats."""
    folder = tmp_path_factory.mktemp("corpus")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(build, "load_sources", lambda data: SOURCES)
        words = ["--data", str(folder), "--out", str(folder), "--hours", "0.04"]
        assert command.main(words) == 0
    return folder


def rows(corpus: Path) -> list[dict]:
    return json.loads((corpus / "index.json").read_text())


def test_every_scene_has_a_plan_that_its_captions_tell(corpus: Path) -> None:
    found = rows(corpus)
    assert {row["family"].split("-")[0] for row in found} == {"beats"}
    assert {row["split"] for row in found} == {"train", "test"}
    captions = right = 0
    for row in found:
        known = Label.model_validate(row["label"])
        assert known.plan.acts and all(0 <= a < b <= row["frames"] for a, b in known.spans.values())
        acts = {act.act for act in known.plan.acts}
        assert len(set(row["captions"])) == len(row["captions"]) >= 3
        assert all(row["alone"])
        for text in row["captions"]:
            captions += 1
            told = {act.act for act in read(text).acts}
            right += bool(told) and told <= acts
    assert right >= 0.9 * captions


def test_a_scene_has_its_class_from_its_label(corpus: Path) -> None:
    scenes = of_classes(prepare(corpus, TokenLayout()))
    assert {sum(not beat["minor"] for beat in row["beats"]) for row in scenes.rows} <= {0, 1}
    names, touches = labels_of(scenes)
    assert names and len(touches) == len(names)
    assert all(class_of(row) in names for row in scenes.split("train"))


def test_a_written_corpus_reads_back(corpus: Path, tmp_path: Path) -> None:
    scenes = build.draw(np.random.default_rng(0), Library(SOURCES, "train"), 600, Counter())
    assert sum(scene.positions.shape[1] for scene in scenes) >= 600
    build.save(scenes, tmp_path)
    motions = np.load(tmp_path / "motions.npy", allow_pickle=False)
    index = json.loads((tmp_path / "index.json").read_text())
    assert motions.shape == (sum(entry["frames"] for entry in index), 2, 22, 3)
    for entry, scene in zip(index, scenes, strict=True):
        part = motions[entry["start"] : entry["start"] + entry["frames"]]
        np.testing.assert_array_equal(part.swapaxes(0, 1), scene.positions)
        assert entry["captions"] == scene.captions
    assert sorted(path.name for path in tmp_path.iterdir()) == ["index.json", "motions.npy"]


def test_where_no_scene_passes_the_build_goes_on_without(monkeypatch, caplog) -> None:
    monkeypatch.setattr(build, "fault", lambda scene: "broken")
    monkeypatch.setattr(build, "TRIES", 3)
    rejected = Counter[str]()
    assert build.draw(np.random.default_rng(0), Library(SOURCES, "train"), 400, rejected) == []
    assert rejected["beats: broken"] > 1
    assert "No more scenes for the train split: broken" in caplog.text
