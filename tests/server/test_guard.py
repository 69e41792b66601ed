"""What a stranger, another site or a hostile client gets to hear."""

from __future__ import annotations

import json
import logging
import socket
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from fastapi.testclient import TestClient
from sqlalchemy import update

from webdemo.server import accounts
from webdemo.server.accounts import Users
from webdemo.server.app import PAGES, Lab, create_app
from webdemo.server.bodies import Refused
from webdemo.server.database import SignIn
from webdemo.server.logs import JsonLines
from webdemo.server.pages import PageCache
from webdemo.server.serve import make_server
from webdemo.server.settings import Settings
from webdemo.server.visitors import Rates

from .lab import stub_module

JOIN = "/gradio_api/queue/join"
HERE = "http://127.0.0.1"


def settings_for(folder: Path, **fields: Any) -> Settings:
    return Settings(**({"data": folder / "data", "grace_seconds": 1, "free_megabytes": 0} | fields))


def client_of(settings: Settings, **options: Any) -> TestClient:
    app = create_app(settings, engine=stub_module().StubEngine())
    return TestClient(app, base_url=HERE, client=("127.0.0.1", 5), follow_redirects=False, **options)


@pytest.fixture(scope="module")
def local(tmp_path_factory: pytest.TempPathFactory) -> Iterator[TestClient]:
    with client_of(settings_for(tmp_path_factory.mktemp("local"), metrics_token="")) as client:
        yield client


@pytest.fixture(scope="module")
def shared(tmp_path_factory: pytest.TempPathFactory) -> Iterator[TestClient]:
    """A server with the accounts of ada and eve."""
    folder = tmp_path_factory.mktemp("shared")
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(accounts._COST, "n", 2**4)
        for name in ("ada", "eve"):
            Users(folder / "users").add(name, f"password of {name}")
        with client_of(
            settings_for(folder, users=folder / "users", host="0.0.0.0", hosts=["127.0.0.1"])
        ) as c:
            yield c


def lab_of(client: TestClient) -> Lab:
    return client.app.state.lab  # type: ignore[attr-defined]


def sign_in(client: TestClient, name: str) -> dict[str, str]:
    """The headers of somebody who signed in."""
    client.cookies.clear()
    answer = client.post("/login", data={"username": name, "password": f"password of {name}"})
    assert answer.json() == {"success": True}
    cookie = answer.headers["set-cookie"]
    assert all(part in cookie for part in ("HttpOnly", "SameSite=Lax", "Path=/"))
    client.cookies.clear()
    return {"cookie": cookie.split(";")[0]}


def find_fn(client: TestClient, headers: dict[str, str], api_name: str) -> int:
    config = client.get("/config", headers=headers).json()
    return next(d["id"] for d in config["dependencies"] if d["api_name"] == api_name)


# ---- a page for everybody on this machine --------------------------------------------------------


def test_the_page_and_its_headers(local: TestClient) -> None:
    answer = local.get("/", headers={"accept": "text/html"})
    assert answer.status_code == 200 and "Pas de Deux" in answer.text
    assert answer.headers["x-content-type-options"] == "nosniff"
    assert answer.headers["referrer-policy"] == "same-origin"
    assert len(answer.headers["x-request-id"]) == 12
    assert "pasdedeux_visitor=" in answer.headers["set-cookie"]


def test_ready_when_a_generation_works(local: TestClient) -> None:
    until = time.monotonic() + 60
    while (answer := local.get("/healthz")).status_code != 200:
        assert time.monotonic() < until
        time.sleep(0.05)
    assert answer.json() == {"status": "ready", "checks": {"database": "ok", "generation": "ok"}}
    lab_of(local).health.broken(RuntimeError())
    answer = local.get("/healthz")
    assert answer.status_code == 503 and "RuntimeError" in answer.json()["checks"]["generation"]
    lab_of(local).health._tried_at -= 100
    local.get("/healthz")
    while local.get("/healthz").status_code != 200:
        assert time.monotonic() < until
        time.sleep(0.05)


