"""The history as a notebook: what is found, written, brought back and taken along, and by whom."""

from __future__ import annotations

import io
import json
import time
import zipfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from motion import InputError
from tests.server.clients import taken_in
from tests.server.lab import stub_module
from webdemo.inference.plans import KeptPlan, WindowPlan
from webdemo.inference.requests import GenerateRequest, ReactRequest
from webdemo.server.store import history as history_module
from webdemo.server.store.notebook import Notebook
from webdemo.ui.history import Kept, Search

ME, OTHER = "user ada", "user eve"
PLAN = KeptPlan(windows=(WindowPlan((1.0, 2.0, 0.5)),))


def kept(notebook: Notebook, prompt: str = "Two people walk.", *, owner: str = ME, **fields: Any) -> str:
    request = GenerateRequest(prompt=prompt, **({"seconds": 1.0, "steps": 1} | fields))
    run = notebook.begin(owner, request, prompt)
    *_, result = stub_module().StubEngine().run(request)
    notebook.finish(run, replace(result, manifest={**result.manifest, "plan": PLAN.to_dict()}))
    return run


def found(notebook: Notebook, owner: str = ME, **wanted: Any) -> list[str]:
    return [entry.title for entry in notebook.search(owner, Search(**wanted)).entries]


def test_runs_are_found_by_words_method_tag_star_and_date(notebook: Notebook) -> None:
    hug = kept(notebook, "Two people hug 100% of the time.")
    kept(notebook, "high five", model="bigraphdiff")
    kept(notebook, "Not mine.", owner=OTHER)
    notebook.describe(
        hug, ME, title="  Best   hug ", tags="paper, #figure-3 paper", note="The hands.", frame=12
    )
    notebook.favour(hug, ME, favourite=True)
    entry = notebook.entry(hug, ME)
    assert (entry.title, entry.tags, entry.note, entry.frame) == (
        "Best hug",
        ("paper", "figure-3"),
        "The hands.",
        12,
    )
    assert len(entry.thumbnail) > 1000, "a thumbnail was drawn"
    everything = notebook.search(ME, Search())
    assert (everything.total, list(everything.tags)) == (2, ["figure-3", "paper"])
    assert list(everything.models) == ["bigraphdiff", "intergen"]
    for wanted in (
        {"words": "HUG best"}, {"words": "hands"}, {"words": "100%"}, {"model": "intergen"}, {"tag": "paper"},
        {"starred": True},
    ):  # fmt: skip
        assert found(notebook, **wanted) == ["Best hug"], wanted
    now = time.time()
    assert len(found(notebook, since=now - 60, until=now + 60)) == 2
    for nothing in ({"words": "_"}, {"tag": "pap"}, {"until": now - 60}, {"words": "%%"}, {"kind": "react"}):
        assert found(notebook, **nothing) == [], nothing
    assert found(notebook, limit=1) == ["high five"] and found(notebook, limit=1, offset=1) == ["Best hug"]
    with pytest.raises(InputError, match="The name has 201 characters"):
        notebook.describe(hug, ME, title="x" * 201)


def test_hundreds_of_runs_are_found_at_once(notebook: Notebook) -> None:
    request = GenerateRequest(prompt="Two people walk.", seconds=1.0, steps=1)
    runs = [notebook.begin(ME, request, f"Walk {i}") for i in range(400)]
    for run in runs[::2]:
        notebook.describe(run, ME, tags="even")
    began = time.process_time()
    page = notebook.search(ME, Search(words="walk", tag="even"))
    assert (page.total, len(page.entries)) == (200, 60)
    assert time.process_time() - began < 0.5


def test_a_removed_run_opens_for_nobody_and_can_be_brought_back(
    notebook: Notebook, monkeypatch: pytest.MonkeyPatch
) -> None:
    first, second = kept(notebook, "one"), kept(notebook, "two")
    link, _ = notebook.link(first, ME)
    assert notebook.remove([first, second], ME) == 2
    assert found(notebook) == []
    for key, who in ((first, ME), (link, OTHER)):
        with pytest.raises(InputError, match="There is no such run"):
            notebook.open(key, who)
    assert notebook.restore([first, second], OTHER) == 0, "it is somebody else's"
    assert notebook.restore([first], ME) == 1
    assert notebook.open(link, OTHER).entry.title == "one"
    with pytest.raises(InputError, match="no such run in your history"):
        notebook.remove([first], OTHER)
    monkeypatch.setattr(history_module, "UNDO_SECONDS", -1.0)
    assert notebook.clean() == 1
    assert notebook.restore([second], ME) == 0 and not (notebook.folder / second).exists()


