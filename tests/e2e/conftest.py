"""A real headless Chromium and a server beside it, for the tests that look at pages.

Without a browser these tests are skipped; with ``PASDEDEUX_REQUIRE_BROWSER=1`` they fail instead, so that
a machine that is meant to have one cannot lose them quietly.
"""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from types import SimpleNamespace
from urllib.parse import urlsplit

import pytest

from motion import InputError
from tests.server.lab import ROOT, free_port
from webdemo.benchmark import browser
from webdemo.benchmark.server import serving, wait_until

from .plain import serve
from .playing import press

LOOPBACK = {"127.0.0.1", "localhost", "::1", ""}
LEAVING = (  # what Gradio's script says of its open streams as a page is left
    "AbortError: signal is aborted",
    "AbortError: BodyStreamBuffer was aborted",
    "Unexpected error Connection errored out.",
)
CALM = """
const ask = window.requestAnimationFrame.bind(window), drop = window.cancelAnimationFrame.bind(window);
const asked = new Map();
window.requestAnimationFrame = (draw) => {
  const id = setTimeout(() => asked.set(id, ask((now) => { asked.delete(id); draw(now); })), 120);
  return id;
};
window.cancelAnimationFrame = (id) => { clearTimeout(id); if (asked.has(id)) drop(asked.get(id)); };
"""
"""Lets a page draw a few pictures a second: otherwise a motion that plays takes the processor from everything else."""
LONGEST = 900
"""Seconds that a test with a browser may take on a busy machine; a test without one has 300."""


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Gives the tests of this folder more time."""
    for item in items:
        if Path(__file__).parent in item.path.parents:
            item.add_marker(pytest.mark.timeout(LONGEST))


@pytest.fixture(scope="session")
def chromium():
    """A headless Chromium that draws WebGL on the processor."""
    try:
        with browser.chromium() as opened:
            yield opened
    except InputError as missing:
        if os.environ.get("PASDEDEUX_REQUIRE_BROWSER") == "1":
            raise
        pytest.skip(str(missing))


@pytest.fixture(scope="session")
def _shared_context(chromium):
    """One profile for most pages, so that the browser's cache spares loading the page's scripts anew."""
    context = chromium.new_context()
    yield context
    context.close()


class Tabs:
    """Watched tabs of the browser: refused requests, errors on the console, and requests to other hosts are noted."""

    def __init__(self, chromium, shared_context) -> None:
        self.chromium, self.shared_context = chromium, shared_context
        self.opened: list = []
        self.errors: list[str] = []
        self.foreign: list[str] = []

    def open(
        self,
        url: str,
        *,
        width: int = 1280,
        height: int = 800,
        before: Callable | None = None,
        lively: bool = False,
        **options,
    ):
        """A tab at an address.

        Args:
            url: the address.
            width, height: of the window in pixels.
            before: is called with the tab before it loads.
            lively: whether it draws as often as it can, for tests of what is drawn.
            options: make a browser profile of its own.
        """
        context = self.chromium.new_context(**options) if options else self.shared_context
        page = context.new_page()
        page.set_viewport_size({"width": width, "height": height})
        self.opened.append(context if options else page)
        self.watch(page)
        if not lively:
            page.add_init_script(CALM)
        if before:
            before(page)
        page.goto(url)
        return page

    def watch(self, page) -> None:
        """Notes what goes wrong in a tab."""
        page.on("request", lambda request: self._note_host(request.url))
        page.on("websocket", lambda websocket: self._note_host(websocket.url))
        page.on("pageerror", lambda error: self.errors.append(error.stack or str(error)))
        page.on("response", self._note_refusal)
        page.on("console", self._note_error)
        page.on("framenavigated", self._forget_leaving)

    def check(self, expected: Sequence[str] = ()) -> None:
        """Fails where something was noted since the last check, but for errors that contain what is expected."""
        errors = [error for error in self.errors if not any(said in error for said in expected)]
        foreign = sorted(set(self.foreign))
        self.errors.clear()
        self.foreign.clear()
        assert not errors, f"errors in the page: {errors}"
        assert not foreign, f"the page asked other hosts: {foreign}"

    def close(self) -> None:
        """Closes all tabs."""
        while self.opened:
            self.opened.pop().close()

    def _note_refusal(self, response) -> None:
        if response.status >= 400:
            self.errors.append(f"{response.status} from {urlsplit(response.url).path}")

    def _note_error(self, said) -> None:
        """A page that needs more than the server's content security policy allows says so on the console, too."""
        text = said.text
        if said.type != "error" or "Failed to load resource" in text or text.startswith("INFO:"):
            return  # a response, which is noted already, or MediaPipe's, which has no other way to speak
        self.errors.append(text)

    def _forget_leaving(self, frame) -> None:
        """Gradio's script tells of its open streams as errors when the page is left."""
        if frame.parent_frame is None:
            self.errors = [error for error in self.errors if not any(said in error for said in LEAVING)]

    def _note_host(self, url: str) -> None:
        parts = urlsplit(url)
        if parts.scheme in ("http", "https", "ws", "wss") and (parts.hostname or "") not in LOOPBACK:
            self.foreign.append(url)


