"""The dialogs of the page: the search that Ctrl K opens, and the drawer of examples."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from types import SimpleNamespace

import pytest
from playwright.sync_api import Page, Route, expect

from webdemo.ui.components.gallery import SCENES

from .playing import until
from .serving import SLOW, live

pytestmark = pytest.mark.e2e

FIELD = "#finder dialog input"
PLAYING = "document.querySelector('#player .pdd').dataset.state === 'ready'"
FIRST = "#finder [aria-selected=true]"


def test_an_act_a_control_and_a_run_are_found_by_keyboard_alone(
    server: SimpleNamespace, open_page: Callable[..., Page]
) -> None:
    page = live(open_page(server.url, width=1280, height=800))
    page.keyboard.press("Control+k")
    expect(page.locator(FIELD)).to_be_focused()
    page.keyboard.type("arm wrestl")
    expect(page.locator(FIRST)).to_contain_text("Act", timeout=SLOW)
    page.keyboard.press("Enter")
    expect(page.locator("#finder dialog")).to_be_hidden()
    expect(page.locator("#prompt textarea, #prompt input")).to_have_value(re.compile("wrestl"))

    page.locator("button#generate").click()
    expect(page.locator("#status .pd-done")).to_be_visible(timeout=SLOW)

    page.keyboard.press("Control+k")
    page.keyboard.type("samples scene")
    expect(page.locator(FIRST)).to_contain_text("Samples")
    page.keyboard.press("Enter")
    expect(page.get_by_role("tab", name="Scene")).to_have_attribute("aria-selected", "true", timeout=SLOW)
    until(page, "document.activeElement.closest('#scene-samples') !== null")

    page.keyboard.press("Control+k")
    page.keyboard.type("run wrestl")
    expect(page.locator(FIRST)).to_contain_text("Run", timeout=SLOW)
    page.keyboard.press("Enter")
    page.wait_for_url("**/?run=*")
    live(page)
    until(page, "window.__pasdedeux?.id")


def test_the_dialog_closes_again_and_says_when_nothing_is_found(
    server: SimpleNamespace, open_page: Callable[..., Page]
) -> None:
    page = live(open_page(server.url, width=1280, height=800))
    page.locator("#finder button").click()
    page.keyboard.type("qqqq")
    expect(page.locator("#finder [role=listbox]")).to_have_text("Nothing has these words.")
    page.keyboard.press("Escape")
    expect(page.locator("#finder dialog")).to_be_hidden()
    page.keyboard.press("Control+k")
    expect(page.locator(FIELD)).to_have_value("")
    until(page, PLAYING)
    page.keyboard.type("film look")
    expect(page.locator(FIRST)).to_contain_text("Film look (C)")
    page.keyboard.press("Enter")
    expect(page.locator("#player [data-act=film]")).to_be_focused()
    page.keyboard.press("Control+k")
    page.keyboard.type("hist")
    expect(page.locator(FIRST)).to_contain_text("History")
    page.keyboard.press("Enter")
    expect(page.get_by_role("tab", name="History")).to_have_attribute("aria-selected", "true", timeout=SLOW)


def test_the_switches_of_a_player_that_comes_late_are_found(
    server: SimpleNamespace, open_page: Callable[..., Page]
) -> None:
    """Whoever opens the search as soon as there is a page has it open before the player has loaded."""
    held: list[Route] = []
    page = open_page(
        server.url, before=lambda page: page.route("**/static/player/main.js", lambda route: held.append(route))
    )
    live(page)
    page.locator("#finder button").click()
    page.keyboard.type("film loo")
    expect(page.locator("#finder [role=listbox]")).to_have_text("Nothing has these words.")
    for route in held:
        route.continue_()
    until(page, PLAYING)
    page.keyboard.type("k")
    expect(page.locator(FIRST)).to_contain_text("Film look (C)")


def test_a_scene_of_the_drawer_of_examples_is_made_by_one_press(
    server: SimpleNamespace, open_page: Callable[..., Page]
) -> None:
    page = live(open_page(server.url, width=1280, height=800))
    page.get_by_role("button", name="All examples").click()
    scenes = page.locator("#gallery .pdx-scene")
    expect(scenes).to_have_count(24, timeout=SLOW)
    kept = json.loads(SCENES.read_text(encoding="utf-8"))["scenes"][5]
    scenes.nth(5).click()
    expect(page.locator("#prompt textarea")).to_have_value(kept["prompt"], timeout=SLOW)
    expect(page.locator("#status .pd-done")).to_be_visible(timeout=SLOW)
    asked = server.engine.requests[-1]
    assert (asked.prompt, asked.seconds, asked.seed) == (kept["prompt"], kept["seconds"], kept["seed"])
    expect(page.locator("#gallery dialog")).to_be_hidden()
