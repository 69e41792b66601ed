"""Backups: made while people work, put back into an empty place, and refused where they are damaged."""

from __future__ import annotations

import json
import shutil
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest

from motion import InputError
from tests.server.attacks.target import Target
from tests.server.clients import DATABASES, FIELDS, database_url
from webdemo.cli import main
from webdemo.server.store.backup import Lab, back_up, back_up_if_due, backups, restore
from webdemo.server.store.database import Database, Study
from webdemo.server.store.history import History


@pytest.fixture(scope="module")
def drill(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Target, Path]]:
    """A real server with a schedule whose runs and removals go on during backups; and its folder of backups."""
    folder = tmp_path_factory.mktemp("drill")
    with Target(folder, accounts=True, backup=folder / "backups", backup_hours=1e-4, backup_keep=2) as lab:
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
        parts = lab_at(f"sqlite:///{folder / 'data' / 'history.db'}", folder)
        for _ in range(3):
            back_up(parts, folder / "by hand")
            time.sleep(1.1)
        parts.engine.dispose()
        stop.set()
        thread.join()
        yield lab, folder


def lab_at(url: str, folder: Path) -> Lab:
    from webdemo.server.store.database import engine_of

    return Lab(engine_of(url), folder / "data", folder / "users")


@pytest.mark.parametrize("kind", DATABASES)
def test_a_restore_drill(kind: str, drill: tuple[Target, Path], tmp_path: Path) -> None:
    """Every run of every backup opens in an empty place, people sign in, and the next run is kept."""
    for made in backups(drill[1] / "by hand")[: None if kind == "sqlite" else 1]:
        folder = tmp_path / made.name
        folder.mkdir()
        (folder / "data").mkdir()
        parts = lab_at(database_url(kind, folder), folder)
        restore(made, parts)
        database = Database(database_url(kind, folder))
        history = History(database, folder / "data" / "motions")
        entries = [*history.entries("user ada"), *history.entries("user eve")]
        done = [entry for entry in entries if entry.state == "done"]
        assert len(history.entries("user ada")) == 3 and all(entry.title == "First." for entry in entries[:3])
        for entry in done:
            owner = "user ada" if entry.title == "First." else "user eve"
            assert history.open(entry.id, owner).result.duets[0].num_frames == 30
        with pytest.raises(InputError, match="not empty"):
            restore(made, parts)
        database.close()
        parts.engine.dispose()
    if kind == "sqlite":
        again = folder / "again"
        again.mkdir()
        shutil.copytree(folder / "data", again / "data")
        shutil.copyfile(folder / "h.db", again / "data" / "history.db")
        with Target(again, accounts=True) as lab:
            assert "event: complete" in lab.call("ada", "generate", FIELDS)


def test_a_server_makes_backups_on_schedule_and_keeps_the_newest(drill: tuple[Target, Path]) -> None:
    folder = drill[1] / "backups"
    until = time.monotonic() + 30
    while not (found := backups(folder)):
        assert time.monotonic() < until
        time.sleep(0.5)
    assert len(found) <= 2 and (found[-1] / "users").stat().st_mode & 0o077 == 0


def test_only_what_is_due_is_made_and_the_newest_stay(tmp_path: Path) -> None:
    database = Database(f"sqlite:///{tmp_path / 'h.db'}")
    parts = Lab(database.engine, tmp_path / "data", None)
    made = back_up_if_due(parts, tmp_path / "b", hours=1, keep=2)
    assert made and back_up_if_due(parts, tmp_path / "b", hours=1, keep=2) is None
    for day in range(3):
        (tmp_path / "b" / f"pas-de-deux-2020-01-0{day + 1}T000000Z").mkdir()
        shutil.copyfile(
            made / "manifest.json", tmp_path / "b" / f"pas-de-deux-2020-01-0{day + 1}T000000Z/manifest.json"
        )
    time.sleep(1.1)
    newest = back_up(parts, tmp_path / "b", keep=2)
    assert backups(tmp_path / "b") == [made, newest]
    database.close()


def test_a_study_whose_motions_are_gone_is_left_out(tmp_path: Path) -> None:
    """As one is that is deleted between the rows and the files."""
    database = Database(f"sqlite:///{tmp_path / 'h.db'}")
    with database.session.begin() as session:
        session.add(Study(id="0" * 24, owner="user ada", key="k" * 24, question="q", runs="[]", captions="[]"))
    parts = Lab(database.engine, tmp_path / "data", None)
    made = back_up(parts, tmp_path / "b")
    assert '"studies"' not in (made / "rows.jsonl").read_text()
    database.close()


@pytest.mark.parametrize("harm", ["changed", "missing", "newer", "none"])
def test_a_damaged_backup_is_refused_and_nothing_written(harm: str, tmp_path: Path) -> None:
    database = Database(f"sqlite:///{tmp_path / 'h.db'}")
    made = back_up(Lab(database.engine, tmp_path / "data", None), tmp_path / "b")
    database.close()
    if harm == "changed":
        (made / "rows.jsonl").write_text('["runs", {}]\n')
    elif harm == "missing":
        (made / "rows.jsonl").unlink()
    elif harm == "newer":
        manifest = json.loads((made / "manifest.json").read_text()) | {"revision": "9999"}
        (made / "manifest.json").write_text(json.dumps(manifest))
    else:
        (made / "manifest.json").unlink()
    parts = lab_at(f"sqlite:///{tmp_path / 'new.db'}", tmp_path / "new")
    with pytest.raises(InputError, match=r"damaged|newer version|no backup"):
        restore(made, parts)
    parts.engine.dispose()
    assert not (tmp_path / "new").exists()


def test_the_shell_backs_up_and_restores(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("PASDEDEUX_DATA", str(tmp_path / "old"))
    assert main(["backup", str(tmp_path / "b")]) == 2
    Database(f"sqlite:///{tmp_path / 'old' / 'history.db'}").close()
    assert main(["backup", str(tmp_path / "b")]) == 0
    monkeypatch.setenv("PASDEDEUX_DATA", str(tmp_path / "new"))
    assert main(["restore", str(tmp_path / "b")]) == 0
    assert (tmp_path / "new" / "history.db").is_file()
    assert main(["restore", str(tmp_path / "b")]) == 2 and "not empty" in capsys.readouterr().err
