"""The tour of the tab Scene: told, made again, in parts, by keys, on the floor, and as text."""

from __future__ import annotations

import re

import pytest
from playwright.sync_api import Page

from .hands import cancelled, made, number, open_all, pressed, still, twice, visited
from .touring import Tour

pytestmark = [pytest.mark.e2e, pytest.mark.slow]


def cell(page: Page, lane: str, beat: int = 0) -> None:
    """Opens a cell of the line."""
    page.locator(f".pds-cell[data-beat='{beat}'][data-lane='{lane}']").click()


def short(page: Page, tour: Tour) -> None:
    """Makes every beat two seconds long in the story's text, and uses it."""
    box = page.locator("#scene-text textarea")
    text, beats = re.subn(r"(?m)^seconds = [\d.]+$", "seconds = 2", box.input_value())
    assert beats == 2
    box.fill(text)
    pressed(page, tour, "#scene-use-text", 1)


def spanned(page: Page) -> None:
    """Selects a part on the ruler."""
    page.locator(".pds-ruler").scroll_into_view_if_needed()
    ruler = page.locator(".pds-ruler").bounding_box()
    assert ruler
    page.mouse.move(ruler["x"] + 30, ruler["y"] + 10)
    page.mouse.down()
    page.mouse.move(ruler["x"] + 0.4 * ruler["width"], ruler["y"] + 10, steps=4)
    page.mouse.up()


def drawn(page: Page) -> None:
    """Draws a path on the map of the floor."""
    floor = page.locator(".pds-floor svg")
    floor.scroll_into_view_if_needed()
    box = floor.bounding_box()
    assert box
    ring = floor.locator("text").first.bounding_box()
    assert ring
    x, y = ring["x"] + ring["width"] / 2, ring["y"] + ring["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 0.1 * box["width"], y, steps=5)
    page.mouse.up()


def posed(page: Page) -> None:
    """Poses a hand by the keys."""
    page.evaluate("window.__pasdedeux.player.act('pause'); window.__pasdedeux.player.seek(30)")
    page.wait_for_function("window.__pasdedeux?.frame === 30")
    page.locator("#scene-player .pdd").focus()
    page.keyboard.press("e")
    page.locator(".pdd-handle").first.wait_for()
    page.locator(".pdd-handle[data-person='1'][data-joint='21']").focus()
    for _ in range(4):
        page.keyboard.press("ArrowUp")
    page.keyboard.press("Enter")


def told(page: Page, tour: Tour) -> None:
    """Writes a story of four seconds and makes it."""
    box = "document.querySelector('#scene-text textarea').value"
    page.fill("#scene-prompt textarea", "They meet. Then they bow.")
    page.locator("#scene-prompt textarea").blur()
    page.wait_for_function(f"{box}.includes('They meet') && {box}.includes('They bow')")
    number(page, "scene-steps", 4)
    twice(lambda: short(page, tour))
    made(page, tour, "scene-", times=1)


def test_a_story_is_told_and_its_parts_are_made_again(page: Page, tour: Tour) -> None:
    visited(page, "Scene")
    open_all(page)
    told(page, tour)
    page.fill("#scene-part-words textarea", "They bow.")
    for _ in range(2):
        pressed(page, tour, "button:has-text('Another way')", 1)
        spanned(page)
        pressed(page, tour, "#scene-remake", 1)
        pressed(page, tour, "#scene-futures", 1)
        still(page)
        pressed(page, tour, "#scene-take", 1)
        pressed(page, tour, "#scene-back", 1)
    number(page, "scene-steps", 100)
    for _ in range(2):
        cancelled(page, tour, "scene-")


def test_a_beat_is_written_on_and_directed(page: Page, tour: Tour) -> None:
    told(page, tour)
    page.fill("#scene-part-words textarea", "")
    for words in ('waves "hello"', "bows"):
        cell(page, "b")
        page.locator(".pds-words").fill(words)
        page.keyboard.press("Enter")
        tour.settle(page)
    made(page, tour, "scene-", times=1)
    for _ in range(2):
        posed(page)
        pressed(page, tour, "#scene-remake", 1)
    page.locator(".pds-pin").first.focus()
    page.keyboard.press("Delete")
    tour.settle(page)
    for _ in range(2):
        drawn(page)
        made(page, tour, "scene-", times=1)
        pressed(page, tour, "button:has-text('Delete the path')", 1)
