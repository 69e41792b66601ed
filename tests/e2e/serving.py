"""The application that ``python app.py`` serves, for tests that look at it; see the fixtures ``server`` and ``lab``."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace

from playwright.sync_api import Page, expect

from tests.ui.stub_engine import StubEngine
from webdemo.server.serve import make_server
from webdemo.server.settings import Settings

SLOW = 120_000
"""Milliseconds that a busy machine may take to draw."""
expect.set_options(timeout=SLOW)
OFTEN = 100_000
"""Requests a minute: tests press faster than people."""


@contextmanager
def stub_server(folder: Path, port: int) -> Iterator[SimpleNamespace]:
    """Serves the whole application with the stub engine while it is entered; yields its ``url`` and its ``engine``.

    Args:
        folder: for the history and all files.
        port: a free one.
    """
    engine = StubEngine()
    settings = Settings(data=folder, port=port, free_megabytes=0, rate=OFTEN, grace_seconds=1)
    server = make_server(settings, engine=engine, scratch=True)
    thread = threading.Thread(target=server.run, daemon=True)
    thread.start()
    while not server.started:
        assert thread.is_alive(), "the server did not start"
        time.sleep(0.02)
    try:
        yield SimpleNamespace(url=settings.url, engine=engine)
    finally:
        server.should_exit = True
        thread.join(timeout=60)


def live(page: Page, tab: str | None = None, *, slow: int = SLOW) -> Page:
    """The page once it answers, with one of its tabs in front.

    Args:
        page: that was opened.
        tab: the tab's label.
        slow: milliseconds that are waited for anything on this page.
    """
    page.set_default_timeout(slow)
    # The mark comes from the server when the page is live; before that a press would be lost.
    expect(page.locator("#model-state")).to_contain_text("Model ready", timeout=slow)
    if tab is not None:
        page.get_by_role("tab", name=tab).click()
        expect(page.locator(f"#{tab.lower()}-file")).to_be_visible(timeout=slow)
    return page


def ask(page: Page, prompt: str) -> None:
    """Gives the tab *Generate* a prompt and presses its button once it can be pressed."""
    page.fill("#prompt textarea", prompt)
    page.click("button#generate", timeout=SLOW)


def status(page: Page, tone: str) -> str:
    """The line that tells of a run, once it has a tone: "done", "warning", "error"."""
    line = page.locator(f"#status .pd-{tone}")
    expect(line).to_be_visible(timeout=SLOW)
    return line.inner_text()
