"""The words over the story line and its beats are one thing, and the floor shows where people stand."""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace

import pytest
from playwright.sync_api import Page, expect

from .serving import SLOW

pytestmark = pytest.mark.e2e


def test_words_and_beats_follow_each_other(server: SimpleNamespace, open_page: Callable[..., Page]) -> None:
    page = open_page(server.url, width=1280, height=1500)
    page.set_default_timeout(SLOW)
    page.get_by_role("tab", name="Scene").click()
    words = page.locator("#scene-prompt textarea")
    words.fill("They bow. Then they hug.")
    page.click("button#scene-generate")
    expect(page.locator("#scene-status .pd-done")).to_be_visible(timeout=SLOW)
    expect(words).to_have_value("They bow. Then they hug.")
    cells = page.locator(".pds-lane-words .pds-cell")
    cells.nth(1).click()
    page.locator(".pds-words").fill("They wave.")
    page.keyboard.press("Enter")
    expect(words).to_have_value("They bow. They wave.")
    words.click()
    page.keyboard.press("End")
    page.keyboard.type(" They nod.")
    page.wait_for_function("!document.querySelector('.pds').editor.story.ahead")
    page.locator("#scene-text, #scene-advanced button").first.focus()
    expect(cells).to_have_text(["They bow.", "They wave.", "They nod."])
    # Both people of the motion are on the floor, where they stand when the selected beat begins.
    page.locator(".pds-floor summary").click()
    assert page.locator(".pds-track text").all_text_contents() == ["A", "B"]
    shown = page.locator(".pds-track circle").first.get_attribute("cy")
    cells.nth(0).click()
    page.keyboard.press("Escape")
    assert page.locator(".pds-track circle").first.get_attribute("cy") != shown
