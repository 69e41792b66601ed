"""Uploaded files beside the runs that were made from them: who gets them back, and what is too much."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.server.lab import stub_module
from webdemo.inference.requests import ReactRequest
from webdemo.server.accounts.quotas import Rooms
from webdemo.server.store import notebook as module
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


def test_an_upload_comes_back_for_its_owner_alone_and_goes_with_its_run(notebook: Notebook, upload: Original) -> None:
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
        smaller.setattr(module, "LARGEST_ORIGINAL", len(BYTES) - 1)
        run = reaction(notebook, upload)
    assert notebook.open(run, ME).kept.original is None
    assert {path.name for path in (notebook.folder / run).iterdir()} == {"1.npz", "given-1.npz", "readouts.json"}
    monkeypatch.setattr("webdemo.server.store.history.RUN_BYTES", 0)
    used = sum(size_of(notebook, entry.id) for entry in notebook.search(ME, Search()).entries)
    notebook.storage.rooms = Rooms(person=2 * used / 0.75)
    assert notebook.open(reaction(notebook, upload), ME).kept.original is None, "half of the room is used"
    theirs = reaction(notebook, upload, owner=OTHER)
    assert notebook.open(theirs, OTHER).kept.original is not None, "that of others is not"


@pytest.mark.parametrize(
    ("name", "clean"),
    [
        ("walk.bvh", "walk.bvh"),
        ("a/b\\c.NPZ", "c.npz"),
        (".bvh", ""),
        ("a\0b\n;rm *.txt", "a-b--rm.txt"),
        ("page.html", ""),
    ],
)
def test_names_are_cleaned(name: str, clean: str) -> None:
    assert clean_name(name) == clean
