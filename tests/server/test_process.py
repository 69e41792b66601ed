"""A server in a process of its own: stopped, killed, and watched for what it asks of other hosts."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest

from motion import InputError
from webdemo.server.store.database import Database
from webdemo.server.store.notebook import Notebook
from webdemo.server.store.storage import Storage
from webdemo.ui.history import Search

from .attacks.target import Target
from .clients import FIELDS, answer_of, wait_for
from .lab import ROOT, free_port

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
    """The program itself on a free port, watched."""

    def __init__(self, data: Path) -> None:
        port = free_port()
        self.url, self.data = f"http://127.0.0.1:{port}", data
        env = os.environ | {
            "PASDEDEUX_GRACE_SECONDS": "120",
            "PASDEDEUX_FREE_MEGABYTES": "0",
            "PASDEDEUX_PORT": str(port),
            "PASDEDEUX_DATA": str(data),
            "OMP_NUM_THREADS": "1",
        }
        command = [sys.executable, "-c", WATCH, str(ROOT / "app.py")]
        self.process = subprocess.Popen(
            command, cwd=ROOT, env=env, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
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


def history(data: Path) -> Notebook:
    return Notebook(Storage(Database(data / "history.db"), data / "motions"))


def states(data: Path) -> list[str]:
    return [entry.state for entry in history(data).search("local", Search()).entries]


@pytest.fixture
def start(tmp_path: Path) -> Iterator[Any]:
    running: list[Process] = []

    def start_() -> Process:
        running.append(Process(tmp_path / "data"))
        return running[-1]

    yield start_
    for server in running:
        server.process.kill()
        server.process.wait()


def test_killed_while_it_works_started_again_and_stopped(start: Any, tmp_path: Path) -> None:
    """The history is whole then; what runs at a stop is ended; and no other host is asked for anything."""
    data = tmp_path / "data"
    with Target(tmp_path, accounts=False, stub_pause=0.5, open=0) as killed:
        assert "event: complete" in killed.call("eve", "generate", FIELDS)
        killed.ask("eve", "POST", CALL, json={"data": [*FIELDS[:5], 400, *FIELDS[6:]]})
        wait_for(lambda: states(data) == ["running", "done"])
        half = data / "motions" / f".{history(data).search('local', Search()).entries[0].id}"
        half.mkdir()  # as if it were about to be written
        killed.process.kill()
        killed.process.join()

    server = start()
    assert states(data) == ["interrupted", "done"] and not half.exists()
    kept = history(data)
    lost, whole = kept.search("local", Search()).entries
    assert kept.open(whole.id, "local").result.duets[0].num_frames == 30
    with pytest.raises(InputError, match="run it again"):
        kept.open(lost.id, "local")
    server.wait_for(lambda: server.get("/healthz").status_code == 200)  # its networks work
    place = server.ask(40)
    with httpx.stream("GET", place, timeout=120) as stream:
        server.wait_for(lambda: b"pasdedeux_queue_running 1.0" in server.get("/metrics").content)
        server.process.send_signal(signal.SIGTERM)
        lines = list(stream.iter_lines())
    assert [line for line in lines if line.startswith("event: ")][-1] == "event: complete"
    assert answer_of("\n".join(lines))["manifest"]["request"]["steps"] == 40
    said = server.process.communicate(timeout=60)[0]
    assert server.process.returncode in (0, -signal.SIGTERM)
    assert "OUTSIDE" not in said and "Traceback" not in said
    assert states(data) == ["done", "interrupted", "done"]
