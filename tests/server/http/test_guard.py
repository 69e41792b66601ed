"""What a stranger, another site or a hostile client gets to hear."""

from __future__ import annotations

import asyncio
import threading
import time
import tracemalloc
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from fastapi.testclient import TestClient
from starlette.concurrency import run_in_threadpool

from tests.server.clients import HERE, HTML, JOIN, client_of, settings_for
from webdemo.server.accounts import quotas
from webdemo.server.http import page_html
from webdemo.server.http.page_html import PageCache


def test_the_page_and_its_headers(local: TestClient) -> None:
    local.cookies.clear()
    answer = local.get("/", headers={"accept": "text/html"})
    assert answer.status_code == 200 and "Pas de Deux" in answer.text
    assert answer.headers["x-content-type-options"] == "nosniff"
    assert answer.headers["referrer-policy"] == "same-origin"
    assert len(answer.headers["x-request-id"]) == 12
    assert "pasdedeux_visitor=" in answer.headers["set-cookie"]


def test_foreign_names_are_refused(local: TestClient) -> None:
    """A site whose name is made to point to this machine is still that site."""
    assert local.get("/", headers={"host": "evil.example"}).status_code == 421
    assert local.get("/", headers={"host": "localhost:1234"}).status_code == 200


def test_a_server_with_names_of_its_own_still_answers_its_machine_s_health_check(tmp_path: Path) -> None:
    with client_of(settings_for(tmp_path, host="0.0.0.0", open=True, hosts=["lab.example"])) as client:
        for name, refused in (("lab.example", False), ("localhost", False), ("evil.example", True)):
            assert (client.get("/healthz", headers={"host": name}).status_code == 421) == refused


def test_gradios_own_check_of_files_is_on(local: TestClient) -> None:
    """It is left out for a page that was not launched, and a mounted one never is."""
    (mounted,) = [r.app for r in local.app.routes if hasattr(getattr(r, "app", None), "state_holder")]
    assert mounted.get_blocks().has_launched


def test_behind_an_unsaid_proxy_nobody_gets_in(local: TestClient) -> None:
    other = TestClient(local.app, base_url=HERE, client=("203.0.113.9", 5))
    answer = other.get("/config")
    assert answer.status_code == 403 and "PASDEDEUX_OPEN" in answer.json()["detail"]
    assert other.get("/metrics").status_code == 403


def test_bodies_have_limits(local: TestClient) -> None:
    big = {"content-length": str(10**9), "content-type": "application/json"}
    assert local.post(JOIN, content=b"{}", headers=big).status_code == 413
    assert local.post("/gradio_api/upload", content=b"x", headers=big).status_code == 413

    def endless() -> Iterator[bytes]:
        for _ in range(64):
            yield b" " * 65536

    assert local.post(JOIN, content=endless()).status_code == 413
    assert local.post(JOIN, content=b"{}", headers={"content-length": "-5"}).status_code == 400


def test_below_a_path(tmp_path: Path) -> None:
    """A proxy may cut the base path off, or leave it; the page's own addresses hold it."""
    settings = settings_for(tmp_path, root_path="/motion", proxies=["127.0.0.1"])
    client = client_of(settings)
    for path in ("/motion/config", "/config"):
        assert client.get(path).json()["root"] == f"{HERE}/motion"
    answer = client.get("/motion")
    assert answer.status_code == 200 and "Path=/motion;" in answer.headers["set-cookie"]
    assert client.get("/motionx").status_code == 404


def test_the_page_is_made_once_for_everybody(local: TestClient) -> None:
    html = {"accept": "text/html"}
    answers = []
    for _ in range(2):
        local.cookies.clear()  # a stranger each time
        answers.append(local.get("/", headers=html))
    first, second = answers
    assert first.text == second.text and first.headers["x-request-id"] != second.headers["x-request-id"]
    assert first.headers["set-cookie"] != second.headers["set-cookie"]  # whose it is, is not kept
    assert len(second.headers.get_list("x-request-id")) == 1
    assert local.get("/?run=abc", headers=html).text == first.text
    elsewhere = local.get("/", headers={**html, "host": "localhost:99"}).text
    assert "http://localhost:99" in elsewhere and "http://localhost:99" not in local.get("/").text


