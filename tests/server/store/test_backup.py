"""Backups: made while people work, and whole in an empty place."""

from __future__ import annotations

import shutil
import sqlite3
import threading
import time
from contextlib import closing
from pathlib import Path

import httpx
import pytest

from motion import InputError
from tests.server.attacks.target import Target
from tests.server.clients import FIELDS
from webdemo.cli import main
from webdemo.server.settings import Settings
from webdemo.server.store.backup import back_up, backups
from webdemo.server.store.database import Database, Study
from webdemo.server.store.notebook import Notebook
from webdemo.server.store.storage import Storage
from webdemo.ui.history import Search


def lab_at(folder: Path) -> Settings:
    return Settings(data=folder / "data")


def test_a_restore_drill(tmp_path: Path) -> None:
    """Every run of every backup made while people worked opens in an empty place, and the next run is kept."""
    (tmp_path / "lab").mkdir()
    with Target(tmp_path / "lab", accounts=True) as lab:
        for _ in range(3):
            assert "event: complete" in lab.call("ada", "generate", ["First.", *FIELDS[1:]])
        stop = threading.Event()

        def work() -> None:
            client = httpx.Client(base_url=lab.url, timeout=30)
            client.post("/login", data={"username": "eve", "password": "password of eve"})
            while not stop.is_set():
                asked = client.post("/gradio_api/call/generate", json={"data": FIELDS}).json()
                client.get(f"/gradio_api/call/generate/{asked['event_id']}")

        thread = threading.Thread(target=work)
        thread.start()
        for _ in range(2):
            back_up(lab_at(tmp_path / "lab"), tmp_path / "backups", keep=1)
            time.sleep(1.1)
        stop.set()
        thread.join()
    assert len(backups(tmp_path / "backups")) == 1
    for made in backups(tmp_path / "backups"):
        folder = tmp_path / made.name
        shutil.copytree(made, folder / "data")
        assert made.stat().st_mode & 0o077 == 0
        database = Database(lab_at(folder).database)
        history = Notebook(Storage(database, folder / "data" / "motions"))
        assert history.search("user ada", Search()).total == 3
        for owner in ("user ada", "user eve"):
            for entry in history.search(owner, Search(limit=500)).entries:
                assert entry.state != "done" or history.open(entry.id, owner).result.duets[0].num_frames == 30
        database.close()
    with Target(folder, accounts=True) as lab:
        assert "event: complete" in lab.call("ada", "generate", FIELDS)


def backed_up(folder: Path) -> Path:
    """A backup of a lab with a study whose motions were deleted meanwhile."""
    database = Database(lab_at(folder).database)
    with database.session.begin() as session:
        session.add(Study(id="0" * 24, owner="user ada", key="k" * 24, question="q", runs="[]", captions="[]"))
    made = back_up(lab_at(folder), folder / "b")
    database.close()
    return made


def test_what_is_gone_is_left_out_and_so_are_sign_ins(tmp_path: Path) -> None:
    with closing(sqlite3.connect(backed_up(tmp_path) / "history.db")) as copy:
        assert copy.execute("SELECT count(*) FROM studies").fetchone() == (0,)
        assert copy.execute("SELECT count(*) FROM sessions").fetchone() == (0,)


@pytest.mark.parametrize("where", [0, 8192])
def test_a_damaged_database_takes_no_good_backup_s_place(tmp_path: Path, where: int) -> None:
    """With ``--keep`` a backup of damaged pages removed the last one that could be restored."""
    made = backed_up(tmp_path)
    with open(lab_at(tmp_path).database, "r+b") as damaged:
        damaged.seek(where)
        damaged.write(b"\xff" * 4096)
    with pytest.raises(InputError, match=r"history\.db is damaged \(.+\): no backup"):
        back_up(lab_at(tmp_path), tmp_path / "b", keep=1)
    assert backups(tmp_path / "b") == [made]


def test_the_shell_backs_up(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PASDEDEUX_DATA", str(tmp_path / "old"))
    assert main(["backup", str(tmp_path / "b")]) == 2
    Database(tmp_path / "old" / "history.db").close()
    assert main(["backup", str(tmp_path / "b")]) == 0 and len(backups(tmp_path / "b")) == 1
