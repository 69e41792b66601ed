"""A touch that is said by pressing a part of a body on the stage."""

from __future__ import annotations

import pytest
from playwright.sync_api import Page, expect

from .playing import until

pytestmark = pytest.mark.e2e

TOOL, DOTS = "#player [data-act=touch]", "#player .pdd-handle-touch"


@pytest.fixture
def touching(shared_page: Page) -> Page:
    """The tab Generate with the tool taken up over a motion that stands still, and one sentence in the prompt."""
    page = shared_page
    until(page, "window.__pasdedeux.player?.director?.say && window.__pasdedeux.frame !== null")
    page.keyboard.press("Escape")
    page.fill("#prompt textarea", "A bows")
    page.evaluate(
        """() => { const { player } = window.__pasdedeux;
        player.directing.endTouching(); player.clock.seek(0); player.refresh(); }"""
    )
    page.click(TOOL)
    until(page, f"document.querySelector('{DOTS}')?.style.transform && window.__pasdedeux.loops === 0")
    return page


def test_a_part_that_is_pressed_is_touched_in_the_prompt(touching: Page) -> None:
    page, prompt = touching, touching.locator("#prompt textarea")
    expect(page.locator(DOTS)).to_have_count(24)
    dot = page.locator(f"{DOTS}[data-person='1'][data-part=head]")
    expect(dot).to_have_attribute("title", "Person A touches person B's head.")
    dot.evaluate("dot => dot.click()")  # a dot of the other person may lie over it
    expect(prompt).to_have_value("A bows. Person A touches person B's head.")
    expect(page.locator(DOTS)).to_have_count(0)
    expect(page.locator("#reading .pdr-chip")).to_have_count(2)
    prompt.press("Control+z")
    expect(prompt).to_have_value("A bows")


def test_the_dots_are_reached_by_keys_and_leave_with_escape(touching: Page) -> None:
    page = touching
    expect(page.locator(f"{DOTS}:focus")).to_have_count(1)
    page.keyboard.press("Enter")
    expect(page.locator("#prompt textarea")).to_have_value("A bows. Person B touches person A's head.")
    page.click(TOOL)
    expect(page.locator(DOTS)).to_have_count(24)
    expect(page.locator(TOOL)).to_have_attribute("aria-pressed", "true")
    page.keyboard.press("Escape")
    expect(page.locator(DOTS)).to_have_count(0)
    expect(page.locator(TOOL)).to_have_attribute("aria-pressed", "false")


def test_drawing_and_pressing_a_part_take_turns(touching: Page) -> None:
    page = touching
    page.click("#player [data-act=draw]")
    expect(page.locator(DOTS)).to_have_count(0)
    expect(page.locator("#player .pdd-grip")).to_have_count(4)
    page.click(TOOL)
    expect(page.locator("#player .pdd-grip")).to_have_count(0)
    expect(page.locator(DOTS)).to_have_count(24)
    page.keyboard.press("Escape")
