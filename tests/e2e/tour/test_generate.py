"""The tour of the tab Generate."""

from __future__ import annotations

from pathlib import Path

import pytest
from playwright.sync_api import Page

from ..playing import choose
from .hands import all_used, cancelled, chips, made, number, open_all, pressed, twice, with_result
from .touring import Tour

pytestmark = [pytest.mark.e2e, pytest.mark.slow]

EXCUSED_HERE = ("^Generate / reading / ",)
"""Chips are named after what was measured, which changes with each result; test_reading_page uses them."""


def touched(page: Page, tour: Tour) -> None:
    """Takes up the hand of the stage and presses the first dot."""
    page.click("#player [data-act=touch]")
    page.keyboard.press("Enter")
    tour.settle(page)


def test_generate(page: Page, tour: Tour, character: Path) -> None:
    open_all(page)
    page.fill("#prompt textarea", "They bow.")
    number(page, "seconds", 2)
    made(page, tour)
    twice(lambda: touched(page, tour))
    page.fill("#prompt textarea", "They bow.")
    number(page, "seconds", 10)
    number(page, "samples", 4)
    number(page, "steps", 100)
    twice(lambda: cancelled(page, tour))
    number(page, "seconds", 2)
    number(page, "samples", 1)
    for pace in ("Faithful", "Fast"):
        page.locator("#pace label", has_text=pace).click()
        made(page, tour, times=1)
    page.locator("#way").get_by_text("A class").click()
    for name in ("bow", "hug"):
        page.locator("#class input").click()
        page.keyboard.type(name)
        page.keyboard.press("Enter")
        made(page, tour, times=1)
    page.locator("#way").get_by_text("A sentence").click()
    number(page, "seconds", 2)
    page.fill("#prompt textarea", "They hug.")
    chips(page, tour, "Plain beside damped", "Four seeds", "Sentence beside class")
    choose(page, "#grid-across", "Seeds")
    page.fill("#grid-across-values textarea", "1-2")
    pressed(page, tour, "#grid-make")
    made(page, tour)
    with_result(page, tour, "", character)
    all_used(page, tour, "Generate", *EXCUSED_HERE)
