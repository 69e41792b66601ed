"""The scores of classes: what is asked of a motion, who names its class, and the table."""

from __future__ import annotations

import json
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import torch

from motion import InputError
from tests.training.trainers.runs import HANDS_MEET, write_corpus
from training import prepare
from training.corpus.cues import Beat
from training.corpus.cues import label as label_of
from training.evaluate.classes import (
    accuracy,
    evaluate,
    fit_classifier,
    known_classes,
    right_handed,
    table,
    tasks_of,
)
from training.evaluate.judge.prompts import real_duet
from training.prepare import Scenes
from webdemo.inference import GenerateRequest, Result

LABELS = ("shake hands", "wave")


@pytest.fixture(scope="module")
def scenes(tmp_path_factory: pytest.TempPathFactory) -> Scenes:
    """Handshakes and waves in turn, the last six of the test split."""
    folder = tmp_path_factory.mktemp("scores")
    corpus = write_corpus(folder / "corpus", scenes=20)
    rows = json.loads((corpus / "index.json").read_text())
    for i, row in enumerate(rows):
        cue = "shake-hands" if i % 2 else "wave"
        known = label_of([Beat((cue, cue), 0, row["frames"], relation="while")], row["frames"]).row()
        row |= {"family": "handshake" if i % 2 else "wave-back", "label": known, "beats": []}
        row["split"] = "test" if i >= 14 else "train"
    (corpus / "index.json").write_text(json.dumps(rows))
    assert prepare.main(["--corpus", str(corpus), "--out", str(folder / "scenes.safetensors")]) == 0
    return prepare.load(folder / "scenes.safetensors")


def test_a_classifier_names_separable_classes_and_no_others() -> None:
    rng = np.random.default_rng(0)
    labels = torch.from_numpy(rng.integers(4, size=200))
    apart = torch.eye(4)[labels] + 0.1 * torch.from_numpy(rng.normal(size=(200, 4))).float()
    first, best = accuracy(fit_classifier(apart, labels, 4), apart, labels)
    assert first > 0.98 and best == 1
    wrong = (labels + 1) % 4
    assert accuracy(fit_classifier(apart, labels, 4), apart, wrong)[0] < 0.05


def test_a_task_holds_the_events_of_a_recorded_right_handed_scene(scenes: Scenes) -> None:
    rng = np.random.default_rng(0)
    for label, touches in zip(LABELS, (HANDS_MEET, None), strict=True):
        tasks = tasks_of(scenes, label, rng, 3)
        assert [task.caption for task in tasks] == [label] * 3
        assert all(task.events.get("contact") == touches for task in tasks)
        assert all(30 < task.frames < 70 for task in tasks)
    rows: list[dict[str, Any]] = [{"hand": "left"}, {"hand": "right"}, {}]
    assert right_handed(rows) == rows[1:]


def test_recorded_motion_given_as_made_scores_as_recorded_motion(scenes: Scenes) -> None:
    """An engine that gives back recorded scenes of the class, and features that see the class."""
    pool = {label: [] for label in LABELS}
    for row in scenes.rows:
        pool[LABELS[row["family"] == "wave-back"]].append(real_duet(scenes, row))
    seen = {
        duet.positions.tobytes()[:4096]: place for place, name in enumerate(LABELS) for duet in pool[name]
    }
    engine: Any = SimpleNamespace(
        run=lambda request: iter([Result(duets=tuple(pool[request.prompt][: request.samples]), manifest={})])
    )
    extractor: Any = SimpleNamespace(
        of_positions=lambda x: torch.eye(2)[seen[x.numpy().tobytes()[:4096]]] + 0.01 * x.mean()
    )
    found = evaluate(scenes, extractor, engine, LABELS, samples=2, steps=2)
    assert found["generated"]["accuracy"] == found["real"]["accuracy"] == (1, 1)
    assert found["missed"] == {} and found["generated"]["checks"]["contact"]["count"] == 2
    assert found["tested"] == list(LABELS)
    shared = [set(row["sources"]) for row in scenes.split("train")]
    assert bool(found["known"]) == any(
        set(row["sources"]) & s for row in scenes.split("test") for s in shared
    )
    page = table(found | {"known": ["wave"]}, "About it.")
    assert "Recorded test scenes show 2 of the classes." in page
    assert "Those of 1 share a recording with training scenes" in page
    assert page.startswith("About it.\n") and "| class recognised | 100% | 100% |" in page
    swapped: Any = SimpleNamespace(
        run=lambda r: engine.run(GenerateRequest(prompt=LABELS[r.prompt == LABELS[0]], samples=r.samples))
    )
    wrong = evaluate(scenes, extractor, swapped, LABELS, samples=2, steps=2)
    assert wrong["generated"]["accuracy"][0] == 0 and wrong["missed"] == dict.fromkeys(LABELS, 2)
    assert "Most often taken for another class: shake hands (2); wave (2)." in table(wrong, "")


def test_weights_are_scored_on_their_own_classes_alone(scenes: Scenes) -> None:
    assert {row["family"] for row in known_classes(scenes, ["wave"]).rows} == {"wave-back"}
    with pytest.raises(InputError, match=r"no training scene of spar: score these weights on the corpus"):
        known_classes(scenes, ["wave", "spar"])
    train = Scenes(scenes.control, scenes.split("train"), scenes.layout)
    with pytest.raises(InputError, match="no test scene"):
        known_classes(train, LABELS)
