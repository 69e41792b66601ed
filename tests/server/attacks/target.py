"""A server in a process of its own, and the people who talk to it."""

from __future__ import annotations

import contextlib
import io
import json
import multiprocessing
import os
import secrets
import sqlite3
import time
import zipfile
from functools import cached_property
from pathlib import Path
from types import TracebackType
from typing import Any

import httpx
import pytest

from webdemo.cli import main
from webdemo.server.store.database import Database
from webdemo.server.store.notebook import Notebook
from webdemo.server.store.storage import Storage

from ..lab import add_accounts, free_port, serve_apart

READY = multiprocessing.get_context("forkserver")
READY.set_forkserver_preload(["tests.server.ready"])
"""Makes processes in which all that a server needs is imported."""
CANARY = "the canary that nobody may read"
SECRETS = (CANARY, "root:", "sqlite format 3", "traceback (most recent")
"""What stands in no answer, in small letters."""


class Target:
    """A server with the stub engine, started on entry and killed at the end.

    Args:
        folder: its data; ``canary.txt`` in it holds :data:`CANARY`.
        accounts: with those of ada and eve; without, it is open to everybody.
        stub_pause: seconds of a step of the stub engine.
        settings: further ones, by their names.
    """

    def __init__(self, folder: Path, *, accounts: bool, stub_pause: float = 0.0, **settings: Any) -> None:
        self.port = free_port()
        self.url, self.folder, self.accounts = f"http://127.0.0.1:{self.port}", folder, accounts
        self.data, self.stub_pause = folder / "data", stub_pause
        self.canary = folder / "canary.txt"
        self.canary.write_text(CANARY)
        given: dict[str, Any] = {"free_megabytes": 0, "rate": 100_000, "events": 1000, "grace_seconds": 1}
        if accounts:
            given |= {"accounts": 1, "host": "0.0.0.0", "hosts": '["127.0.0.1"]'}
            add_accounts(self.data, "ada", "eve")
        else:
            given |= {"open": 1}
        self.env = {f"PASDEDEUX_{name.upper()}": str(value) for name, value in {**given, **settings}.items()}
        self._clients: dict[str, httpx.Client] = {}

    def __enter__(self) -> Target:
        environment = {**os.environ, "OMP_NUM_THREADS": "1", "STUB_PAUSE": str(self.stub_pause), **self.env}
        given = (self.port, str(self.data), str(self.folder / "log"), environment)
        self.process = READY.Process(target=serve_apart, args=given, daemon=True)
        self.process.start()
        until = time.monotonic() + 240
        while not self.healthy():
            assert self.process.is_alive(), self.log()
            assert time.monotonic() < until, self.log()
            time.sleep(0.1)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.process.kill()
        self.process.join()

    def log(self) -> str:
        """What the server wrote so far."""
        return (self.folder / "log").read_text()

    def audited(self) -> list[dict[str, Any]]:
        """The lines about what people did, the newest first."""
        lines = [json.loads(line) for line in self.log().splitlines() if line.startswith("{")]
        return [line for line in lines if line["logger"] == "webdemo.server.audit"][::-1]

    def healthy(self) -> bool:
        """Whether it answers within ten seconds that it is well."""
        try:
            return httpx.get(f"{self.url}/healthz", timeout=10).status_code == 200
        except httpx.TransportError:
            return False

    def memory(self) -> float:
        """Megabytes that the process has in memory."""
        status = Path(f"/proc/{self.process.pid}/status").read_text()
        return int(status.split("VmRSS:")[1].split()[0]) / 1024

    def client(self, who: str) -> httpx.Client:
        """Somebody's connection: signed in where there are accounts, otherwise with a browser's cookie."""
        if who not in self._clients:
            client = self._clients[who] = httpx.Client(base_url=self.url, timeout=30)
            if who == "stranger":
                return client
            if self.accounts:
                given = {"username": who, "password": f"password of {who}"}
                assert client.post("/login", data=given).json() == {"success": True}
            else:
                client.get("/", headers={"accept": "text/html"})
        return self._clients[who]

    def sign_in_anew(self, who: str) -> None:
        """Forgets somebody's connection: what was asked at random may have signed them out."""
        self._clients.pop(who, None)

    def ask(self, who: str, method: str, path: str, **more: Any) -> httpx.Response:
        """One request of somebody's."""
        return self.client(who).request(method, path, **more)

    def call(self, who: str, endpoint: str, data: list[Any]) -> str:
        """What a call of an endpoint ends with, or the refusal of it."""
        asked = self.ask(who, "POST", f"/gradio_api/call/{endpoint}", json={"data": data})
        if asked.status_code != 200:
            return asked.text
        return self.ask(who, "GET", f"/gradio_api/call/{endpoint}/{asked.json()['event_id']}").text

    def event(self, who: str, function: int, data: list[Any], event_data: Any = None) -> str:
        """What an event of the page ends with, or the refusal of it."""
        body = {"data": data, "fn_index": function, "session_hash": secrets.token_hex(8), "event_data": event_data}
        if function not in self.unqueued:
            joined = self.ask(who, "POST", "/gradio_api/queue/join", json=body)
            if joined.status_code != 200:
                return joined.text
            return self.ask(who, "GET", f"/gradio_api/queue/data?session_hash={body['session_hash']}").text
        return self.ask(who, "POST", "/gradio_api/run/predict", json=body).text

    @cached_property
    def unqueued(self) -> set[int]:
        """The functions that are answered at once."""
        config = self.ask("eve", "GET", "/config").json()
        return {function["id"] for function in config["dependencies"] if function["queue"] is False}

    def upload(self, who: str, name: str, content: bytes) -> str:
        """Uploads a file; returns its path there."""
        (path,) = self.ask(who, "POST", "/gradio_api/upload", files={"files": (name, content)}).json()
        return path

    def shell(self, *words: str, given: str = "") -> dict[str, Any]:
        """What ``python -m webdemo …`` answers under the server's settings, in the process of the tests."""
        said = io.StringIO()
        with pytest.MonkeyPatch.context() as patch, contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
            for name, value in {**self.env, "PASDEDEUX_DATA": str(self.data)}.items():
                patch.setenv(name, value)
            patch.setattr("sys.stdin", io.StringIO(given))
            assert main(words) == 0, said.getvalue()
        return json.loads(said.getvalue().splitlines()[-1])

    def rows(self, query: str) -> list[tuple[Any, ...]]:
        """What the server's database answers."""
        with contextlib.closing(sqlite3.connect(self.data / "history.db")) as database:
            return database.execute(query).fetchall()

    def publish(self, owner: str, run: str) -> str:
        """Makes a public page of somebody's run; returns its key."""
        database = Database(self.data / "history.db")
        try:
            return Notebook(Storage(database, self.data / "motions")).publish(run, owner).key
        finally:
            database.close()

    def files_of(self, who: str) -> list[Path]:
        """Files that the server keeps for somebody while they use the page: uploads, downloads, thumbnails."""
        folder = Path(self.upload(who, "mark.bvh", who.encode())).parents[1]
        return [path for path in folder.rglob("*") if path.is_file()]

    @staticmethod
    def holds(path: Path, text: str) -> bool:
        """True if a text is in a file, or in one that an archive holds."""
        content = [path.read_bytes()]
        if zipfile.is_zipfile(path):
            with zipfile.ZipFile(path) as archive:
                content += [archive.read(name) for name in archive.namelist()]
        return any(text.encode() in part for part in content)

    def copies(self, text: str) -> list[Path]:
        """Files that the server made which hold a text."""
        scratch = [path for path in (self.data / "scratch").rglob("*") if path.is_file()]
        return [path for path in scratch if text.encode() in path.read_bytes()]
