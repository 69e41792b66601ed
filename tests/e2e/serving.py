"""The page with an engine that needs no networks, for the tests that look at it; see the fixture ``server``."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace

os.environ.setdefault("GRADIO_ANALYTICS_ENABLED", "False")

from playwright.sync_api import Page, expect

from tests.ui.stub_engine import StubEngine
from webdemo.ui.page import build_page, launch_options

SLOW = 60_000
"""Milliseconds that a busy machine may take to draw."""


@contextmanager
def stub_page(files: Path, *, pause: float) -> Iterator[SimpleNamespace]:
    """Serves the page while it is entered; yields its ``url`` and its ``engine``.

    Args:
        files: a folder for what runs write.
        pause: seconds that a step of the engine takes.
    """
    engine = StubEngine(pause=pause)
    page = build_page(engine, files=files)
    _, url, _ = page.launch(prevent_thread_lock=True, quiet=True, server_name="127.0.0.1", **launch_options())
    try:
        yield SimpleNamespace(url=url, engine=engine)
    finally:
        page.close()


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
