"""Work that a page asks of the browser while nothing on it changes, counted in frames instead of timed."""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace

import pytest
from playwright.sync_api import Page, expect

from .serving import SLOW, live

pytestmark = pytest.mark.e2e

PAUSE = 0.2
WATCHED = 2000
"""Milliseconds; a screen draws 120 frames in them."""
COUNT = """
  const ask = window.requestAnimationFrame.bind(window);
  window.asked = 0;
  window.requestAnimationFrame = (draw) => ask((now) => { window.asked++; draw(now); });
"""


@pytest.fixture
def rested(server: SimpleNamespace, open_page: Callable[..., Page]) -> Page:
    """The page when its first motion is paused."""
    page = live(
        open_page(
            server.url, lively=True, before=lambda tab: tab.add_init_script(COUNT), reduced_motion="no-preference"
        )
    )
    page.wait_for_function("window.__pasdedeux?.player", timeout=SLOW)
    page.evaluate("window.__pasdedeux.player.act('pause')")
    page.wait_for_function("window.__pasdedeux?.loops === 0", timeout=SLOW)
    for _ in range(10):  # a still picture is drawn once more, finer, and Gradio's loading screen swings out
        if frames(page) == 0:
            return page
    raise AssertionError("The page never rests.")


def frames(page: Page) -> int:
    page.evaluate("window.asked = 0")
    page.wait_for_timeout(WATCHED)
    return page.evaluate("window.asked")


def test_a_page_left_alone_asks_for_no_frame_and_a_waiting_one_for_few(rested: Page) -> None:
    assert frames(rested) == 0
    rested.locator("#pace label", has_text="Faithful").click()  # the run lasts while frames are counted
    rested.fill("#prompt textarea", "Two people meet.")
    rested.click("button#generate", timeout=SLOW)
    expect(rested.locator("#status .pd-busy")).to_contain_text("step")
    rested.wait_for_timeout(500)
    assert frames(rested) < 20
    rested.click("button#cancel", timeout=SLOW)
    rested.evaluate("window.__pasdedeux.player.act('play')")
    assert frames(rested) > 10, "the count sees what is drawn"
