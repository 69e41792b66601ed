"""Attacks that need more than one request: on passwords, accounts, the database, and connections."""

from __future__ import annotations

import socket
import sqlite3
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import pytest

from webdemo.server.accounts.accounts import Accounts
from webdemo.server.store.database import Database

from ..clients import FIELDS, read_all, wait_for
from .target import Target


@pytest.fixture
def own(tmp_path: Path) -> Iterator[Target]:
    """A server with accounts of its own, which a test may ruin."""
    with Target(tmp_path, accounts=True) as target:
        yield target


def health(target: Target) -> tuple[int, dict[str, str]]:
    answer = target.ask("stranger", "GET", "/healthz")
    return answer.status_code, answer.json()["checks"]


def test_a_changed_password_signs_its_owner_out(own: Target) -> None:
    for who in ("ada", "eve"):
        assert own.ask(who, "GET", "/config").status_code == 200
    database = Database(own.data / "history.db")
    Accounts(database).add("ada", "another password")
    database.close()
    assert own.ask("ada", "GET", "/config").status_code == 401
    assert own.ask("eve", "GET", "/config").status_code == 200


def test_a_damaged_database_is_reported(own: Target) -> None:
    """Its middle is overwritten while the server runs: no SQL is shown, and the health says so."""
    functions = own.ask("ada", "GET", "/config").json()["dependencies"]
    refresh = next(function["id"] for function in functions if function["api_name"] == "refresh")
    for _ in range(3):
        assert "event: complete" in own.call("ada", "generate", ["SECRET " * 60, *FIELDS[1:]])
    file = own.data / "history.db"
    with closing(sqlite3.connect(file)) as other:  # so that all is in the one file, and is read from it anew
        other.execute("PRAGMA wal_checkpoint(TRUNCATE)").fetchone()
    with open(file, "r+b") as damaged:
        damaged.seek(4096)
        damaged.write(b"\xff" * (file.stat().st_size - 4096))
    wait_for(lambda: health(own)[1]["database"].startswith("failed"))
    assert health(own)[0] == 503
    body = {"data": [None], "fn_index": refresh, "session_hash": "list"}
    said = own.call("ada", "generate", FIELDS)
    said += own.ask("ada", "POST", "/gradio_api/queue/join", json=body).text
    said += own.ask("ada", "GET", "/gradio_api/queue/data?session_hash=list").text
    assert "cannot be read or written" in said
    assert not [word for word in ("SELECT", "INSERT", "sqlalche", "SECRET", str(own.folder)) if word in said]


def test_two_lengths_are_one_too_many(anyone: Target) -> None:
    """Of a length and pieces a proxy may take the one and the server the other."""
    head = (
        "POST /gradio_api/queue/join HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Type: application/json\r\n"
        "Content-Length: 5\r\nTransfer-Encoding: chunked\r\nConnection: close\r\n\r\n0\r\n\r\n"
    )
    with socket.create_connection(("127.0.0.1", anyone.port), timeout=30) as one:
        one.sendall(head.encode())
        assert read_all(one).startswith(b"HTTP/1.1 400")


def test_idle_connections_keep_nobody_out(anyone: Target) -> None:
    """A thousand from one address, of which it may hold 400."""
    idle = []
    try:
        for _ in range(1000):
            idle.append(socket.create_connection(("127.0.0.1", anyone.port), timeout=30))
        with socket.create_connection(("127.0.0.1", anyone.port), timeout=30, source_address=("127.0.0.2", 0)) as other:
            other.sendall(b"GET /healthz HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: close\r\n\r\n")
            assert read_all(other).startswith(b"HTTP/1.1 200")
    finally:
        for one in idle:
            one.close()
