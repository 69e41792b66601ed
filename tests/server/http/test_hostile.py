"""Hostile uploads and requests."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import httpx
import pytest
from fastapi.testclient import TestClient

from tests.server.clients import FIELDS, REACT, UPLOAD, client_of, events_of, lab_of, settings_for
from webdemo.server.accounts.visitors import VISITOR_COOKIE, new_token
from webdemo.server.http import exchange


@pytest.fixture(scope="module")
def open_to_all(tmp_path_factory: pytest.TempPathFactory) -> Iterator[TestClient]:
    """A server without accounts, open to everybody."""
    with client_of(settings_for(tmp_path_factory.mktemp("open"), open=True)) as client:
        client.cookies.clear()
        yield client


def react(client: TestClient, actor: Any) -> str:
    return events_of(client, "react", [actor, *REACT])


@pytest.mark.parametrize(
    "name",
    [
        "../../../evil.bvh",
        "/etc/evil.bvh",
        "..\\..\\evil.bvh",
        "a/../../evil.bvh",
        "%2e%2e%2fevil.bvh",
        "evil.bvh\r\nSet-Cookie: a=b",
        "e" * 3000 + ".bvh",
        "CON.bvh",
        ".bvh",
        "evil.bvh/",
    ],
)
def test_an_upload_stays_in_its_folder(local: TestClient, name: str, tmp_path: Path) -> None:
    answer = local.post(UPLOAD, files={"files": (name, b"HIERARCHY")})
    assert answer.status_code in (200, 400, 422) and "set-cookie" not in answer.headers
    if answer.status_code == 200:
        (path,) = answer.json()
        assert Path(path).resolve().is_relative_to(Path(tempfile.gettempdir()).resolve() / "gradio")
        assert Path(path).is_file() and len(Path(path).name) < 256
    assert not Path("/etc/evil.bvh").exists() and not (Path.cwd().parent / "evil.bvh").exists()


@pytest.mark.parametrize("parts", ["bytes=0-0,2-2", "bytes=--1", "bytes=a-b", "lines=1-2"])
def test_parts_that_cannot_be_given_are_the_whole_file(local: TestClient, parts: str) -> None:
    (path,) = local.post("/gradio_api/upload", files={"files": ("a.bvh", b"HIERARCHY")}).json()
    answer = local.get(f"/gradio_api/file={path}", headers={"range": parts})
    assert (answer.status_code, answer.content) == (200, b"HIERARCHY")


@pytest.mark.parametrize(
    "content", [b"", b"\0" * 1000, b"PK\x03\x04 no zip", b"\x80\x04\x95 a pickle.", b"HIERARCHY\nROOT" * 99]
)
def test_a_broken_upload_is_a_sentence(local: TestClient, content: bytes) -> None:
    for suffix in ("bvh", "npz", "npy"):
        answer = local.post(UPLOAD, files={"files": (f"clip.{suffix}", content)})
        said = react(local, {"path": answer.json()[0], "meta": {"_type": "gradio.FileData"}})
        assert f'event: error\ndata: {{"error": "clip.{suffix}' in said, said
        assert "Traceback" not in said and "its log says more" not in said


def test_a_visitors_history_is_not_had_by_naming_them(open_to_all: TestClient) -> None:
    mine = {"cookie": "pasdedeux_visitor=" + "m" * 32}
    assert "event: complete" in events_of(open_to_all, "generate", FIELDS, mine)
    history = lab_of(open_to_all).history
    with history.database.engine.connect() as connection:
        owners = {row[0] for row in connection.exec_driver_sql("SELECT owner FROM runs")}
    assert len(owners) == 1 and "mmm" not in owners.pop()  # the cookie itself is not kept


@pytest.mark.parametrize(("path", "status"), [("/nothing", 429), ("/no//thing", 404)])
def test_whoever_is_refused_is_answered_once_a_second(
    served: tuple[str, int], monkeypatch: pytest.MonkeyPatch, path: str, status: int
) -> None:
    """Greedy connections would otherwise have the server do nothing but refuse, and /healthz would wait for that."""
    host, port = served
    headers, seconds, connections = {"cookie": f"{VISITOR_COOKIE}={new_token()}"}, 1.5, 5
    refused: list[float] = []

    def ask(until: float) -> None:
        with httpx.Client(base_url=f"http://{host}:{port}", headers=headers, timeout=30) as client:
            while time.monotonic() < until:
                if client.post(path).status_code == status:
                    refused.append(time.monotonic())

    with httpx.Client(base_url=f"http://{host}:{port}", headers=headers, timeout=30) as client:
        while client.post(path).status_code != status:
            pass
    monkeypatch.setattr(exchange, "BACK_OFF", 0.5)
    with ThreadPoolExecutor(connections) as greedy:
        list(greedy.map(ask, [time.monotonic() + seconds] * connections))
    assert 0 < len(refused) <= connections * (1 + seconds / exchange.BACK_OFF)
