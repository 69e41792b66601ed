"""What the handlers of the Predict tab do, without a browser, and what its pictures hold."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import gradio as gr
import numpy as np
import pytest

from motion.formats import read, write
from tests.ui.stub_engine import drift, walking
from tests.ui.tab_events import built, changes, taken
from tests.view.packed import unpack_positions
from webdemo.inference.engine import Engine
from webdemo.inference.methods import methods
from webdemo.inference.requests.predict import PredictRequest, PredictResult
from webdemo.ui.api import PredictEndpoint
from webdemo.ui.components.exports import Record, write_files
from webdemo.ui.components.prediction_view import error_lines, prediction_payload, still_error
from webdemo.ui.tabs.predict import PredictTab, predict_choices


@pytest.fixture
def tab(tmp_path: Path) -> PredictTab:
    return built(PredictTab, tmp_path / "files")


@pytest.fixture
def pair(tmp_path: Path) -> Path:
    return write(walking(4.0), tmp_path / "walkers.npz")[0]


def loaded(tab: PredictTab, path: Path) -> dict[str, Any]:
    return [taken(tab.past, updates) for updates in tab.past.upload(str(path))][-1]


def run(tab: PredictTab, fields: dict[str, Any]) -> dict[str, Any]:
    return [changes(tab.outputs, updates) for updates in tab.run("me", {"seed": 0, **fields})][-1]


def test_a_motion_is_shown_and_the_marker_leaves_two_seconds_behind_it(tab: PredictTab, pair: Path) -> None:
    found = loaded(tab, pair)
    assert "two people, 4.0 s" in found["line"]
    assert found["marker"]["maximum"] == 4.0 and 1.0 <= found["marker"]["value"] <= 2.0
    assert len(found["state"].people) == 2 and found["player"]["value"]["samples"][0]["frames"] == 120


def test_on_the_first_example_the_default_method_beats_the_last_pose_held(tab: PredictTab) -> None:
    found = loaded(tab, tab.past.examples[0][1])
    fields = {"source": found["state"], "marker": found["marker"]["value"], "seconds": PredictRequest.seconds}
    *_, result = Engine().run(tab.request({**fields, "model": PredictRequest.model}))
    assert isinstance(result, PredictResult)
    assert 2 * np.mean(result.error) < np.mean(still_error(result))


def test_a_prediction_marks_the_past_and_shows_the_truth_as_a_ghost(tab: PredictTab, pair: Path) -> None:
    source = loaded(tab, pair)["state"]
    done = run(tab, {"source": source, "marker": 3.0, "seconds": 2.0, "model": "motion-mlp"})
    (sample,) = done["player"]["value"]["samples"]
    assert (sample["past_until"], sample["frames"]) == (90, 150)
    ghost, shown = unpack_positions(sample["ghost"]), unpack_positions(sample["positions"])
    assert ghost.shape == shown.shape == (2, 150, 22, 3)
    truth = walking(4.0).positions
    assert np.allclose(ghost[:, :120], truth, atol=2e-3)
    assert np.allclose(ghost[:, 120:], truth[:, -1:], atol=2e-3)
    assert [curve["label"] for curve in sample["curves"]] == ["Error", "Speed"]
    assert sample["curves"][0]["values"][89:92] == [0.0, 0.01, 0.02]
    assert "Made" in done["line"] and isinstance(done["record"], Record)


def test_the_last_result_is_continued_from_its_end(tab: PredictTab, pair: Path) -> None:
    source = loaded(tab, pair)["state"]
    done = run(tab, {"source": source, "marker": 2.0, "seconds": 1.0, "model": "motion-mlp"})
    took = [taken(tab.past, updates) for updates in tab.past.take_result(done["record"])][-1]
    assert took["state"].name == source.name, "not after what was after it"
    assert took["readouts"] == "" and not took["under"]["visible"], "those of the result that has left the stage"
    assert took["marker"]["value"] == 3.0 and took["state"].seconds == 3.0
    again = run(tab, {"source": took["state"], "marker": 3.0, "seconds": 1.0, "model": "motion-mlp"})
    (sample,) = again["player"]["value"]["samples"]
    assert (sample["past_until"], sample["frames"], sample["ghost"]) == (90, 120, None)
    assert [curve["label"] for curve in sample["curves"]] == ["Speed"]
    *_, update = tab.past.take_result(None)
    assert "There is no result yet" in update[tab.line] and tab.past.file not in update, "the file is still used"


@pytest.mark.parametrize(
    ("fields", "sentence"),
    [
        ({"source": None}, "There is no motion yet"),
        ({"marker": 0.2}, "1 s or more is needed"),
        ({"marker": None, "seconds": 99.0}, "Length must be from 0.5 to 4 seconds"),
    ],
)
def test_errors_are_one_sentence(tab: PredictTab, pair: Path, fields: dict[str, Any], sentence: str) -> None:
    source = loaded(tab, pair)["state"]
    asked = {"source": source, "marker": 2.0, "seconds": 1.0, "model": "motion-mlp"} | fields
    assert sentence in run(tab, asked)["line"]


def test_one_person_is_predicted_and_written(tab: PredictTab, tmp_path: Path) -> None:
    request = PredictRequest(motion=walking(4.0).a, marker=2.0, seconds=1.0)
    result = drift(request)
    assert prediction_payload(result)["samples"][0]["ghost"]["shape"] == [1, 90, 22, 3]
    files = write_files(result, tmp_path, prompt="after a walk")
    assert set(files) == {"npz", "smpl.npz", "bvh", "png", "json"}
    for kind in ("npz", "bvh"):
        assert np.allclose(read(files[kind][0]).positions, result.duets[0].positions, atol=2e-3)


def test_errors_are_described_in_words_beside_those_of_the_last_pose(monkeypatch: pytest.MonkeyPatch) -> None:
    result = drift(PredictRequest(motion=walking(4.0), marker=2.0, seconds=1.0))
    monkeypatch.setattr("webdemo.ui.components.prediction_view.still_error", lambda _: np.full(30, 60.0))
    (near,) = error_lines(replace(result, error=(30.0,) * 30))
    (far,) = error_lines(replace(result, error=(80.0,) * 29 + (170.0,)))
    assert near == (
        "Over 1.0 s the joints are 3.0 cm off on average, and 3.0 cm at the end. "
        "Holding the last pose would have been 6.0 cm off."
    )
    assert "8.3 cm off on average, and 17.0 cm at the end" in far
    assert "Holding the last pose would have been closer: 6.0 cm." in far
    (alone,) = error_lines(drift(PredictRequest(motion=walking(4.0), seconds=1.0)))
    assert "nothing to compare with" in alone


def test_methods_without_weights_are_not_offered(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("webdemo.inference.methods.WEIGHTS", tmp_path)
    assert [name for _, name in predict_choices()] == ["motion-mlp", "still"]
    for name in ("mawgan", "intergen"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "config.json").write_text("{}")
    assert [name for _, name in predict_choices()] == [found.name for found in methods("predict")]


def test_programs_get_the_files_and_the_curves(tab: PredictTab, pair: Path) -> None:
    endpoint = PredictEndpoint(tab.page)
    answer, files = endpoint.predict(str(pair), 2.0, seconds=1.0, model="motion-mlp")
    assert answer["prediction"]["past_frames"] == 60 and len(answer["prediction"]["error"]) == 30
    assert answer["manifest"]["request"]["kind"] == "predict"
    (motion,) = (read(file) for file in files if file.endswith(".npz") and ".smpl." not in file)
    assert motion.num_frames == 90
    for past, marker, sentence in ((str(pair), 0.3, "1 s or more is needed"), ("", 0, "There is no past")):
        with pytest.raises(gr.Error, match=sentence):
            endpoint.predict(past, marker, seconds=1.0, model="motion-mlp")
