"""Grids: what is swept, how it is laid out, what comes of it, and what is refused."""

from __future__ import annotations

import csv
import html
from dataclasses import replace
from pathlib import Path
from typing import Any

import gradio as gr
import pytest
from PIL import Image

from motion import InputError
from motion.formats import write
from tests.ui.stub_engine import walking
from tests.ui.tab_events import built, changes
from webdemo.inference.requests import GenerateRequest
from webdemo.inference.run import Result
from webdemo.ui.components.exports import Record, write_record
from webdemo.ui.components.film import make_film
from webdemo.ui.components.sweep import grid_of, grid_table, read_axis
from webdemo.ui.history import Entry, Kept, Opened
from webdemo.ui.tabs.generate import GenerateTab
from webdemo.ui.tabs.grids import BASIC
from webdemo.ui.tabs.predict import PredictTab
from webdemo.ui.tabs.react import ReactTab
from webdemo.ui.tabs.scene import SceneTab

SEED, GUIDANCE, _, DAMPING = BASIC
FIELDS = {
    "model": "intergen",
    "prompt": "They shake hands.",
    "class_name": None,
    "seconds": 1.0,
    "seed": 3,
    "samples": 2,
    "guidance": 4.3,
    "steps": 2,
    "damping": 0.7,
}


@pytest.fixture
def tab(tmp_path: Path) -> GenerateTab:
    return built(GenerateTab, tmp_path)


def run(tab: Any, *swept: str, **changed: Any) -> list[dict[str, Any]]:
    fields = {**FIELDS, **changed, "grid": list(swept)}
    return [changes(tab.outputs, updates) for updates in tab.run("me", fields)]


@pytest.mark.parametrize(
    ("kind", "given", "values"),
    [
        (SEED, "1, 2;3", (1, 2, 3)),
        (SEED, "4-6", (4, 5, 6)),
        (SEED, "7 to 8", (7, 8)),
        (DAMPING, "0, 0.7", (0.0, 0.7)),
        (GUIDANCE, "1 2.5", (1.0, 2.5)),
    ],
)
def test_values_are_read_as_people_write_them(kind: Any, given: str, values: tuple[Any, ...]) -> None:
    assert read_axis(kind, given).values == values


@pytest.mark.parametrize(
    ("kind", "given", "sentence"),
    [
        (SEED, "1-500", "A grid has 1 to 9 cells, not 500"),
        (SEED, " ", "no values"),
        (SEED, "1.5", "is not a whole number"),
        (DAMPING, "a lot", "is not a number"),
        (SEED, "1-" + "9" * 400, "is not a whole number"),
    ],
)
def test_what_makes_no_grid_is_a_sentence(kind: Any, given: str, sentence: str) -> None:
    with pytest.raises(InputError, match=sentence):
        read_axis(kind, given)


def test_two_axes_are_columns_and_rows_and_one_axis_wraps() -> None:
    seeds, damping = read_axis(SEED, "1-3"), read_axis(DAMPING, "0 0.7")
    grid = grid_of([seeds, damping])
    assert grid.columns == ["seed 1", "seed 2", "seed 3"] and grid.rows == ["damping 0", "damping 0.7"]
    assert grid.cells[4] == {"seed": 2, "damping": 0.7} and grid.names[4] == "damping 0.7 · seed 2"
    alone = grid_of([read_axis(SEED, "1-4")])
    assert (len(alone.columns), len(alone.rows), alone.names[3]) == (2, 2, "seed 4")
    for axes, sentence in (
        ([], "Choose what"),
        ([seeds, seeds], "same setting"),
        ([read_axis(SEED, "1-4"), read_axis(GUIDANCE, "1 2 3")], "not 12"),
    ):
        with pytest.raises(InputError, match=sentence):
            grid_of(axes)