def test_figures(local: TestClient) -> None:
    local.get("/no/such/place/" + "x" * 50)
    text = local.get("/metrics").text
    assert 'pasdedeux_http_requests_total{method="GET",route="(other)",status="404"}' in text
    assert "pasdedeux_ready" in text and "pasdedeux_queue_waiting 0.0" in text and "xxx" not in text


@pytest.mark.parametrize(
    "path",
    [
        "/gradio_api/file=/etc/passwd", "/gradio_api/file=../../etc/passwd", "/gradio_api/file=%2e%2e/x",
        "/gradio_api/file=/proc/self/environ", "/gradio_api/file=https://example.com/x",
        "/gradio_api/proxy=https://example.com/", "/monitoring", "/gradio_api/vibe-edit/", "/docs",
        "/openapi.json", "/gradio_api/file=app.py", "/a%00b", "/..%5c..%5cx", "/static/../app.py",
        "/gradio_api/dev/reload", "/gradio_api/deep_link",
    ],
)  # fmt: skip
def test_paths_lead_nowhere(local: TestClient, path: str) -> None:
    answer = local.get(path)
    assert answer.status_code in (400, 403, 404) and "root:" not in answer.text


def test_the_database_is_not_served(local: TestClient) -> None:
    for file in (lab_of(local).settings.data / "history.db", Path(__file__)):
        assert local.get(f"/gradio_api/file={file}").status_code in (403, 404)


@pytest.mark.parametrize(
    "headers",
    [
        {"origin": "https://evil.example"}, {"origin": "null"}, {"sec-fetch-site": "cross-site"},
        {"origin": "http://127.0.0.1:9999"}, {"origin": "http://127.0.0.1.evil.example"},
    ],
)  # fmt: skip
def test_other_sites_change_nothing(local: TestClient, headers: dict[str, str]) -> None:
    answer = local.post(JOIN, json={"session_hash": "s1", "data": [], "fn_index": 0}, headers=headers)
    assert answer.status_code == 403 and "Another site's page" in answer.json()["detail"]


def test_foreign_names_are_refused(local: TestClient) -> None:
    """A site whose name is made to point to this machine is still that site."""
    assert local.get("/", headers={"host": "evil.example"}).status_code == 421
    assert local.get("/", headers={"host": "localhost:1234"}).status_code == 200


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
    assert local.post(JOIN, content=b"[" * 200_000).status_code == 400
    assert local.post(JOIN, content=b'{"session_hash": 7}').status_code == 400
    assert local.post(JOIN, content=b"{}", headers={"content-length": "-5"}).status_code == 400
    assert local.get("/" + "a" * 5000).status_code == 414


def test_logs_hold_no_prompt_and_no_forged_line(local: TestClient, caplog: pytest.LogCaptureFixture) -> None:
    forged = 'x\r\n{"level": "error", "message": "forged"}'
    with caplog.at_level(logging.DEBUG):
        local.get("/?run=SECRETKEY&x=" + "%0d%0aSet-Cookie:%20a=b")
        local.post(JOIN, json={"session_hash": "s", "data": ["SECRET PROMPT"]}, headers={"user-agent": "a"})
        logging.getLogger("elsewhere").warning("got %s", "SECRET PROMPT")
        logging.getLogger("webdemo").warning("%s", forged)
        try:
            raise ValueError("SECRET PROMPT")
        except ValueError:
            logging.getLogger("webdemo").exception("A request failed.")
    lines = [JsonLines().format(record) for record in caplog.records]
    assert not any("SECRET" in line or "\n" in line for line in lines)
    assert json.loads(lines[-2])["message"] == forged
    assert json.loads(lines[-1])["error"] == "ValueError"
    kept = json.loads(JsonLines(content=True).format(caplog.records[-1]))
    assert kept["error_text"] == "SECRET PROMPT"


def test_too_many_requests() -> None:
    rates = Rates(5)
    for _ in range(5):
        rates.take("a")
    with pytest.raises(Refused, match="too many requests"):
        rates.take("a")
    rates.take("b")


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


