"""The dialogs of the page: the search that Ctrl K opens, and the drawer of examples."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from types import SimpleNamespace

import pytest
from playwright.sync_api import Page, expect

from webdemo.ui.components.gallery import Gallery

from .playing import until
from .serving import live

pytestmark = pytest.mark.e2e

FIELD = "#finder dialog input"
OFFERED = "#finder datalist option"


def test_an_act_and_a_run_are_found_by_keyboard_and_an_example_by_one_press(
    server: SimpleNamespace, open_page: Callable[..., Page]
) -> None:
    page = live(open_page(server.url, width=1280, height=800))
    expect(page.locator("#finder .pdq-open")).to_be_enabled()
    page.locator("#way").get_by_text("A class").click()
    page.keyboard.press("Control+k")
    expect(page.locator(FIELD)).to_be_focused()
    until(page, f"document.querySelector('{OFFERED}')?.label.startsWith('Act: ')")
    page.keyboard.type("no such thing")
    page.keyboard.press("Enter")
    expect(page.locator("#finder dialog p")).to_have_text("Nothing matches.")
    page.locator(FIELD).fill("arm wrestl")
    page.keyboard.press("Enter")
    expect(page.locator("#finder dialog")).to_be_hidden()
    expect(page.locator("#prompt textarea, #prompt input")).to_have_value(re.compile("wrestl"))

    for _ in range(2):
        page.locator("button#generate").click()
        expect(page.locator("button#generate")).to_be_disabled()
        expect(page.locator("button#generate")).to_be_enabled()
    expect(page.locator("#status .pd-done")).to_be_visible()

    page.keyboard.press("Control+k")
    offered = f"[...document.querySelectorAll('{OFFERED}')]"
    until(page, f"{offered}.some(o => o.label.startsWith('Run: ') && /wrestl/i.test(o.value + o.label))")
    names = page.evaluate(f"{offered}.filter(o => o.label.startsWith('Run: ')).map(o => o.value)")
    assert len(names) > 1 and len({*names}) == len(names), "each run can be picked"
    page.keyboard.type("run wrestl")
    page.keyboard.press("Enter")
    page.wait_for_url("**/?run=*")
    live(page)
    until(page, "window.__pasdedeux?.player?.data?.id")

    page.get_by_role("button", name="All examples").click()
    scenes = page.locator("#gallery .pdx-scene")
    expect(scenes).to_have_count(24)
    kept = json.loads(Gallery.template.with_name("scenes.json").read_text(encoding="utf-8"))["scenes"][5]
    scenes.nth(5).click()
    expect(page.locator("#prompt textarea")).to_have_value(kept["prompt"])
    expect(page.locator("#player .pdd-title")).to_have_text(kept["prompt"])
    expect(page.locator("#status .pd-done")).to_contain_text("Made in")
    asked = server.engine.requests[-1]
    assert (asked.prompt, asked.seconds, asked.seed) == (kept["prompt"], kept["seconds"], kept["seed"])
    expect(page.locator("#gallery dialog")).to_be_hidden()