def test_a_grid_is_made_shown_measured_and_written(
    tab: GenerateTab, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("webdemo.ui.components.film.film.SIZE", (160, 90))
    steps = run(tab, "seed", "1-2", "damping", "0, 0.7")
    asked = [(r.seed, r.damping, r.samples) for r in tab.page.engine.requests]
    assert asked == [(1, 0.0, 1), (2, 0.0, 1), (1, 0.7, 1), (2, 0.7, 1)]
    assert any("2 of 4, damping 0 · seed 2. " in step.get("line", "") for step in steps)
    last = steps[-1]
    (sample,) = last["player"]["value"]["samples"]
    assert sample["cells"][0]["caption"] == "damping 0 · seed 1"
    assert (sample["columns"], sample["rows"]) == (["seed 1", "seed 2"], ["damping 0", "damping 0.7"])
    assert "4 results done" in last["line"]
    assert last["reading"] == gr.update(checked={}), "the marks of an earlier result are none of these"
    record = last["record"]
    files = write_record(record, tmp_path)
    rows = list(csv.DictReader(files["csv"][0].open(encoding="utf-8")))
    assert [row["result"] for row in rows] == list(record.compared)
    assert float(rows[0]["foot_skate"]) >= 0 and rows[3]["seed"] == "2"
    assert len(files["npz"]) == 4
    (sheet,) = files["png"]
    assert Image.open(sheet).height > 4 * 200, "all four rows are on one sheet"
    film = make_film(record, '{"theme": "dark"}', tmp_path)
    assert film.stat().st_size > 1000
    for swept, sentence in ((("seed", "1-500", "", ""), "not 500"), (("", "", "", ""), "Choose what the grid")):
        assert sentence in run(tab, *swept)[-1]["line"]
    seen = len(tab.page.engine.requests)
    assert "Damping threshold must be" in run(tab, "damping", "0, 7", "", "")[-1]["line"]
    assert len(tab.page.engine.requests) == seen, "nothing runs where one cell cannot"


def test_predictions_by_several_methods_make_a_grid_with_their_pasts(tmp_path: Path) -> None:
    tab = built(PredictTab, tmp_path / "files")
    *_, loaded = tab.past.upload(str(write(walking(4.0), tmp_path / "walkers.npz")[0]))
    field, values = tab.presets()["Method beside method"]
    fields = {"source": loaded[tab.past.state], "marker": 2.0, "seconds": 1.0, "model": "motion-mlp"}
    last = [
        changes(tab.outputs, each) for each in tab.run("me", {**fields, "grid": [field, values, "marker", "1.5 2"]})
    ][-1]
    (sample,) = last["player"]["value"]["samples"]
    assert [cell["past_until"] for cell in sample["cells"]] == [45] * 3 + [60] * 3
    assert all(cell["ghost"] for cell in sample["cells"])
    assert "<b>from 1.5 s · " in last["readouts"]
    assert last["readouts"].count("cm off on average") == 6
    record: Record = last["record"]
    entry = Entry(id="x", kind="predict", title="t", state="done", request=record.result.manifest["request"])
    opened = [Opened(entry=entry, result=each) for each in record.compared.values()]
    kept = Kept(controls={"grid": dict(record.grid)})
    again = tab.opened(replace(opened[0], kept=kept, beside=tuple(opened[1:])))
    assert len(again[tab.results.player]["value"]["samples"][0]["cells"]) == 6


def test_a_story_under_several_settings_makes_a_grid(tmp_path: Path) -> None:
    tab = built(SceneTab, tmp_path)
    story = {"prompt": "Two people bow. Then they hug.", "story": None, "seed": 1, "samples": 3, "guidance": 3.0}
    fields = {**story, "steps": 2, "damping": 0.7, "grid": ["damping", "0, 0.7", "seed", "1 2"]}
    last = [changes(tab.outputs, each) for each in tab.run("me", fields)][-1]
    asked = tab.page.engine.requests  # type: ignore[attr-defined]
    assert [(r.damping, r.seed, r.samples, len(r.beats)) for r in asked] == [
        (0.0, 1, 1, 2),
        (0.7, 1, 1, 2),
        (0.0, 2, 1, 2),
        (0.7, 2, 1, 2),
    ]
    assert len(last["player"]["value"]["samples"][0]["cells"]) == 4
    assert last["reading"] == gr.update(checked={})
    assert last["spans"]["visible"] is False, "of several motions none is made again in part"
    assert [beat["words"] for beat in last["story"]["value"]["beats"]] == [b.words for b in asked[0].beats]


def test_what_cannot_be_measured_is_a_dash_among_the_others() -> None:
    def result(hands: float | None) -> Result:
        after = {"foot_skate": 1.0, "hands_min": hands}
        return Result(duets=(), manifest={}, readouts=({"after": after},))

    made = grid_table({"plain": result(None), "damped": result(0.2)})
    assert '<td class=""><b>–</b></td>' in made and "<b>0.20</b>" in made
    assert "Hands, closest" not in grid_table({"plain": result(None), "damped": result(None)})


def test_a_sentence_stands_beside_its_class_and_a_method_beside_a_method(tab: GenerateTab, tmp_path: Path) -> None:
    field, values = tab.presets()["Sentence beside class"]
    run(tab, field, values, "", "", prompt="Two people shake hands.")
    first, second = tab.page.engine.requests
    assert (first.model, second.model, second.prompt) == ("intergen", "bigraphdiff", "shake hands")
    assert first.guidance == GenerateRequest(prompt="x").guidance and second.guidance < 4
    said = html.unescape(run(tab, field, values, "", "", prompt="They juggle.")[-1]["line"])
    assert "names none of BiGraphDiff's classes" in said and "No class is chosen" not in said
    run(tab, field, values, "", "", model="bigraphdiff", prompt="", class_name="hug")
    sentence, name = tab.page.engine.requests[-2:]
    assert (sentence.prompt, name.prompt) == ("Two people hug.", "hug")
    assert "There is no method" in run(tab, "model", "intergen; mine", "", "")[-1]["line"]
    react = built(ReactTab, tmp_path / "react")
    assert set(react.presets()["Method beside method"][1].split("; ")) >= {"ReGenNet, online", "Virtual agent"}
    assert react.cell_fields({**FIELDS, "method": "intergen"}, {"method": "regennet"})["steps"] == 5


def test_a_kept_grid_opens_with_its_columns_or_with_what_is_left(tab: GenerateTab) -> None:
    last = run(tab, "seed", "1-4", "", "")[-1]
    record: Record = last["record"]
    results = list(record.compared.values())
    entry = Entry(id="x", kind="generate", title="t", state="done", request=results[0].manifest["request"])
    opened = [Opened(entry=entry, result=result) for result in results]
    kept = Kept(controls={"grid": dict(record.grid), "seed": 3})
    for beside, cells in ((opened[1:], 4), (opened[2:], 3)):
        run_ = Opened(entry=entry, result=results[0], kept=kept, beside=tuple(beside))
        (sample,) = tab.opened(run_)[tab.results.player]["value"]["samples"]
        assert len(sample["cells"]) == cells == len(sample["columns"]) * len(sample["rows"])