@pytest.fixture
def expected_errors() -> list[str]:
    """Parts of the errors that a test provokes; it adds them."""
    return []


@pytest.fixture
def open_page(chromium, _shared_context, expected_errors: list[str]) -> Iterator[Callable]:
    """:meth:`Tabs.open`, for tabs that are closed after the test."""
    tabs = Tabs(chromium, _shared_context)
    yield tabs.open
    tabs.close()
    tabs.check(expected_errors)


@pytest.fixture(scope="module")
def kept_tabs(chromium, _shared_context) -> Iterator[Tabs]:
    """Tabs that the tests of a module share, since a page takes seconds to load and to draw for the first time."""
    tabs = Tabs(chromium, _shared_context)
    yield tabs
    tabs.close()


@pytest.fixture
def open_kept(kept_tabs: Tabs) -> Iterator[Callable]:
    """:meth:`Tabs.open`, for tabs that stay open until the module's tests are over."""
    yield kept_tabs.open
    kept_tabs.check()


@pytest.fixture
def shared_page(request: pytest.FixtureRequest, server: SimpleNamespace, open_kept, kept_tabs: Tabs) -> Iterator:
    """The application in a tab that the module's tests share: each finds the settings that the one before left.

    A test that fails leaves the next one a new tab.
    """
    from .serving import live

    failed = request.session.testsfailed
    if not kept_tabs.opened:
        live(open_kept(server.url))
    (page,) = kept_tabs.opened
    page.set_viewport_size({"width": 1280, "height": 800})
    yield page
    if request.session.testsfailed > failed:
        kept_tabs.close()


@pytest.fixture(scope="session")
def _stub_server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[SimpleNamespace]:
    from .serving import stub_server

    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("GRADIO_TEMP_DIR", str(tmp_path_factory.mktemp("uploads")))  # the server sets its own
        with stub_server(tmp_path_factory.mktemp("stub"), free_port()) as served:
            yield served


@pytest.fixture(scope="module")
def server(request: pytest.FixtureRequest, _stub_server: SimpleNamespace, _shared_context) -> SimpleNamespace:
    """The whole application with a stub engine, for tests that need a slow or failing one, or exact figures.

    Its ``url`` and its ``engine``; a step takes a module's ``PAUSE`` in seconds.
    """
    _stub_server.engine.pause = getattr(request.module, "PAUSE", 0.0)
    return _stub_server


@pytest.fixture(scope="session")
def lab(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """The address of what ``python app.py`` serves, with the shipped networks."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("OMP_NUM_THREADS", "1")
        with serving(tmp_path_factory.mktemp("app")) as (url, process):
            wait_until(url, "", process)
            yield url


@pytest.fixture(scope="session")
def player_url() -> Iterator[str]:
    """The player in a Gradio page with nothing else."""
    port = free_port()
    with subprocess.Popen(
        [sys.executable, "tests/e2e/harness.py", str(port)], cwd=ROOT, stdout=subprocess.DEVNULL
    ) as page:
        wait_until(url := f"http://127.0.0.1:{port}/", "", page)
        yield url
        page.terminate()


@pytest.fixture(scope="session")
def plain_url() -> Iterator[str]:
    """The player in a page without Gradio."""
    with serve() as url:
        yield url


@pytest.fixture
def player(open_kept, kept_tabs: Tabs, plain_url):
    """``player(button)`` makes a new player in the plain page, presses a button and waits for motion."""

    def open_(button: str | None = "load", *, theme: str = "light", width: int = 1280, height: int = 800):
        if not kept_tabs.opened:
            open_kept(plain_url, lively=True)
            _opened(kept_tabs.opened[0], None)
        (page,) = kept_tabs.opened
        page.set_viewport_size({"width": width, "height": height})
        page.evaluate("theme => window.restart(theme)", theme)
        return _opened(page, button)

    return open_


@pytest.fixture
def player_in_page(open_page, player_url):
    """The same as ``player`` in a Gradio page of its own."""

    def open_(button: str | None = "load", *, theme: str = "light", **options):
        return _opened(open_page(f"{player_url}?__theme={theme}", lively=True, **options), button)

    return open_


def _opened(page, button: str | None):
    page.wait_for_selector(".pdd-styled", timeout=90_000)
    page.wait_for_function("window.__pasdedeux?.player", timeout=90_000)
    if button:
        press(page, button)
        page.wait_for_function("window.__pasdedeux?.frame > 0", timeout=90_000)
    return page
