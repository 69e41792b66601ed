"""The page's layout on all sizes of screens, and what it needs to be for people who see, point or hear differently."""

from __future__ import annotations

import io
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import pytest
from PIL import Image
from playwright.sync_api import Page

from .playing import unfold
from .serving import SLOW, ask, live, status

pytestmark = pytest.mark.e2e


@pytest.fixture
def page(shared_page: Page) -> Page:
    return shared_page


def test_the_focus_is_visible(page: Page) -> None:
    page.focus("button#generate")
    page.keyboard.press("Tab")
    page.keyboard.press("Shift+Tab")
    assert page.evaluate("getComputedStyle(document.activeElement).outlineStyle") != "none"


def test_a_phone_has_the_player_high_and_no_sideways_scroll(server: SimpleNamespace, open_page: Callable) -> None:
    phone = live(open_page(server.url, width=390, height=844))
    ask(phone, "two people walk")
    status(phone, "done")
    assert phone.evaluate("document.documentElement.scrollWidth") <= 390
    top = {name: phone.locator(name).bounding_box()["y"] for name in ("#prompt", "#player", "#seconds")}
    assert top["#prompt"] < top["#player"] < top["#seconds"]
    play = phone.locator("#player .pdd-play").bounding_box()
    assert play["y"] + play["height"] <= 844, "what is asked, the motion and Play are in sight together"
    assert top["#player"] < 440  # under the actions on the result
    for tab, field in (("React", "#react-method"), ("Predict", "#predict-method")):
        live(phone, tab)
        if tab == "React":
            unfold(phone, "#react-advanced")
        phone.locator(f"{field} input").wait_for()
        room = phone.evaluate(_ROOM, [field, "InterGen, person to person"])
        assert room >= 0, f"{field} lacks {-room:g} pixels"
        assert phone.evaluate("document.documentElement.scrollWidth") <= 390


def test_a_dark_page_is_dark_before_its_scripts_run(server: SimpleNamespace, open_page: Callable) -> None:
    page = open_page(server.url, color_scheme="dark", java_script_enabled=False)
    assert Image.open(io.BytesIO(page.screenshot())).convert("RGB").getpixel((5, 5)) == (18, 22, 30)


def test_the_player_is_under_ten_tabs_from_the_prompt(page: Page) -> None:
    page.focus("#prompt textarea")
    for _ in range(9):
        page.keyboard.press("Tab")
        if page.evaluate("Boolean(document.activeElement.closest('.pdd'))"):
            return
    raise AssertionError("The settings come first.")


def test_the_button_and_the_whole_stage_are_in_view_together_on_a_small_laptop(page: Page) -> None:
    """It comes before the tests that make a motion on this page: there are more buttons then."""
    page.set_viewport_size({"width": 1024, "height": 700})
    for tab in ("Generate", "React", "Predict"):
        page.get_by_role("tab", name=tab).click()
        prefix = "" if tab == "Generate" else f"{tab.lower()}-"
        page.locator(f"#{prefix}player .pdd-stage").wait_for()
        for part in (f"button#{prefix}generate", f"#{prefix}player .pdd"):
            box = page.locator(part).bounding_box()
            assert box and box["y"] >= 0 and box["y"] + box["height"] <= 700, part
        assert page.evaluate("[...document.querySelectorAll('.pdd')].every((e) => !((e.scrollLeft = 9), e.scrollLeft))")
        player = page.locator(f"#{prefix}player .pdd").bounding_box()
        assert player and player["width"] > 600 and player["height"] > 600


@pytest.mark.parametrize("width", [390, 1440])
def test_what_is_pressed_is_24_pixels_high_and_wide_and_nothing_scrolls_by_a_little(page: Page, width: int) -> None:
    page.set_viewport_size({"width": width, "height": 900})
    page.get_by_role("tab", name="Generate").click()
    ask(page, "two people shake hands")
    status(page, "done")
    page.click("#share")
    page.locator("#address button").wait_for()  # which copies it
    small = page.evaluate(_SMALL)
    for tab in ("Scene", "React", "Predict", "History"):
        page.get_by_role("tab", name=tab, exact=True).click()
        if tab == "History":  # whose style sheet comes with it
            page.wait_for_function("getComputedStyle(document.querySelector('.pdn-bar')).display === 'flex'")
            page.wait_for_selector(".pdn-card")
        small += page.evaluate(_SMALL)
        assert page.evaluate(_SCROLLS) == [], tab
    assert not small, small


_SMALL = """() => [...document.querySelectorAll("button, summary, input[type=range], input[type=checkbox], select")]
    .filter((each) => each.checkVisibility({ checkOpacity: true }) && !each.matches(".pdd-tick"))
    .map((each) => [each, (each.closest("label, .pdn-pick") ?? each).getBoundingClientRect()])
    .filter(([, { width, height }]) => width > 1 && height > 1 && (width < 23.5 || height < 23.5))
    .map(([each]) => each.outerHTML.slice(0, 120))"""
"""What is smaller: not Gradio's copies of its tabs' buttons, a pixel high, nor touches that lie close together."""
_SCROLLS = """() => [...document.querySelectorAll("main *")].filter((each) => each.checkVisibility()
    && ["auto", "scroll"].includes(getComputedStyle(each).overflowX)
    && each.scrollWidth > each.clientWidth && each.scrollWidth < each.clientWidth + 12).map((each) => each.outerHTML)"""
"""What has a scroll bar, where the system shows them, for a few pixels that stick out."""
_ROOM = """([field, text]) => {
    const input = document.querySelector(`${field} input`);
    const pen = document.createElement("canvas").getContext("2d");
    pen.font = getComputedStyle(input).font;
    const arrow = document.querySelector(`${field} .icon-wrap`).getBoundingClientRect();
    return arrow.left - input.getBoundingClientRect().left - pen.measureText(text).width;
}"""
"""Pixels between a text in a list's field and the field's arrow."""


def test_axe_finds_nothing_against_wcag_aa_and_reduced_motion_keeps_the_example_still(
    server: SimpleNamespace, open_page: Callable[..., Page]
) -> None:
    axe = pytest.importorskip("axe_playwright_python.sync_playwright").Axe()
    page = live(open_page(server.url, before=lambda tab: tab.emulate_media(reduced_motion="reduce")))
    page.wait_for_function("window.__pasdedeux?.player?.data", timeout=SLOW)
    assert not page.evaluate("window.__pasdedeux.player.clock.playing")
    page.add_style_tag(content="*, ::before, ::after { transition: none !important; animation: none !important; }")
    found = against_wcag(axe, page, "idle")
    ask(page, "Two people walk home.")
    status(page, "done")
    unfold(page, "#downloads")
    found += against_wcag(axe, page, "result")
    for tab in ("Scene", "React", "Predict", "History"):
        page.get_by_role("tab", name=tab, exact=True).click()
        found += against_wcag(axe, page, tab)
    assert found == []


def against_wcag(axe: Any, page: Page, where: str) -> list[str]:
    """What axe finds against WCAG 2.1 AA; of a result also in the dark theme."""
    found = []
    rules = {"runOnly": {"type": "tag", "values": ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa"]}}
    for dark in (False, True) if where == "result" else (False,):
        page.evaluate("dark => document.body.classList.toggle('dark', dark)", dark)
        for broken in axe.run(page, options=rules).response["violations"]:
            found += [f"{where}: {broken['help']}: {node['html'][:120]}" for node in broken["nodes"]]
    page.evaluate("document.body.classList.remove('dark')")
    return found
