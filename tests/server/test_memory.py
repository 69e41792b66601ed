"""What a session weighs, and that freed memory goes back to the system."""

from __future__ import annotations

import ctypes
import gc
import json
import subprocess
import sys
import tracemalloc
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from fastapi.testclient import TestClient

from webdemo.server.http import page_html as sessions
from webdemo.server.http.page_html import LeanStates

from .clients import FIELDS, client_of, settings_for
from .lab import ROOT

CALL = "/gradio_api/call/generate"


@pytest.fixture
def client(tmp_path: Path) -> Iterator[TestClient]:
    with client_of(settings_for(tmp_path)) as client:
        yield client


def states_of(client: TestClient) -> LeanStates:
    found: list[Any] = [getattr(getattr(route, "app", None), "state_holder", None) for route in client.app.routes]  # type: ignore[attr-defined]
    (states,) = [states for states in found if states is not None]
    return states


def test_a_session_weighs_little(local: TestClient) -> None:
    """Gradio's own describes every component of the page, 0.35 MB."""
    states = states_of(local)
    _ = states["the first"]
    gc.collect()
    tracemalloc.start()
    try:
        for i in range(20):
            _ = states[f"page {i}"]
        gc.collect()
        weight = tracemalloc.get_traced_memory()[0] / 20
    finally:
        tracemalloc.stop()
    assert weight < 40_000


def test_calls_leave_nothing_and_pages_stay(client: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sessions, "CALLS", 3)
    states = states_of(client)
    _ = states["a page"]
    for _ in range(6):
        event = client.post(CALL, json={"data": FIELDS}).json()["event_id"]
        said = client.get(f"{CALL}/{event}").text
        assert "event: complete" in said
        assert json.loads(said.rsplit("data: ", 1)[1])[0]["manifest"]["request"]["seed"] == 0
    assert "a page" in states and event in states
    assert len(states.session_data) == 4 and len(states.time_last_used) == 4


def test_many_pages_of_one_address_take_no_state_of_others(tmp_path: Path) -> None:
    """In ten seconds a stranger's new sessions took from everybody what their page shows."""
    with client_of(settings_for(tmp_path, open=True)) as client:
        states = states_of(client)
        client.post(CALL, json={"data": FIELDS, "session_hash": "a page"})
        assert states.bindings.home("a page") == "127.0.0.1"
    states.capacity = 6
    for i, session in enumerate(["ada's", "bob's", *"abcdefgh"]):
        states.bindings.check(session, f"visitor {i}", "192.0.2.1" if i < 2 else "192.0.2.2", begin=True)
        _ = states[session]
    assert set(states.session_data) == {"a page", "ada's", "bob's", *"fgh"}


GAPS = """
import os, pathlib
from webdemo.server.process import give_back
def resident():
    pages = int(pathlib.Path("/proc/self/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 2**20
kept, blocks = [], []
for _ in range(2000):
    blocks.append(b"x" * 100_000)
    kept.append(bytes(1000))  # in use between what is freed
blocks.clear()
before = resident()
give_back()
print(before - resident())
"""


@pytest.mark.skipif(
    not sys.platform.startswith("linux") or not hasattr(ctypes.CDLL(None), "malloc_trim"),
    reason="another C library's heap",
)
def test_gaps_go_back_to_the_system() -> None:
    said = subprocess.run([sys.executable, "-c", GAPS], cwd=ROOT, capture_output=True, text=True, check=True)
    assert float(said.stdout) > 100  # megabytes
