"""Uploaded files beside the runs that were made from them: who gets them back, and what is too much."""

from __future__ import annotations

import json
import zipfile
from pathlib import Path
from typing import Any

import pytest

from motion import InputError
from tests.server.clients import taken_in
from tests.server.lab import stub_module
from webdemo.inference.requests import ReactRequest
from webdemo.server.store import originals
from webdemo.server.store.database import Run
from webdemo.server.store.notebook import Notebook
from webdemo.ui.history import Kept, Original, Search, clean_name

ME, OTHER = "user ada", "user eve"
BYTES = b"HIERARCHY \xff\x00 as it was"


def reaction(notebook: Notebook, original: Original | None, *, owner: str = ME) -> str:
    pair = stub_module().walking(2.0)
    request = ReactRequest(actor=pair.a, model="intergen", steps=1)
    run = notebook.begin(owner, request, "Reaction")
    *_, result = stub_module().StubEngine().run(request)
    notebook.finish(run, result)
    notebook.keep(run, owner, Kept(controls={"up": "z", "fps": 60}, people=(pair.a,), original=original))
    return run


@pytest.fixture
def upload(tmp_path: Path) -> Original:
    path = tmp_path / "upload.bvh"
    path.write_bytes(BYTES)
    return Original(path, "My walk (2).bvh")


def size_of(notebook: Notebook, run: str) -> int:
    with notebook.database.session() as session:
        return session.get_one(Run, run).size


def test_an_upload_comes_back_for_its_owner_alone_and_goes_with_its_run(
    notebook: Notebook, upload: Original
) -> None:
    run = reaction(notebook, upload)
    upload.path.unlink()  # uploads are soon cleaned away
    kept = notebook.open(run, ME).kept
    assert kept.original is not None and kept.controls == {"up": "z", "fps": 60}
    assert (kept.original.name, kept.original.path.read_bytes()) == ("My walk (2).bvh", BYTES)
    link, _ = notebook.link(run, ME)
    assert notebook.open(link, OTHER).kept.original is None
    folder = notebook.folder / run
    assert size_of(notebook, run) > sum(path.stat().st_size for path in folder.iterdir()) > len(BYTES)
    notebook.delete(run, ME)
    assert not folder.exists()


def test_what_is_too_large_gone_or_a_link_is_not_kept(
    notebook: Notebook, upload: Original, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    linked = tmp_path / "linked.bvh"
    linked.symlink_to(upload.path)
    for original in (Original(linked, "a.bvh"), Original(tmp_path / "gone.bvh", "a.bvh"), None):
        assert notebook.open(reaction(notebook, original), ME).kept.original is None
    with monkeypatch.context() as smaller:
        smaller.setattr(originals, "LARGEST_ORIGINAL", len(BYTES) - 1)
        run = reaction(notebook, upload)
    assert notebook.open(run, ME).kept.original is None
    assert {path.name for path in (notebook.folder / run).iterdir()} == {
        "1.npz", "given-1.npz", "readouts.json",
    }  # fmt: skip
    monkeypatch.setattr("webdemo.server.store.history.RUN_BYTES", 0)
    used = sum(size_of(notebook, entry.id) for entry in notebook.entries(ME))
    notebook.storage.person_bytes = 2 * used / 0.75
    assert notebook.open(reaction(notebook, upload), ME).kept.original is None, "half of the room is used"
    theirs = reaction(notebook, upload, owner=OTHER)
    assert notebook.open(theirs, OTHER).kept.original is not None, "that of others is not"


def test_an_upload_goes_along_in_a_workspace(notebook: Notebook, upload: Original, tmp_path: Path) -> None:
    reaction(notebook, upload)
    reaction(notebook, None)
    file = tmp_path / "workspace.zip"
    notebook.export(ME, [], file)
    assert taken_in(notebook, OTHER, file) == 2
    opened = [notebook.open(entry.id, OTHER) for entry in notebook.search(OTHER, Search()).entries]
    (kept,) = [each.kept for each in opened if each.kept.original is not None]
    assert kept.original is not None and kept.original.path.read_bytes() == BYTES
    assert kept.original.name == "My walk (2).bvh" and kept.controls == {"up": "z", "fps": 60}
    for each in opened:
        folder = notebook.folder / each.entry.id
        assert size_of(notebook, each.entry.id) > sum(path.stat().st_size for path in folder.iterdir())


@pytest.mark.parametrize(
    ("name", "kept"),
    [("../../../etc/cron.d/x.bvh", "x.bvh"), ("x.html", None), (["x.bvh"], None), ("", None), (None, None)],
)
def test_names_in_a_workspace_become_no_paths(
    notebook: Notebook, upload: Original, tmp_path: Path, name: Any, kept: str | None
) -> None:
    mine = reaction(notebook, upload)
    file, changed = tmp_path / "workspace.zip", tmp_path / "changed.zip"
    notebook.export(ME, [], file)
    with zipfile.ZipFile(file) as old, zipfile.ZipFile(changed, "w") as new:
        for each in old.namelist():
            content = old.read(each)
            if each == "workspace.json":
                listing = json.loads(content)
                listing["runs"][0]["kept"]["file"] = name
                content = json.dumps(listing).encode()
            new.writestr(each, content)
    taken_in(notebook, ME, changed)
    (entry,) = [entry for entry in notebook.search(ME, Search()).entries if entry.id != mine]
    original = notebook.open(entry.id, ME).kept.original
    assert (original.name if original else None) == kept
    if original is not None:
        assert original.path == notebook.folder / entry.id / "original"


def test_a_workspace_with_a_file_that_is_too_large_adds_nothing(
    notebook: Notebook, upload: Original, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    reaction(notebook, upload)
    file = tmp_path / "workspace.zip"
    notebook.export(ME, [], file)
    before = sorted(notebook.folder.iterdir())
    monkeypatch.setattr("webdemo.server.store.workspace.LARGEST_ORIGINAL", 3)
    with pytest.raises(InputError, match="0/original in the workspace is too large"):
        taken_in(notebook, ME, file)
    assert sorted(notebook.folder.iterdir()) == before


@pytest.mark.parametrize(
    ("name", "clean"),
    [
        ("walk.bvh", "walk.bvh"), ("a/b\\c.NPZ", "c.npz"), ("..bvh", "motion.bvh"), (".bvh", ""),
        ("a\0b\n;rm *.txt", "a-b--rm.txt"),
        ("Gehen äöü.bvh", "Gehen äöü.bvh"), ("x" * 300 + ".bvh", "x" * 100 + ".bvh"), ("page.html", ""),
        ("walk.bvh/", ""), ("???.bvh", "motion.bvh"), ("..  .npy", "motion.npy"),
    ],
)  # fmt: skip
def test_names_are_cleaned(name: str, clean: str) -> None:
    assert clean_name(name) == clean