def test_how_a_tab_was_set_comes_back_for_its_owner_alone(notebook: Notebook) -> None:
    pair = stub_module().walking(2.0)
    request = ReactRequest(actor=pair.a, model="intergen", steps=1)
    run = notebook.begin(ME, request, "Reaction")
    *_, result = stub_module().StubEngine().run(request)
    notebook.finish(run, result)
    other = kept(notebook)
    notebook.keep(run, ME, Kept(controls={"person": "b", "end": 1.5}, people=pair.people, compared=(other,)))
    opened = notebook.open(run, ME)
    assert opened.kept.controls == {"person": "b", "end": 1.5}
    np.testing.assert_array_equal(opened.kept.people[1].positions, pair.b.positions)
    assert [each.entry.id for each in opened.beside] == [other]
    assert found(notebook) == ["Reaction"], "what it was compared with has no card of its own"
    link, _ = notebook.link(run, ME)
    shared = notebook.open(link, OTHER)
    assert shared.kept.people == (), "a link shows the motion, not the file that it began with"
    assert [each.entry.id for each in shared.beside] == [other]
    with pytest.raises(InputError, match="no such run"):
        notebook.keep(run, OTHER, Kept())
    notebook.favour(run, ME, favourite=True)
    assert notebook.entry(other, ME).favourite, "it is kept with the run that it is a part of"
    notebook.remove([run], ME)
    with pytest.raises(InputError, match="There is no such run"):
        notebook.open(other, ME)
    notebook.restore([run], ME)
    notebook.remove([other], ME)
    assert notebook.open(run, ME).beside == ()


def test_a_workspace_goes_out_and_comes_in_beside_what_is_there(notebook: Notebook, tmp_path: Path) -> None:
    run = kept(notebook, seed=9, samples=2)
    notebook.describe(run, ME, title="Kept", tags="a b", note="Look.", frame=3)
    file = tmp_path / "workspace.zip"
    assert notebook.export(ME, [], file) == 1
    with pytest.raises(InputError, match="None of these runs"):
        notebook.export(OTHER, [run], tmp_path / "theirs.zip")
    assert taken_in(notebook, OTHER, file) == 1 and taken_in(notebook, ME, file) == 1
    (theirs,) = notebook.search(OTHER, Search()).entries
    assert (theirs.title, theirs.tags, theirs.note, theirs.frame) == ("Kept", ("a", "b"), "Look.", 3)
    assert theirs.id != run and len(found(notebook)) == 2, "nothing was overwritten"
    mine, copy = notebook.open(run, ME), notebook.open(theirs.id, OTHER)
    for a, b in zip(mine.result.duets, copy.result.duets, strict=True):
        np.testing.assert_array_equal(a.positions, b.positions)
    assert copy.result.manifest["request"]["seed"] == 9 and copy.result.manifest["plan"] == PLAN.to_dict()
    assert copy.result.readouts[0]["after"].keys() >= {"foot_skate"}


def _changed(file: Path, change: Callable[[dict[str, Any], dict[str, bytes]], None]) -> bytes:
    """A workspace with its list of runs and its files changed by hand."""
    with zipfile.ZipFile(file) as archive:
        files = {name: archive.read(name) for name in archive.namelist()}
    listing = json.loads(files.pop("workspace.json"))
    change(listing, files)
    made = io.BytesIO()
    with zipfile.ZipFile(made, "w") as archive:
        for name, content in files.items():
            archive.writestr(name, content)
        archive.writestr("workspace.json", json.dumps(listing))
    return made.getvalue()


GRID = {"columns": ["seed 1", "seed 2"], "rows": [""], "names": ["seed 1", "seed 2"], "title": "Two seeds"}


def test_a_grid_and_its_cells_go_out_and_come_in_together(notebook: Notebook, tmp_path: Path) -> None:
    first, second = kept(notebook, "one", seed=1), kept(notebook, "one", seed=2)
    people = stub_module().walking(1.0).people
    notebook.keep(first, ME, Kept(controls={"seed": 1, "grid": GRID}, people=people, compared=(second,)))
    file = tmp_path / "workspace.zip"
    assert notebook.export(ME, [first], file) == 2, "its cell goes with it"
    assert taken_in(notebook, OTHER, file) == 2
    (card,) = notebook.search(OTHER, Search()).entries
    opened = notebook.open(card.id, OTHER)
    assert opened.kept.controls == {"seed": 1, "grid": GRID} and len(opened.kept.people) == 2
    assert [each.entry.request["seed"] for each in opened.beside] == [2]
    notebook.remove([second], ME)
    alone = tmp_path / "alone.zip"
    assert notebook.export(ME, [first], alone) == 1 and taken_in(notebook, OTHER, alone) == 1
    newest = notebook.search(OTHER, Search()).entries
    assert "grid" not in notebook.open(next(e.id for e in newest if e.id != card.id), OTHER).kept.controls


