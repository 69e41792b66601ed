"""Files that are there for a while go again; an upload costs what it weighs and finds a disk with room."""

from __future__ import annotations

import asyncio
import errno
import os
import re
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import matplotlib
import pytest
from fastapi.testclient import TestClient
from gradio import processing_utils

from motion import InputError, formats
from tests.server.clients import FIELDS, HERE, UPLOAD, client_of, events_of, lab_of, settings_for, wait_for
from tests.server.lab import stub_module
from webdemo.server import app as app_module
from webdemo.server.app import create_app
from webdemo.server.store.scratch import KEPT_SECONDS, LEAST_BYTES, Scratch
from webdemo.ui.history import Search

MB = 2**20
SMALL = {"files": ("a.bvh", b"HIERARCHY")}


def put(folder: Path, name: str, *, age: float, size: int = MB) -> Path:
    path = folder / name / "file.bvh"
    path.parent.mkdir(parents=True)
    path.write_bytes(b"x" * size)
    for each in (path, path.parent):
        os.utime(each, (time.time() - age,) * 2)
    return path


def test_what_is_old_goes_then_the_oldest_of_who_has_too_much(tmp_path: Path) -> None:
    scratch = Scratch(tmp_path / "s", 100 * MB)
    old = put(scratch.uploads, "old", age=KEPT_SECONDS + 1)
    own = put(scratch.uploads, "the page's own", age=2 * KEPT_SECONDS)
    ada = [put(scratch.uploads / "ada", str(i), age=1000 - i) for i in range(4)]
    used = put(scratch.uploads / "ada", "used", age=0)
    eve = [put(scratch.uploads / "eve", str(i), age=2000 - i) for i in range(3)]
    assert scratch.clean([str(own)], 3.5 * MB) == 3
    stays = [own, *ada[2:], used, *eve]
    assert [path for path in (old, own, *ada, used, *eve) if path.exists()] == stays
    os.utime(ada[0].parent, (0, 0))  # its file's removal had made it new
    scratch.clean([str(own)])
    assert not ada[0].parent.exists() and scratch.uploads.exists()


def test_a_person_s_own_files_make_way_and_no_others(tmp_path: Path) -> None:
    scratch = Scratch(tmp_path / "s", 10 * MB)
    ada = [put(scratch.uploads / "ada", str(i), age=1000 - i) for i in range(4)]
    eve = [put(scratch.uploads / "eve", str(i), age=2000 - i) for i in range(5)]
    scratch.admit("ada", "", 2 * MB, 5 * MB)
    assert [path.exists() for path in (*ada, *eve)] == [False, *[True] * 8]
    with pytest.raises(InputError, match="no room for 6 MB more"):
        scratch.admit("ada", "", 6 * MB, 5 * MB)
    put(scratch.uploads / "bob", "young", age=0, size=4 * MB)
    with pytest.raises(InputError, match="no room for 3 MB more"):  # all together have too much, but he has no old ones
        scratch.admit("bob", "", 3 * MB, 100 * MB)
    assert all(path.exists() for path in eve)
    later = put(scratch.uploads / "tim", "before the clock was set back", age=-3600)
    scratch.admit("tim", "", MB, MB)
    assert not later.exists()


def test_many_tiny_files_are_as_much_as_a_large_one(tmp_path: Path) -> None:
    """Each upload counts all files: half a million of a byte each, which an hour brought, took seconds every time."""
    scratch = Scratch(tmp_path / "s", 100 * MB)
    for i in range(40):
        put(scratch.uploads / "ada", str(i), age=1000 - i, size=1)
    scratch.admit("ada", "", 1, MB)
    assert sum(path.is_file() for path in scratch.uploads.rglob("*")) <= MB // LEAST_BYTES


def test_an_upload_counts_no_files_of_others(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """64,000 tiny files of strangers took 2 s of everybody's uploads; what is refused takes no room of others."""
    scratch = Scratch(tmp_path / "s", 10 * MB)
    put(scratch.uploads / "eve", "file", age=0, size=4 * MB)
    scratch.clean()
    counted: list[str] = []
    monkeypatch.setattr(scratch, "used", lambda name: counted.append(name) or 0)
    for _ in range(3):
        with pytest.raises(InputError, match="no room"):
            scratch.admit("mallory", "", 7 * MB, 100 * MB)
    scratch.admit("ada", "", 5 * MB, 100 * MB)
    with pytest.raises(InputError, match="no room"):
        scratch.admit("bob", "", 2 * MB, 100 * MB)
    assert "eve" not in counted


def test_new_names_bring_no_more_room_to_an_address(tmp_path: Path) -> None:
    scratch = Scratch(tmp_path / "s", 10 * MB)
    for number in range(5):
        scratch.admit(f"visitor {number}", "192.0.2.1", MB, 100 * MB)
        put(scratch.uploads / f"visitor {number}", "file", age=0)
    with pytest.raises(InputError, match="no room"):
        scratch.admit("visitor 5", "192.0.2.1", MB, 100 * MB)
    scratch.admit("visitor 6", "192.0.2.2", MB, 100 * MB)


def test_what_a_killed_process_left_goes_at_the_start(tmp_path: Path) -> None:
    left = put(Scratch(tmp_path / "s", MB).uploads, "left", age=0)
    assert Scratch(tmp_path / "s", MB).uploads.is_dir() and not left.exists()
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="cannot be made"):
        Scratch(tmp_path / "file", MB)