def test_a_kept_page_is_not_made_again() -> None:
    made: list[str] = []

    async def page(scope: Any, receive: Any, send: Any) -> None:
        made.append(scope["path"])
        await send({"type": "http.response.start", "status": 200, "headers": []})
        await send({"type": "http.response.body", "body": b"page"})

    client = TestClient(PageCache(page))
    assert [client.get(path).text for path in ("/", "/", "/?run=1", "/")] == ["page"] * 4
    assert made == ["/"]
    for path in ("/other", "/?theme=dark"):
        client.get(path)
    assert made == ["/", "/other", "/"]


def test_nobody_says_where_the_page_is(local: TestClient) -> None:
    """Gradio would take these headers for the page's address, and put it into every link."""
    for name in ("x-forwarded-host", "x-gradio-server"):
        for path in ("/", "/config"):
            assert "evil.example" not in local.get(path, headers={name: "http://evil.example"}).text


def test_what_pages_leave_behind_is_bounded(local: TestClient) -> None:
    mounted = next(
        route.app for route in local.app.routes if hasattr(getattr(route, "app", None), "state_holder")
    )
    assert mounted.state_holder.capacity == PAGES


# ---- accounts ------------------------------------------------------------------------------------


def test_nothing_without_signing_in(shared: TestClient) -> None:
    shared.cookies.clear()
    asked = shared.get("/?run=abc", headers={"accept": "text/html"})
    assert asked.status_code == 303 and asked.headers["location"] == "/login?next=%2F%3Frun%3Dabc"
    for path in ("/config", "/gradio_api/info", "/gradio_api/queue/data?session_hash=x", "/theme.css"):
        assert shared.get(path).status_code == 401
    for path in (JOIN, "/gradio_api/upload", "/gradio_api/call/generate", "/gradio_api/cancel"):
        assert shared.post(path, json={}).status_code == 401
    assert shared.get("/healthz").status_code in (200, 503)
    assert "Sign in" in shared.get("/login").text


def test_signing_in_from_the_page(shared: TestClient) -> None:
    html = {"accept": "text/html"}
    wrong = shared.post("/login", data={"username": "ada", "password": "no"}, headers=html)
    assert wrong.status_code == 401 and "do not fit" in wrong.text
    for wanted, place in (("/?run=x", "/?run=x"), ("https://evil.example/", "/"), ("//evil.example", "/"),
                          ("/\\evil.example", "/"), ("/x\r\nSet-Cookie: a=b", "/")):  # fmt: skip
        fields = {"username": "ada", "password": "password of ada", "next": wanted}
        answer = shared.post("/login", data=fields, headers=html)
        assert (answer.status_code, answer.headers["location"]) == (303, place)
    quoted = shared.get("/login", params={"next": '/"><script>alert(1)</script>'}).text
    assert "<script>alert" not in quoted


def test_another_sites_form_does_not_sign_in(shared: TestClient) -> None:
    fields = {"username": "ada", "password": "password of ada"}
    answer = shared.post("/login", data=fields, headers={"origin": "https://evil.example"})
    assert answer.status_code == 403 and "set-cookie" not in answer.headers


def test_sessions_end_and_are_not_forged(shared: TestClient) -> None:
    ada = sign_in(shared, "ada")
    assert shared.get("/config", headers=ada).status_code == 200
    forged = {"cookie": "pasdedeux_session=" + "A" * 43}
    assert shared.get("/config", headers=forged).status_code == 401
    shared.post("/logout", headers=ada)
    assert shared.get("/config", headers=ada).status_code == 401
    late = sign_in(shared, "ada")
    with lab_of(shared).database.session.begin() as session:
        session.execute(update(SignIn).values(until=time.time() - 1))
    assert shared.get("/config", headers=late).status_code == 401


