"""A server in a process of its own: stopped, killed, and watched for what it asks of other hosts."""

from __future__ import annotations

import json
import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest

from webdemo.motion import InputError
from webdemo.server.database import Database
from webdemo.server.history import History

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
    """The stub's server on a free port."""

    def __init__(self, data: Path, pause: float, **settings: str) -> None:
        with socket.socket() as probe:
            probe.bind(("127.0.0.1", 0))
            port = probe.getsockname()[1]
        self.url, self.data = f"http://127.0.0.1:{port}", data
        env = os.environ | {
            "STUB_PAUSE": str(pause), "PASDEDEUX_NODE": "tested", "PASDEDEUX_GRACE_SECONDS": "60",
            "PASDEDEUX_FREE_MEGABYTES": "0", "OMP_NUM_THREADS": "1",
        } | settings  # fmt: skip
        script = str(ROOT / "tests" / "server" / "lab.py")
        self.process = subprocess.Popen(
            [sys.executable, "-c", WATCH, script, str(port), str(data)], cwd=ROOT, env=env,
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
        )  # fmt: skip
        until = time.monotonic() + 120
        while time.monotonic() < until:
            assert self.process.poll() is None, self.process.communicate()[0]
            try:
                httpx.get(f"{self.url}/healthz", timeout=5)
                return
            except httpx.TransportError:
                time.sleep(0.1)
        raise TimeoutError("The server did not answer.")

    def ask(self, steps: int, visitor: str = "") -> str:
        """Begins a run; returns where its result will come."""
        data = ["Two people walk.", 1, 3, 1, 3, steps, 0, "ddim"]
        cookie = {"cookie": f"pasdedeux_visitor={visitor}"} if visitor else {}
        asked = httpx.post(f"{self.url}{CALL}", json={"data": data}, headers=cookie, timeout=60)
        return f"{self.url}{CALL}/{asked.json()['event_id']}"

    def history(self) -> History:
        return History(
            Database(f"sqlite:///{self.data / 'history.db'}"), self.data / "motions", node="tested"
        )

    def wait_for_state(self, state: str) -> None:
        until = time.monotonic() + 60
        while not any(entry.state == state for entry in self.history().entries("local")):
            assert time.monotonic() < until
            time.sleep(0.1)


@pytest.fixture
def start(tmp_path: Path) -> Iterator[Any]:
    running: list[Process] = []

    def start_(pause: float, **settings: str) -> Process:
        running.append(Process(tmp_path / "data", pause, **settings))
        return running[-1]

    yield start_
    for server in running:
        server.process.kill()
        server.process.wait()


def test_killed_while_it_works(start: Any) -> None:
    server = start(0.0)
    done = httpx.get(server.ask(1), timeout=60).text
    assert "event: complete" in done
    server.process.kill()
    server.process.wait()
    slow = start(0.5)
    slow.ask(200)
    slow.wait_for_state("running")
    slow.process.send_signal(signal.SIGKILL)
    slow.process.wait()
    history = slow.history()
    assert history.recover() == 1
    lost, whole = history.entries("local")
    assert (lost.state, whole.state) == ("interrupted", "done")
    assert history.open(whole.id, "local").result.duets[0].num_frames == 30
    with pytest.raises(InputError, match="run it again"):
        history.open(lost.id, "local")
    assert [path.name for path in history.folder.iterdir()] == [whole.id]


def test_told_to_stop_it_ends_what_runs_and_asked_nobody_outside(start: Any) -> None:
    server = start(0.1)
    place = server.ask(20)
    server.wait_for_state("running")
    with httpx.stream("GET", place, timeout=60) as stream:
        server.process.send_signal(signal.SIGTERM)
        lines = list(stream.iter_lines())
    ends = [line for line in lines if line.startswith("event: ")][-1]
    assert ends == "event: complete"
    answer = json.loads(
        next(line for line in reversed(lines) if line.startswith("data: ")).removeprefix("data: ")
    )
    assert answer[0]["manifest"]["request"]["steps"] == 20
    said = server.process.communicate(timeout=60)[0]
    assert server.process.returncode in (0, -signal.SIGTERM)
    assert "OUTSIDE" not in said and "Traceback" not in said
    assert [entry.state for entry in server.history().entries("local")] == ["done"]


def test_a_person_has_one_share_at_two_processes(start: Any) -> None:
    few = {"PASDEDEUX_RUNNING": "1", "PASDEDEUX_WAITING": "1"}  # two runs at a time
    one, two = (start(0.5, PASDEDEUX_NODE=node, **few) for node in ("one", "two"))
    ada, eve = "a" * 32, "e" * 32
    one.ask(200, ada)
    two.ask(200, ada)
    history = one.history()
    until = time.monotonic() + 60

    def wait_for_running(count: int) -> None:
        while sum(entry.state == "running" for entry in history.entries("local")) != count:
            assert time.monotonic() < until
            time.sleep(0.1)

    wait_for_running(2)
    for server in (one, two):
        said = httpx.get(server.ask(1, ada), timeout=60).text
        assert "event: error" in said and "You have 2 runs waiting or running already" in said
    two.ask(200, eve)  # somebody else's is let in, and waits
    wait_for_running(3)