def test_a_server_keeps_its_files_there_and_tidies_them(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(app_module, "TIDY_EVERY", 0.05)
    monkeypatch.setenv("GRADIO_TEMP_DIR", "")
    scratch = Scratch(tmp_path / "s", 100 * MB)
    scratch.take_uploads()
    app = create_app(settings_for(tmp_path), engine=stub_module().StubEngine(), scratch=scratch)
    with TestClient(app, base_url=HERE, client=("127.0.0.1", 5)) as client:
        (upload,) = map(Path, client.post(UPLOAD, files={"files": ("a.bvh", b"HIERARCHY")}).json())
        assert upload.is_relative_to(scratch.uploads)
        assert "event: complete" in events_of(client, "generate", FIELDS)
        (made,) = scratch.uploads.glob("*/run-*")
        files = [upload, *made.iterdir()]
        assert len(files) > 3 and all(file.exists() for file in files)
        for file in files:
            os.utime(file, (0, 0))
        wait_for(lambda: not any(file.exists() for file in files))
        assert client.get("/", headers={"accept": "text/html"}).status_code == 200


def test_uploads_are_weighed(tmp_path: Path) -> None:
    def undeclared() -> Iterator[bytes]:
        yield b"--x\r\n"

    with client_of(settings_for(tmp_path, rate=30, upload_megabytes=20)) as client:
        file = {"files": ("a.bvh", os.urandom(12 * MB))}
        assert [client.post(UPLOAD, files=file).status_code for _ in range(3)] == [200, 200, 429]
        other = {"cookie": "pasdedeux_visitor=" + "o" * 32, "content-type": "multipart/form-data; boundary=x"}
        statuses = [client.post(UPLOAD, content=undeclared(), headers=other).status_code for _ in range(3)]
        assert 429 in statuses[1:] and statuses[0] != 429


def test_nothing_is_taken_where_the_disk_is_nearly_full(tmp_path: Path) -> None:
    with client_of(settings_for(tmp_path, free_megabytes=1e12)) as client:
        said = events_of(client, "generate", FIELDS)
        assert "event: error" in said and "disk is full" in said
        assert lab_of(client).history.search("local", Search()).total == 0
        answer = client.post(UPLOAD, files=SMALL)
        assert answer.status_code == 507 and "disk is full" in answer.json()["detail"]


def test_a_disk_that_fills_and_a_program_that_breaks(local: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    client = TestClient(local.app, base_url=HERE, client=("127.0.0.1", 5), raise_server_exceptions=False)

    def full(*args: Any, **more: Any) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr("gradio.routes.upload_fn", full)
    answer = client.post(UPLOAD, files=SMALL)
    assert answer.status_code == 507 and "disk is full" in answer.json()["detail"]
    assert b'pasdedeux_refused_total{reason="disk"} 1.0' in lab_of(client).figures.text()

    def broken(*args: Any, **more: Any) -> None:
        raise RuntimeError("a secret of the program's")

    monkeypatch.setattr("gradio.routes.upload_fn", broken)
    answer = client.post(UPLOAD, files=SMALL)
    reference = answer.headers["x-request-id"]
    assert answer.status_code == 500 and answer.json()["request"] == reference
    assert f"its log says more under {reference}" in answer.text and "secret" not in answer.text


def test_an_error_does_not_say_where_the_files_are(local: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(duet: Any, path: Path) -> None:
        raise InputError(f"{path} could not be written because the disk is full: free some space and try again.")

    monkeypatch.setattr(formats, "write", full)
    said = events_of(local, "generate", ["They walk to the end of the road.", *FIELDS[1:]])
    assert "event: error" in said
    assert re.search(r"road-seed0-[0-9a-f]{4}\.\w+ could not be written because the disk is full", said)
    assert "/" not in said.partition("data: ")[2]


def test_files_of_an_event_are_copied_beside_the_event_loop(local: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    """Some hundred questions about each file's place kept every other request waiting, /healthz for over a second."""
    move, moved = processing_utils.move_files_to_cache, []

    def noted(data: Any, *where: Any, **options: Any) -> Any:
        if "gradio.FileData" in str(data):
            moved.append(asyncio._get_running_loop() is None)
        return move(data, *where, **options)

    monkeypatch.setattr(processing_utils, "move_files_to_cache", noted)

    def imported(backend: str) -> None:
        raise AssertionError("pyplot is imported on the event loop, which takes a second")

    monkeypatch.setattr(matplotlib, "use", imported)
    assert "event: complete" in events_of(local, "generate", FIELDS)
    assert moved and all(moved)
