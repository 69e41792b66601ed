"""Backups: made while people work, put back into an empty place, and refused where they are damaged."""

from __future__ import annotations

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
from webdemo.server.store.backup import back_up, backups, restore
from webdemo.server.store.database import Database, Study
from webdemo.server.store.notebook import Notebook
from webdemo.ui.history import Search


def lab_at(folder: Path) -> Settings:
    return Settings(data=folder / "data", users=folder / "users")


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
        for _ in range(3):
            back_up(lab_at(tmp_path / "lab"), tmp_path / "backups", keep=2)
            time.sleep(1.1)
        stop.set()
        thread.join()
    assert len(backups(tmp_path / "backups")) == 2
    for made in backups(tmp_path / "backups"):
        folder = tmp_path / made.name
        restore(made, lab_at(folder))
        assert (made / "users").stat().st_mode & 0o077 == 0
        database = Database(lab_at(folder).database)
        history = Notebook(database, folder / "data" / "motions")
        assert history.search("user ada", Search()).total == 3
        for owner in ("user ada", "user eve"):
            for entry in history.search(owner, Search(limit=500)).entries:
                assert entry.state != "done" or history.open(entry.id, owner).result.duets[0].num_frames == 30
        database.close()
        with pytest.raises(InputError, match="already: restore into an empty folder"):
            restore(made, lab_at(folder))
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


@pytest.mark.parametrize("harm", ["changed", "missing", "newer", "none"])
def test_a_damaged_backup_is_refused_and_nothing_written(harm: str, tmp_path: Path) -> None:
    made = backed_up(tmp_path)
    if harm == "changed":
        (made / "history.db").write_bytes(b"x" * 8192)
    elif harm == "missing":
        with closing(sqlite3.connect(made / "history.db")) as copy:
            copy.execute("INSERT INTO studies VALUES ('0', 'user ada', 'k', 'q', '[]', '[]', 0, 0, '')")
            copy.commit()
    elif harm == "newer":
        with closing(sqlite3.connect(made / "history.db")) as copy:
            copy.execute("PRAGMA user_version = 99")
            copy.commit()
    else:
        (made / "history.db").unlink()
    with pytest.raises(InputError, match=r"damaged|another version|a folder that `backup` made"):
        restore(made, lab_at(tmp_path / "new"))
    assert not [path for path in (tmp_path / "new").rglob("*") if path.is_file()]


def test_the_shell_backs_up_and_restores(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("PASDEDEUX_DATA", str(tmp_path / "old"))
    assert main(["backup", str(tmp_path / "b")]) == 2
    Database(tmp_path / "old" / "history.db").close()
    assert main(["backup", str(tmp_path / "b")]) == 0
    monkeypatch.setenv("PASDEDEUX_DATA", str(tmp_path / "new"))
    assert main(["restore", str(tmp_path / "b")]) == 0
    assert (tmp_path / "new" / "history.db").is_file()
    assert main(["restore", str(tmp_path / "b")]) == 2 and "empty folder" in capsys.readouterr().err
