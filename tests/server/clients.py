"""Servers with the stub engine for tests, and what one asks them."""

from __future__ import annotations

import json
import socket
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from fastapi.testclient import TestClient
from sqlalchemy import event

from webdemo.server.app import Lab, create_app
from webdemo.server.serve import make_server
from webdemo.server.settings import Settings
from webdemo.server.store.database import Database

from .lab import free_port, stub_module

JOIN, UPLOAD, CALL = "/gradio_api/queue/join", "/gradio_api/upload", "/gradio_api/call"
HERE = "http://127.0.0.1"
HTML = {"accept": "text/html"}
FIELDS = ["Two people walk.", 1, 0, 1, 3, 1, 0, "ddim", "intergen", 1]
"""What /generate is given: a second, one step, one try."""
REACT = ["", "", 0, 0, "a", 0, 1, 3, 1, 0, "ddim", "intergen", "offline", False, "", 0, "", ""]
"""What /react is given after its file."""
PREDICT = [0, 1, "still", 0, 1, "", 0, "", ""]
"""What /predict is given after its file."""


def settings_for(folder: Path, **fields: Any) -> Settings:
    return Settings(**({"data": folder / "data", "grace_seconds": 1, "free_megabytes": 0} | fields))


def client_of(settings: Settings, *, pause: float = 0.0, **options: Any) -> TestClient:
    app = create_app(settings, engine=stub_module().StubEngine(pause=pause))
    return TestClient(app, base_url=HERE, client=("127.0.0.1", 5), follow_redirects=False, **options)


def lab_of(client: TestClient) -> Lab:
    return client.app.state.lab  # type: ignore[attr-defined]


def sign_in(client: TestClient, name: str) -> dict[str, str]:
    """The headers of a signed-in user."""
    client.cookies.clear()
    answer = client.post("/login", data={"username": name, "password": f"password of {name}"})
    assert answer.json() == {"success": True}
    cookie = answer.headers["set-cookie"]
    assert all(part in cookie for part in ("HttpOnly", "SameSite=lax", "Path=/"))
    client.cookies.clear()
    return {"cookie": cookie.split(";")[0]}


def find_fn(client: TestClient, headers: dict[str, str], api_name: str) -> int:
    config = client.get("/config", headers=headers).json()
    return next(d["id"] for d in config["dependencies"] if d["api_name"] == api_name)


def events_of(client: TestClient, endpoint: str, data: list[Any], headers: dict[str, str] | None = None) -> str:
    """What a call of an endpoint ends with."""
    joined = client.post(f"{CALL}/{endpoint}", json={"data": data}, headers=headers)
    if joined.status_code != 200:
        return joined.text
    return client.get(f"{CALL}/{endpoint}/{joined.json()['event_id']}", headers=headers).text


def answer_of(said: str) -> dict[str, Any]:
    """The answer in the events of a call that came to its end."""
    data = next(line for line in said.splitlines() if line.startswith("data: ["))
    return json.loads(data.removeprefix("data: "))[0]


@contextmanager
def no_room(database: Database) -> Iterator[None]:
    """The database may not grow."""
    engine = database.engine

    def limit(connection: Any, record: Any) -> None:
        connection.execute("PRAGMA max_page_count=1")

    event.listen(engine, "connect", limit)
    engine.dispose()
    try:
        yield
    finally:
        event.remove(engine, "connect", limit)
        engine.dispose()


@contextmanager
def served_on_loopback(settings_folder: Path, *, engine: Any = None, **fields: Any) -> Iterator[tuple[str, int]]:
    """A server on a real socket, in a thread."""
    port = free_port()
    settings = settings_for(settings_folder, port=port, **fields)
    server = make_server(settings, engine=engine or stub_module().StubEngine())
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


class Clock:
    """A time that a test sets."""

    now = 1e6

    def __call__(self) -> float:
        return self.now


def wait_for(condition: Callable[[], Any]) -> None:
    """Returns once a condition holds, within a minute."""
    until = time.monotonic() + 60
    while not condition():
        assert time.monotonic() < until
        time.sleep(0.005)


def read_all(connection: socket.socket) -> bytes:
    parts = []
    while part := connection.recv(65536):
        parts.append(part)
    return b"".join(parts)


def answers(served: tuple[str, int], address: str = "127.0.0.1") -> bool:
    """Whether the server tells somebody at an address of this machine how it is."""
    with socket.create_connection(served, timeout=30, source_address=(address, 0)) as one:
        one.sendall(b"GET /healthz HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: close\r\n\r\n")
        return read_all(one).startswith((b"HTTP/1.1 200", b"HTTP/1.1 503"))
