"""A real headless Chromium and a server beside it, for the tests that look at pages.

Without a browser these tests are skipped; with ``PASDEDEUX_REQUIRE_BROWSER=1`` they fail instead, so that
a machine that is meant to have one cannot lose them quietly.
"""

from __future__ import annotations

import os
import shutil
import socket
import subprocess
import sys
import time
import urllib.request
from collections.abc import Callable, Iterator
from pathlib import Path
from urllib.parse import urlsplit

import pytest

from .playing import press

REPOSITORY = Path(__file__).resolve().parents[2]
LOOPBACK = {"127.0.0.1", "localhost", "::1", ""}
FLAGS = [
    "--no-sandbox",
    "--disable-gpu",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
]


def _missing(reason: str) -> None:
    if os.environ.get("PASDEDEUX_REQUIRE_BROWSER") == "1":
        pytest.fail(reason)
    pytest.skip(reason)


def _chromium() -> str | None:
    for name in ("/usr/bin/chromium", "chromium", "chromium-browser", "google-chrome"):
        if found := shutil.which(name):
            return found
    return None


@pytest.fixture(scope="session")
def chromium():
    """A headless Chromium that draws WebGL on the processor."""
    try:
        from playwright import sync_api
    except ImportError:
        _missing("playwright is not installed: pip install playwright (the system's Chromium will do)")
    path = _chromium()
    if path is None:
        _missing("no Chromium on this machine: install the package chromium, or set PATH to find one")
    with sync_api.sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=path, args=FLAGS)
        yield browser
        browser.close()


@pytest.fixture
def watch_hosts() -> Iterator[Callable]:
    """``watch_hosts(page)`` records every request's host; the test fails on any but this machine."""
    foreign: list[str] = []

    def watch(page) -> None:
        def note(url: str) -> None:
            parts = urlsplit(url)
            if parts.scheme in ("http", "https", "ws", "wss") and (parts.hostname or "") not in LOOPBACK:
                foreign.append(url)

        page.on("request", lambda request: note(request.url))
        page.on("websocket", lambda websocket: note(websocket.url))

    yield watch
    assert not foreign, f"the page asked other hosts: {sorted(set(foreign))}"


@pytest.fixture(scope="session")
def _shared_context(chromium):
    """One profile for most pages, so that the browser's cache spares loading the page's scripts anew."""
    context = chromium.new_context()
    yield context
    context.close()


@pytest.fixture
def open_page(chromium, _shared_context, watch_hosts) -> Iterator[Callable]:
    """``open_page(url, width=…, height=…)`` gives a watched page; errors of scripts and of policy fail the test.

    ``before(page)`` runs before the page loads; other options make a browser profile of its own.
    """
    opened = []
    errors: list[str] = []

    def open_(url: str, *, width: int = 1280, height: int = 800, before: Callable | None = None, **options):
        context = chromium.new_context(**options) if options else _shared_context
        page = context.new_page()
        page.set_viewport_size({"width": width, "height": height})
        opened.append(context if options else page)
        watch_hosts(page)
        page.on("pageerror", lambda error: errors.append(str(error)))
        page.on("console", lambda said: _note_policy(said.text, errors))
        if before:
            before(page)
        page.goto(url)
        return page

    yield open_
    for context_or_page in opened:
        context_or_page.close()
    assert not errors, f"errors in the page: {errors}"


def _note_policy(said: str, errors: list[str]) -> None:
    """A page that needs more than the server's content security policy allows says so on the console."""
    if "Content Security Policy" in said:
        errors.append(said)


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


@pytest.fixture(scope="session")
def start_server() -> Iterator[Callable[..., str]]:
    """``start_server([script, args…, "{port}"])`` runs Python on them and gives the URL once it answers."""
    running: list[subprocess.Popen] = []

    def start(arguments: list[str], *, seconds: float = 180.0, env: dict[str, str] | None = None) -> str:
        port = free_port()
        command = [sys.executable, *(argument.format(port=port) for argument in arguments)]
        environment = {
            **os.environ,
            "GRADIO_ANALYTICS_ENABLED": "False",
            "OMP_NUM_THREADS": "1",
            **(env or {}),
        }
        server = subprocess.Popen(command, cwd=REPOSITORY, env=environment, stdout=subprocess.DEVNULL)
        running.append(server)
        url = f"http://127.0.0.1:{port}/"
        until = time.monotonic() + seconds
        while time.monotonic() < until:
            if server.poll() is not None:
                raise RuntimeError(f"{command} ended with {server.returncode} before it answered.")
            try:
                urllib.request.urlopen(url, timeout=2).close()
                return url
            except OSError:
                time.sleep(0.2)
        raise TimeoutError(f"{command} did not answer within {seconds:g} s.")

    yield start
    for server in running:
        server.terminate()
        server.wait(timeout=20)


@pytest.fixture(scope="session")
def player_url(start_server) -> str:
    return start_server(["tests/e2e/harness.py", "{port}"])


@pytest.fixture
def player(open_page, player_url):
    """``player(button)`` opens the page, presses one of the harness' buttons and waits for motion."""

    def open_(button: str | None = "load", *, theme: str = "light", **options):
        page = open_page(f"{player_url}?__theme={theme}", **options)
        page.wait_for_selector(".pdd-styled", timeout=90_000)
        page.wait_for_function("window.__pasdedeux.mode !== null", timeout=90_000)
        if button:
            press(page, button)
            page.wait_for_function("window.__pasdedeux.frame > 0", timeout=90_000)
        return page

    return open_
