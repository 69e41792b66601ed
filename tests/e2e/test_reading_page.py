"""What is understood of a prompt is shown under it as it is typed."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from playwright.sync_api import Page, expect

from .serving import SLOW, live

pytestmark = pytest.mark.e2e

HOSTILE = "A bows while B waves <img src=x onerror=alert(1)>."


@pytest.fixture
def page(lab: str, open_page: Callable[..., Page]) -> Page:
    """The page that ``python app.py`` serves, on a phone, once it answers."""
    return live(open_page(lab, width=390, height=844))


def test_words_are_underlined_and_chips_stand_on_two_lanes(page: Page) -> None:
    prompt, reading = page.locator("#prompt textarea"), page.locator("#reading .pdr")
    expect(reading).to_be_hidden()
    prompt.press_sequentially("A bows to B. Then they hug.", delay=20)
    expect(reading.locator(".pdr-beat")).to_have_count(2, timeout=SLOW)
    lanes = {
        chip.get_attribute("data-id"): chip.evaluate("chip => getComputedStyle(chip).gridColumnStart")
        for chip in reading.locator(".pdr-chip").all()
    }
    assert lanes == {"1": "1", "2": "1"}
    expect(reading.locator(".pdr-chip").nth(1)).to_have_class("pdr-chip pdr-ab")
    expect(reading.locator(".pdr-words.pdr-a.pdr-b")).to_contain_text("they hug")
    lines = "each => [getComputedStyle(each).textDecorationStyle, getComputedStyle(each).borderBottomStyle]"
    assert reading.locator(".pdr-words").last.evaluate(lines) == ["solid", "dashed"], (
        "people are told apart by their lines, not by colour alone"
    )
    prompt.fill(HOSTILE)
    expect(reading.locator(".pdr-chip.pdr-b")).to_contain_text("waves", timeout=SLOW)
    expect(reading.locator(".pdr-said")).to_have_text(HOSTILE)
    assert reading.locator("img").count() == 0
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
    prompt.fill("")
    expect(reading).to_be_hidden()


def test_a_story_is_read_as_well(page: Page) -> None:
    page.get_by_role("tab", name="Scene").click()
    page.fill("#scene-prompt textarea", "They wave. Then they hug.")
    expect(page.locator("#scene-reading .pdr-chip")).to_have_count(2, timeout=SLOW)
