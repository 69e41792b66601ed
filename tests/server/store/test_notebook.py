"""The history as a notebook: what is found, written, brought back and taken along, and by whom."""

from __future__ import annotations

import time
import zipfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from motion import InputError, formats
from tests.server.lab import stub_module
from webdemo.inference.requests import GenerateRequest, ReactRequest
from webdemo.server.store import history as history_module
from webdemo.server.store.notebook import Notebook
from webdemo.ui.history import Kept, Search

from .runs import ME, OTHER, kept, made


def found(notebook: Notebook, owner: str = ME, **wanted: Any) -> list[str]:
    return [entry.title for entry in notebook.search(owner, Search(**wanted)).entries]


def test_runs_are_found_by_words_method_tag_star_and_date(notebook: Notebook) -> None:
    hug = kept(notebook, "Two people hug 100% of the time.")
    kept(notebook, "high five", model="bigraphdiff")
    kept(notebook, "Not mine.", owner=OTHER)
    notebook.describe(hug, ME, title="  Best   hug ", tags="paper, #figure-3 paper", note="The hands.")
    notebook.favour(hug, ME, favourite=True)
    entry = notebook.entry(hug, ME)
    assert (entry.title, entry.tags, entry.note) == ("Best hug", ("paper", "figure-3"), "The hands.")
    assert len(entry.thumbnail) > 1000, "a thumbnail was drawn"
    everything = notebook.search(ME, Search())
    assert (everything.total, list(everything.tags)) == (2, ["figure-3", "paper"])
    assert list(everything.models) == ["bigraphdiff", "intergen"]
    for wanted in (
        {"words": "HUG best"},
        {"words": "hands"},
        {"words": "100%"},
        {"model": "intergen"},
        {"tag": "paper"},
        {"starred": True},
    ):
        assert found(notebook, **wanted) == ["Best hug"], wanted
    for nothing in ({"words": "_"}, {"tag": "pap"}, {"words": "%%"}, {"kind": "react"}):
        assert found(notebook, **nothing) == [], nothing
    assert found(notebook, limit=1) == ["high five"]
    with pytest.raises(InputError, match="The name has 201 characters"):
        notebook.describe(hug, ME, title="x" * 201)


def test_hundreds_of_runs_are_found_at_once(notebook: Notebook) -> None:
    request = GenerateRequest(prompt="Two people walk.", seconds=1.0, steps=1)
    runs = [notebook.begin(ME, request.to_dict(), f"Walk {i}") for i in range(400)]
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
    run = notebook.begin(ME, request.to_dict(), "Reaction")
    notebook.finish(run, made(request))
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


def taken_out(notebook: Notebook, folder: Path) -> list[Path]:
    """The files of an export of everything."""
    assert notebook.export(ME, [], folder / "all.zip")
    with zipfile.ZipFile(folder / "all.zip") as archive:
        archive.extractall(folder / "files")
    return sorted((folder / "files").iterdir())


def test_results_go_out_in_one_file_and_come_in_from_theirs(notebook: Notebook, tmp_path: Path) -> None:
    run = kept(notebook, "Two: people/walk", seed=9, samples=2)
    files = taken_out(notebook, tmp_path)
    assert [file.name for file in files] == ["001-Two-people-walk-1.npz", "001-Two-people-walk-2.npz"]
    with pytest.raises(InputError, match="None of these runs"):
        notebook.export(OTHER, [run], tmp_path / "theirs.zip")
    assert notebook.take_in(OTHER, files) == 2 and len(found(notebook)) == 1
    theirs = notebook.search(OTHER, Search()).entries
    assert [entry.title for entry in theirs] == ["Two: people/walk"] * 2
    mine = notebook.open(run, ME).result
    copies = sorted((notebook.open(entry.id, OTHER).result for entry in theirs), key=lambda r: r.manifest["sample"])
    for one, copy in zip(mine.duets, copies, strict=True):
        np.testing.assert_array_equal(one.positions, copy.duets[0].positions)
        assert copy.manifest["request"]["seed"] == 9
        assert copy.readouts[0]["after"].keys() >= {"foot_skate"}


def _claiming(manifest: object) -> Callable[[Path], None]:
    walk = stub_module().walking(1.0)
    return lambda path: formats.write(replace(walk, manifest=manifest), path) and None


HOSTILE: dict[str, Callable[[Path], Any]] = {
    "nothing": lambda path: path.write_bytes(b""),
    "no zip": lambda path: path.write_bytes(b"PK\x03\x04 nothing"),
    "pickled code": lambda path: np.savez(path, positions=np.array([{"a": 1}], dtype=object)),
    "no manifest": _claiming({}),
    "no request": _claiming({"request": [1]}),
    "an unknown kind": _claiming({"request": {"kind": "../../x"}}),
    "a kind that is none": _claiming({"request": {"kind": ["scene"]}}),
    "a scene without a story": _claiming({"request": {"kind": "scene", "beats": 3}}),
    "a request by which a search takes a gigabyte": _claiming({"request": {"kind": "generate", "x": [0.5] * 700_000}}),
    "millions of numbers": _claiming({"request": {"kind": "generate", "x": [0] * 2_000_000}}),
}


def test_a_file_made_by_hand_is_one_sentence_and_adds_nothing(notebook: Notebook, tmp_path: Path) -> None:
    kept(notebook)
    (good,) = taken_out(notebook, tmp_path)
    before = sorted(path.name for path in notebook.folder.iterdir())
    for name, make in HOSTILE.items():
        bad = tmp_path / "bad.npz"
        make(bad)
        with pytest.raises(InputError) as error:
            notebook.take_in(ME, [bad, good])
        assert str(error.value).count("\n") == 0 and str(tmp_path) not in str(error.value), name
        assert len(found(notebook)) == 1, name
        assert sorted(path.name for path in notebook.folder.iterdir()) == before, name
    with pytest.raises(InputError, match="too many at once"):
        notebook.take_in(ME, [good] * 101)


def test_what_a_file_claims_is_not_believed(notebook: Notebook, tmp_path: Path) -> None:
    mine = kept(notebook)
    claims = {"kind": "generate", "prompt": "<b>" * 1000, "owner": OTHER, "favourite": True, "id": mine}
    bad = tmp_path / "bad.npz"
    _claiming({"request": claims, "state": "running", "owner": OTHER})(bad)
    assert notebook.take_in(ME, [bad]) == 1
    (new,) = [entry for entry in notebook.search(ME, Search()).entries if entry.id != mine]
    assert not new.favourite and new.state == "done" and len(new.title) == 500
    assert notebook.search(OTHER, Search()).total == 0 and notebook.open(new.id, ME).result.duets
