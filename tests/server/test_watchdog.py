"""A server that is stuck says so, and ends itself where a supervisor starts it again."""

from __future__ import annotations

import subprocess
import sys
import threading
from pathlib import Path

import pytest

from tests.server.attacks.target import Target
from tests.server.clients import FIELDS, client_of, settings_for, wait_for
from tests.server.lab import ROOT, stub_module
from tests.server.queue.people import make, request
from webdemo.server.http.health import Health
from webdemo.server.process import STUCK
from webdemo.server.store.database import DISK_FULL

WATCHED = """
import asyncio, re, sys, threading
from webdemo.server.process import watch

async def main(freezes):
    looks = []
    asyncio.create_task(watch(lambda: looks.append(1), silent_seconds=1 if freezes else 60, every=0.01))
    while len(looks) < 20:
        await asyncio.sleep(0.01)
    print("watched", flush=True)
    if freezes:  # a pattern that matches in endless ways keeps the interpreter's lock
        re.match("(a|a)*b", 60 * "a")

asyncio.run(main(sys.argv[1] == "freeze"))
"""


@pytest.mark.parametrize(("what", "code"), [("freeze", 1), ("go on", 0)])
def test_a_frozen_interpreter_is_ended_from_outside_of_it(what: str, code: int) -> None:
    ended = subprocess.run([sys.executable, "-c", WATCHED, what], cwd=ROOT, capture_output=True, text=True, timeout=300)
    assert ended.returncode == code, ended.stderr
    assert ended.stdout == "watched\n" and ("re/" in ended.stderr or "re.py" in ended.stderr) == bool(code)


def test_a_run_without_progress_ends_the_process(tmp_path: Path) -> None:
    with Target(tmp_path, accounts=True, stuck_seconds=4, exit_when_stuck=1) as target:
        data = ["They hang.", *FIELDS[1:]]
        assert target.ask("ada", "POST", "/gradio_api/call/generate", json={"data": data}).status_code == 200
        target.process.join(240)
        assert target.process.exitcode == STUCK
        assert "The queue has made no progress" in target.log() and "stub_engine.py" in target.log()


def test_what_is_stuck_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    gate, people = make(monkeypatch)
    assert people.queue.stuck == 0
    people.ask("a", request("a"))
    people.queue._running[0].moved -= 100
    assert 100 <= people.queue.stuck < 200
    people.ask("b", request("b"))
    gate.open.release()
    wait_for(lambda: "a" in people.ends and people.queue.running)
    assert people.queue.stuck < 90, "the next one runs"
    gate.open.release()
    people.end()
    assert people.queue.stuck == 0


def test_a_queue_whose_worker_is_gone_is_stuck(monkeypatch: pytest.MonkeyPatch) -> None:
    _, people = make(monkeypatch)
    monkeypatch.setattr(people.queue, "_work", lambda group: None)
    people.ask_only("a", request("a"))
    assert people.queue.stuck < 90
    people.queue._rested -= 100
    people.queue._waiting[0].came -= 100
    assert people.queue.stuck >= 100
    people.queue.cancel("session of a")
    people.end()


def test_health_says_what_is_stuck() -> None:
    still = {"queue": 5.0, "live stream": 0.0}
    works = {name: lambda name=name: still[name] for name in still}
    health = Health(stub_module().StubEngine(), works=works, stuck_seconds=10)
    health.probe()
    wait_for(lambda: health.ready)
    assert health.report()[0]
    still["live stream"] = 11.0
    well, report = health.report()
    assert not well and report["status"] == "failed"
    assert report["checks"]["progress"] == "failed: The live stream has made no progress for 11 s."


def test_nobody_who_asks_waits_for_a_look_and_one_that_never_ends_is_told() -> None:
    slow = threading.Event()
    health = Health(stub_module().StubEngine(), {"disk": lambda: slow.wait(60)})
    health.keep_looking()
    wait_for(lambda: health.ready)
    assert health.report() == (True, {"status": "ready", "checks": {"generation": "ok", "progress": "ok"}})
    health._found_at -= 100
    well, report = health.report()
    assert not well and "nothing was looked at for 100 s" in report["checks"]["looks"]
    health.stopping = True
    slow.set()


def test_a_health_check_that_never_ends_is_stuck() -> None:
    engine = stub_module().StubEngine(load=2.0)
    health = Health(engine, stuck_seconds=10)
    health.probe()
    assert health.stuck() == ""
    health._tried_at -= 100
    assert "The health check has made no progress" in health.stuck()


def test_health_knows_a_full_disk(tmp_path: Path) -> None:
    with client_of(settings_for(tmp_path, free_megabytes=1e9)) as client:
        wait_for(lambda: "disk" in client.get("/healthz").json()["checks"])
        answer = client.get("/healthz")
        assert answer.status_code == 503
        assert answer.json()["checks"]["disk"] == f"failed: {DISK_FULL}"
    with client_of(settings_for(tmp_path / "other")) as client:
        wait_for(lambda: client.get("/healthz").status_code == 200)
        (tmp_path / "other" / "data").rename(tmp_path / "gone")
        wait_for(lambda: client.get("/healthz").json()["checks"]["disk"].startswith("failed"))
