"""A server in a process of its own: stopped, killed, and watched for what it asks of other hosts."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import httpx
import pytest

from motion import InputError
from webdemo.server.store.database import Database
from webdemo.server.store.notebook import Notebook
from webdemo.ui.history import Entry, Search

from .clients import answer_of
from .lab import ROOT

pytestmark = pytest.mark.slow
CALL = "/gradio_api/call/generate"

WATCH = """
import runpy, sys
LOOPBACK = ("127.0.0.1", "::1", "localhost", "0.0.0.0", None, "")
def watch(event, args):
    if event == "socket.connect" and isinstance(args[1], tuple) and args[1][0] not in LOOPBACK:
        print("OUTSIDE", args[1], flush=True)
    if event == "socket.getaddrinfo" and args[0] not in LOOPBACK:
        print("OUTSIDE", args[0], flush=True)
sys.addaudithook(watch)
sys.argv = sys.argv[1:]
runpy.run_path(sys.argv[0], run_name="__main__")
"""


class Process:
    """A server on a free port: the stub's, or with ``real`` the program itself, watched."""

    def __init__(self, data: Path, *, real: bool = False, pause: float = 0.0) -> None:
        with socket.socket() as probe:
            probe.bind(("127.0.0.1", 0))
            port = probe.getsockname()[1]
        self.url, self.data = f"http://127.0.0.1:{port}", data
        env = os.environ | {
            "STUB_PAUSE": str(pause),
            "PASDEDEUX_GRACE_SECONDS": "120",
            "PASDEDEUX_FREE_MEGABYTES": "0",
            "PASDEDEUX_PORT": str(port),
            "PASDEDEUX_DATA": str(data),
            "OMP_NUM_THREADS": "1",
        }
        stub = [str(ROOT / "tests" / "server" / "lab.py"), str(port), str(data)]
        command = ["-c", WATCH, str(ROOT / "app.py")] if real else stub
        self.process = subprocess.Popen(
            [sys.executable, *command], cwd=ROOT, env=env, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
        )
        self.wait_for(lambda: self.get("/healthz") is not None)

    def wait_for(self, condition: Callable[[], bool]) -> None:
        until = time.monotonic() + 240
        while not condition():
            assert self.process.poll() is None, self.process.communicate()[0]
            assert time.monotonic() < until
            time.sleep(0.1)

    def get(self, path: str) -> httpx.Response | None:
        try:
            return httpx.get(f"{self.url}{path}", timeout=30)
        except httpx.TransportError:  # it does not listen yet
            return None

    def ask(self, steps: int) -> str:
        """Begins a run; returns where its result will come."""
        data = ["Two people walk.", 1, 3, 1, 3, steps, 0, "ddim", "intergen", 1]
        asked = httpx.post(f"{self.url}{CALL}", json={"data": data}, timeout=60)
        return f"{self.url}{CALL}/{asked.json()['event_id']}"

    def states(self) -> list[str]:
        return [entry.state for entry in self.entries()]

    def entries(self) -> Sequence[Entry]:
        return self.history().search("local", Search()).entries

    def history(self) -> Notebook:
        return Notebook(Database(self.data / "history.db"), self.data / "motions")


@pytest.fixture
def start(tmp_path: Path) -> Iterator[Any]:
    running: list[Process] = []

    def start_(**options: Any) -> Process:
        running.append(Process(tmp_path / "data", **options))
        return running[-1]

    yield start_
    for server in running:
        server.process.kill()
        server.process.wait()


def test_killed_while_it_works_started_again_and_stopped(start: Any) -> None:
    """The history is whole then; what runs at a stop is ended; and no other host is asked for anything."""
    killed = start(pause=0.5)
    assert "event: complete" in httpx.get(killed.ask(1), timeout=60).text
    killed.ask(400)
    killed.wait_for(lambda: killed.states() == ["running", "done"])
    half = killed.data / "motions" / f".{killed.entries()[0].id}"
    half.mkdir()  # as if it were about to be written
    killed.process.send_signal(signal.SIGKILL)
    killed.process.wait()

    server = start(real=True)
    assert server.states() == ["interrupted", "done"] and not half.exists()
    history = server.history()
    lost, whole = server.entries()
    assert history.open(whole.id, "local").result.duets[0].num_frames == 30
    with pytest.raises(InputError, match="run it again"):
        history.open(lost.id, "local")
    server.wait_for(lambda: server.get("/healthz").status_code == 200)  # its networks work
    place = server.ask(150)
    with httpx.stream("GET", place, timeout=120) as stream:
        server.wait_for(lambda: b"pasdedeux_queue_running 1.0" in server.get("/metrics").content)
        server.process.send_signal(signal.SIGTERM)
        lines = list(stream.iter_lines())
    assert [line for line in lines if line.startswith("event: ")][-1] == "event: complete"
    assert answer_of("\n".join(lines))["manifest"]["request"]["steps"] == 150
    said = server.process.communicate(timeout=60)[0]
    assert server.process.returncode in (0, -signal.SIGTERM)
    assert "OUTSIDE" not in said and "Traceback" not in said
    assert server.states() == ["done", "interrupted", "done"]