def test_many_who_come_at_once_wait_for_one_page_and_hold_little_of_it() -> None:
    """Four hundred of one address who read nothing held the whole page each."""
    made: list[str] = []

    async def page(scope: Any, receive: Any, send: Any) -> None:
        made.append(scope["path"])
        await asyncio.sleep(0.05)
        await send({"type": "http.response.start", "status": 200, "headers": []})
        await send({"type": "http.response.body", "body": page_html._ANY.join([bytes(2**20)] * 2)})

    async def come() -> None:
        cache, sent = PageCache(page), []
        scope = {"type": "http", "method": "GET", "path": "/", "scheme": "http", "headers": []}

        async def send(message: Any) -> None:
            sent.append(message["type"])
            await asyncio.sleep(60 * ("body" in message))

        tracemalloc.start()
        answers = [asyncio.create_task(cache(scope, asyncio.sleep, send)) for _ in range(40)]
        await asyncio.sleep(0.5)
        assert sent.count("http.response.start") == len(answers)
        assert tracemalloc.get_traced_memory()[0] < 20 * 2**20
        tracemalloc.stop()

    asyncio.run(come())
    assert made == ["/"]


def test_an_address_that_asks_for_page_after_page_waits(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(quotas, "GETS", 200)
    with client_of(settings_for(tmp_path, rate=100)) as client:
        assert [client.get("/config").status_code for _ in range(22)].count(429) == 2
        watched = [client.get("/healthz").status_code for _ in range(220)]
        assert watched[0] in (200, 503), "those who watch the server are let through"
        assert watched[-1] == 429, "unless they do nothing else"


def test_health_is_told_while_every_thread_waits(local: TestClient) -> None:
    gate = threading.Event()

    async def hold() -> None:
        await asyncio.gather(*(run_in_threadpool(gate.wait, 60) for _ in range(200)))

    assert local.portal is not None
    held = local.portal.start_task_soon(hold)
    try:
        began = time.monotonic()
        assert local.get("/healthz").status_code in (200, 503)
        assert time.monotonic() - began < 20
    finally:
        gate.set()
        held.result(timeout=60)


def test_the_page_is_sent_compressed(local: TestClient) -> None:
    sizes = {}
    for encoding in ("gzip", "identity"):
        for path in ("/", "/?run=abc"):  # made, then kept
            with local.stream("GET", path, headers={**HTML, "accept-encoding": encoding}) as answer:
                sizes[encoding] = sum(map(len, answer.iter_raw()))
                assert answer.headers.get("content-encoding", "identity") == encoding
    assert sizes["gzip"] < sizes["identity"] / 5


def test_the_page_is_packed_once_for_all_names(local: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each port is another name: to pack the page anew for each cost 15 ms, and 40 strangers kept the rest waiting."""
    before = local.get("/", headers=HTML).text
    monkeypatch.setattr(page_html.zlib, "compressobj", None)
    for host in ("127.0.0.1:7", "localhost:54321", "localhost"):
        answer = local.get("/", headers={**HTML, "host": host, "accept-encoding": "gzip"})
        assert answer.headers["content-encoding"] == "gzip"
        assert answer.text == before.replace("http://127.0.0.1", f"http://{host}")


def test_a_browser_gets_an_error_page_of_the_lab(local: TestClient) -> None:
    for path, status, sentence in (
        ("/no/such/place", 404, "There is nothing here."),
        ("/" + "a" * 5000, 414, "The address is too long."),
    ):
        answer = local.get(path, headers=HTML)
        assert answer.status_code == status and answer.headers["content-type"].startswith("text/html")
        assert f'<p role="alert">{sentence}</p>' in answer.text and 'href="/"' in answer.text
        assert answer.headers["x-request-id"] in answer.text
    assert local.get("/no/such/place").json() == {"detail": "Not Found"}
