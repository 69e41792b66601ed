"""The addresses of live streams, behind the same checks as everything else."""

from __future__ import annotations

import asyncio
from collections.abc import Iterator
from typing import Any

import pytest
from fastapi.testclient import TestClient

from tests.server.clients import lab_of, sign_in
from tests.view.packed import unpack_positions
from webdemo.server.http.guard import _LIVE_WEIGHT

from .streaming import poses

WANTED = {"partner": "agent"}


@pytest.fixture
def client(local: TestClient) -> Iterator[TestClient]:
    yield local
    streams = lab_of(local).streams
    for stream in list(streams._open.values()):
        streams.close(stream)


def test_a_stream_from_its_start_to_its_end(client: TestClient) -> None:
    opened = client.post("/live", json=WANTED).json()
    assert opened["payload"]["id"] == f"stream-{opened['id']}"
    address = f"/live/{opened['id']}"
    answer = client.post(address, content=poses([0.0, 0.1])).json()
    assert unpack_positions(answer["frames"]).shape == (2, 4, 22, 3)
    assert client.get("/metrics").text.count("pasdedeux_live_streams 1.0") == 1
    assert client.delete(address).json() == {"frames": 4}
    for ended in (client.post(address, content=poses([0.2])), client.delete(address)):
        assert ended.status_code == 200, "a message on its way when its stream ends is no error in a browser's console"
        assert "press Start" in ended.json()["ended"]


def test_what_cannot_be_done_is_answered_with_a_sentence(client: TestClient) -> None:
    for fields, part in (
        ({}, "no live partner"),
        ({"partner": ["agent"]}, "no live partner"),
        ({**WANTED, "seed": -1}, "seed"),
    ):
        answer = client.post("/live", json=fields)
        assert answer.status_code == 422 and part in answer.json()["detail"], fields
    assert lab_of(client).streams.count == 0
    key = client.post("/live", json=WANTED).json()["id"]
    assert client.post(f"/live/{key}", content=b"[1]").status_code == 422
    assert client.post("/live/unknown", content=b"{}").status_code == 404
    assert client.get(f"/live/{key}").status_code in (404, 405)


def test_a_message_is_a_small_part_of_a_request() -> None:
    assert 60 * 30 * _LIVE_WEIGHT <= 120, "thirty messages a second leave half of the 240 requests a minute"


def test_a_message_that_breaks_off_is_no_error(client: TestClient, caplog: pytest.LogCaptureFixture) -> None:
    scope = {
        **{"type": "http", "method": "POST", "path": "/live/x", "raw_path": b"/live/x", "query_string": b""},
        **{"headers": [(b"host", b"127.0.0.1")], "client": ("127.0.0.1", 1), "scheme": "http", "root_path": ""},
    }
    messages = iter([{"type": "http.request", "body": b"{", "more_body": True}, {"type": "http.disconnect"}])
    sent: list[Any] = []

    async def receive() -> Any:
        return next(messages)

    async def send(message: Any) -> None:
        sent.append(message)

    asyncio.run(client.app(scope, receive, send))  # type: ignore[arg-type]
    assert not sent and "A request failed" not in caplog.text


def test_whoever_has_an_account_signs_in_first_and_has_their_own(shared: TestClient) -> None:
    assert shared.post("/live", json=WANTED).status_code == 401
    ada, eve = sign_in(shared, "ada"), sign_in(shared, "eve")
    key = shared.post("/live", json=WANTED, headers=ada).json()["id"]
    assert shared.post(f"/live/{key}", content=poses([0.0]), headers=eve).status_code == 404
    assert shared.delete(f"/live/{key}", headers=eve).status_code == 404
    assert shared.post(f"/live/{key}", content=poses([0.0]), headers=ada).status_code == 200
    assert shared.delete(f"/live/{key}", headers=ada).status_code == 200
