"""Room for each person: who pays for what is too much, and what an import may take."""

from __future__ import annotations

import random
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest
from sqlalchemy import select

from motion import InputError
from tests.server.lab import stub_module
from webdemo.server.accounts.quotas import Quota
from webdemo.server.store.database import Database, Run
from webdemo.server.store.notebook import Notebook
from webdemo.server.store.scratch import Scratch
from webdemo.server.store.storage import Storage
from webdemo.server.store.studies import Studies
from webdemo.study import Pair
from webdemo.ui.history import Search
from webdemo.ui.visitor import Visitor

from .runs import kept

PEOPLE = ("user ada", "user eve", "user bob")


@pytest.fixture
def notebook(tmp_path: Path) -> Iterator[Notebook]:
    database = Database(tmp_path / "h.db")
    scratch = Scratch(tmp_path / "s", 3e6)
    room = Quota("bytes", person=8e5, everybody=1.6e6)
    yield Notebook(Storage(database, tmp_path / "motions", room, scratch=scratch))
    database.close()


def runs_of(notebook: Notebook, owner: str) -> set[str]:
    with notebook.database.session() as session:
        return set(session.scalars(select(Run.id).where(Run.owner == owner)))


def test_nobody_s_deeds_remove_what_is_another_s(notebook: Notebook, tmp_path: Path) -> None:
    studies = Studies(notebook.storage, tmp_path / "studies")
    file = notebook.folder / kept(notebook, owner="user z", seconds=2.0) / "1.npz"
    walk = stub_module().walking(1.0)
    draw, evicted, refused = random.Random(1), 0, 0
    for number in range(200):
        owner = draw.choice(PEOPLE)
        who = Visitor(owner, owner)
        before = {each: runs_of(notebook, each) for each in (*PEOPLE, "user z")}
        starred = {e.id for e in notebook.search(owner, Search(starred=True)).entries}
        deed = draw.choice(["run"] * 4 + ["import", "favourite", "upload", "film", "study", "clean"])
        try:
            if deed == "run":
                kept(notebook, owner=owner, seconds=2.0, seed=number)
            elif deed == "import":
                notebook.take_in(owner, [file])
            elif deed == "favourite" and before[owner]:
                notebook.favour(draw.choice(sorted(before[owner])), owner, favourite=draw.random() < 0.5)
                continue
            elif deed in ("upload", "film"):
                notebook.storage.admit(who, draw.choice([1e3, 1e5]))
            elif deed == "study":
                studies.create(owner, "Which?", ("a", "b"), [Pair(walk, walk)])
            else:
                notebook.clean()
        except InputError:
            refused += 1
        now = {each: runs_of(notebook, each) for each in before}
        for other in set(before) - {owner}:
            assert now[other] == before[other], f"{deed} of {owner} removed a run of {other}"
            assert all((notebook.folder / run / "1.npz").exists() for run in now[other])
        assert starred <= now[owner], "a favourite was removed"
        usage = notebook.usage(who)
        assert usage.used - usage.temporary <= usage.kept + 20_000  # unfinished runs' own rows
        evicted += len(before[owner] - now[owner])
    assert evicted > 10 and refused > 0, "the limits were never reached"


def test_the_total_is_reached_and_one_s_own_runs_make_way_or_the_run_is_refused(notebook: Notebook) -> None:
    notebook.storage.room = Quota("bytes", person=1e9)
    theirs = {kept(notebook, owner="user ada", seconds=2.0, seed=seed) for seed in range(40)}
    used = notebook.usage(Visitor("user ada", "user ada")).used
    notebook.storage.room = Quota("bytes", person=1e9, everybody=used + 3e5)
    with pytest.raises(InputError, match="others' runs are not removed for yours"):
        for seed in range(40):
            notebook.favour(kept(notebook, owner="user eve", seconds=2.0, seed=seed), "user eve", favourite=True)
    assert runs_of(notebook, "user ada") == theirs


def test_an_import_that_does_not_fit_is_refused_and_removes_nothing(notebook: Notebook, tmp_path: Path) -> None:
    mine = {kept(notebook, owner="user ada", seconds=2.0, seed=seed) for seed in range(5)}
    file = shutil.copy(notebook.folder / min(mine) / "1.npz", tmp_path)
    used = notebook.usage(Visitor("user ada", "user ada")).used
    notebook.storage.room = Quota("bytes", person=used / 0.75 + 1000)
    with pytest.raises(InputError, match="your room is used up"):
        notebook.take_in("user ada", [Path(file)])
    assert runs_of(notebook, "user ada") == mine
    assert {path.name for path in notebook.folder.iterdir()} == mine