def test_a_page_session_is_its_persons(shared: TestClient) -> None:
    ada, eve = sign_in(shared, "ada"), sign_in(shared, "eve")
    fn = find_fn(shared, ada, "generate")
    fields = ["Two people walk.", 1, 0, 1, 3, 1, 0, "ddim"]
    body = {"data": fields, "fn_index": fn, "session_hash": "adas"}
    assert shared.post(JOIN, json=body, headers=ada).status_code == 200
    assert shared.post(JOIN, json=body, headers=eve).status_code == 403
    assert shared.get("/gradio_api/queue/data?session_hash=adas", headers=eve).status_code == 403
    assert shared.get("/gradio_api/heartbeat/adas", headers=eve).status_code == 403
    stop = {"session_hash": "adas", "fn_index": fn, "event_id": "x"}
    assert shared.post("/gradio_api/cancel", json=stop, headers=eve).status_code == 403
    told = shared.get("/gradio_api/queue/data?session_hash=adas", headers=ada).text
    assert "process_completed" in told and '"seed": 0' in told.replace('"seed":0', '"seed": 0')
    history = lab_of(shared).history
    assert [entry.title for entry in history.entries("user ada")] == ["Two people walk."]
    assert history.entries("user eve") == []


def test_a_notebook_signs_in(shared: TestClient) -> None:
    """What gradio_client does with auth=(name, password)."""
    answer = shared.post("/login", data={"username": "eve", "password": "password of eve"})
    shared.cookies.clear()
    cookies = {"cookie": f"pasdedeux_session={answer.cookies['pasdedeux_session']}"}
    body = {"data": ["impossible", 1, 0, 1, 3, 1, 0, "ddim"]}
    event = shared.post("/gradio_api/call/generate", json=body, headers=cookies).json()["event_id"]
    told = shared.get(f"/gradio_api/call/generate/{event}", headers=cookies).text
    assert "event: error" in told and "The stub cannot do this: ask for something possible." in told


# ---- a real socket -------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def served(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[str, int]]:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    settings = settings_for(
        tmp_path_factory.mktemp("served"), port=port, header_seconds=1, body_seconds=1, connections=40
    )
    server = make_server(settings, engine=stub_module().StubEngine())
    thread = threading.Thread(target=server.run, daemon=True)
    thread.start()
    until = time.monotonic() + 120
    while not server.started:
        assert time.monotonic() < until
        time.sleep(0.05)
    yield "127.0.0.1", port
    server.should_exit = True
    thread.join(timeout=60)
    assert not thread.is_alive()


def read_all(connection: socket.socket) -> bytes:
    parts = []
    while part := connection.recv(65536):
        parts.append(part)
    return b"".join(parts)


def test_a_head_that_never_ends_is_cut_off(served: tuple[str, int]) -> None:
    with socket.create_connection(served, timeout=30) as slow:
        slow.sendall(b"GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nX-Slow: ")
        assert read_all(slow) == b""


def test_a_body_that_never_comes_is_cut_off(served: tuple[str, int]) -> None:
    head = f"POST {JOIN} HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Length: 100\r\nConnection: close\r\n\r\n{{"
    with socket.create_connection(served, timeout=30) as slow:
        slow.sendall(head.encode())
        assert read_all(slow).startswith(b"HTTP/1.1 408")


def test_a_flood_of_connections_leaves_the_page_up(served: tuple[str, int]) -> None:
    flood = [socket.create_connection(served, timeout=30) for _ in range(60)]
    time.sleep(0.2)
    closed = 0
    for connection in flood[40:]:
        connection.settimeout(10)
        closed += connection.recv(1) == b""
    for connection in flood:
        connection.close()
    assert closed == 20
    time.sleep(0.3)
    with socket.create_connection(served, timeout=30) as one:
        one.sendall(b"GET /healthz HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: close\r\n\r\n")
        assert read_all(one).startswith((b"HTTP/1.1 200", b"HTTP/1.1 503"))


def test_broken_http_is_refused(served: tuple[str, int]) -> None:
    for text in (b"NOT HTTP AT ALL\r\n\r\n", b"GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nX: a\r\n b\x00\r\n\r\n"):
        with socket.create_connection(served, timeout=30) as broken:
            broken.sendall(text)
            assert b" 400 " in broken.recv(4096)