def _controls(**controls: Any) -> Callable[[dict[str, Any], dict[str, bytes]], None]:
    return lambda listing, files: listing["runs"][0].update(kept={"controls": controls, "compared": []})


HOSTILE: dict[str, Callable[[dict[str, Any], dict[str, bytes]], Any]] = {
    "no motion": lambda listing, files: files.clear(),
    "a motion that is none": lambda listing, files: files.update({"0/1.npz": b"PK\x03\x04 nothing"}),
    "pickled code": lambda listing, files: files.update({"0/1.npz": _pickled()}),
    "another format": lambda listing, files: listing.update(format="mine"),
    "runs that are no list": lambda listing, files: listing.update(runs={"0": {}}),
    "a run that is none": lambda listing, files: listing.update(runs=[[]]),
    "an unknown kind": lambda listing, files: listing["runs"][0].update(kind="../../x"),
    "too many runs": lambda listing, files: listing.update(runs=[{}] * 1001),
    "a grid without names": _controls(grid={"columns": 3}),
    "a grid of 500 cells": _controls(
        grid={"columns": ["x"] * 500, "rows": [""], "names": list(map(str, range(500)))}
    ),
    "a grid with equal names": _controls(grid={"columns": ["x"] * 2, "rows": [""], "names": ["x", "x"]}),
    "a part that is not there": lambda listing, files: listing["runs"][0].update(kept={"compared": [7]}),
    "a part of itself": lambda listing, files: listing["runs"][0].update(kept={"compared": [0]}),
    "parts that are no numbers": lambda listing, files: listing["runs"][0].update(
        kept={"compared": ["0", None]}
    ),
    "too many parts": lambda listing, files: listing["runs"][0].update(kept={"compared": [0] * 500}),
    "a plan that is none": lambda listing, files: listing["runs"][0]["outcome"]["manifest"].update(
        plan={"beats": [], "alone": ["", ""], "notes": [], "windows": [{"place": ["x"]}]}
    ),
    "a prediction from nowhere": lambda listing, files: listing["runs"][0]["outcome"].update(
        prediction={"past_frames": 10**9}
    ),
}


def _pickled() -> bytes:
    made = io.BytesIO()
    np.savez(made, positions=np.array([{"a": 1}], dtype=object))
    return made.getvalue()


def test_a_workspace_made_by_hand_is_one_sentence_and_adds_nothing(
    notebook: Notebook, tmp_path: Path
) -> None:
    kept(notebook)
    file, bad = tmp_path / "workspace.zip", tmp_path / "bad.zip"
    notebook.export(ME, [], file)
    before = sorted(path.name for path in notebook.folder.iterdir())
    contents = {name: _changed(file, change) for name, change in HOSTILE.items()}
    contents["no zip"] = b"nothing at all"
    contents["cut off"] = file.read_bytes()[:-400]
    for name, content in contents.items():
        bad.write_bytes(content)
        with pytest.raises(InputError) as error:
            taken_in(notebook, ME, bad)
        assert str(error.value).count("\n") == 0 and str(tmp_path) not in str(error.value), name
        assert len(found(notebook)) == 1, name
        assert sorted(path.name for path in notebook.folder.iterdir()) == before, name


def test_what_a_workspace_claims_is_not_believed(notebook: Notebook, tmp_path: Path) -> None:
    mine = kept(notebook)
    file = tmp_path / "workspace.zip"
    notebook.export(ME, [], file)

    def claim(listing: dict[str, Any], files: dict[str, bytes]) -> None:
        files["../../../evil.npz"] = files["/etc/evil"] = b"x"
        listing["runs"][0] |= {
            "id": mine, "owner": OTHER, "state": "running", "favourite": True, "created": 1e18, "size": -5,
            "title": "<script>", "readouts": [{"after": {"foot_skate": "<b>", "jerk": 1e999}, "curves": [1]}],
        }  # fmt: skip
        listing["runs"][0]["kept"] = {
            "controls": {"seed": "<b>", "person": ["a"], "steps": 7, "note": "x"},
            "compared": None,
        }
        listing["runs"][0]["request"] |= {"prompt": ["no", "text"], "actor": [1], "seed": {"deep": {"er": 1}}}

    file.write_bytes(_changed(file, claim))
    assert taken_in(notebook, ME, file) == 1
    new = next(entry for entry in notebook.search(ME, Search()).entries if entry.id != mine)
    assert not new.favourite and new.state == "done" and new.created <= time.time()
    assert "actor" not in new.request and "prompt" not in new.request and new.request["seed"] == {}
    opened = notebook.open(new.id, ME)
    assert opened.result.readouts[0]["after"] == {}
    assert opened.kept.controls == {"steps": 7}
    assert notebook.search(OTHER, Search()).total == 0
    assert replace(opened.entry, id="") != replace(notebook.entry(mine, ME), id="")
    assert not list(tmp_path.rglob("evil*"))
