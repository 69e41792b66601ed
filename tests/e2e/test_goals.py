"""What a newcomer meets before reading anything: how much is in sight, where a result's actions are, what is loaded."""

from __future__ import annotations

import time
from collections.abc import Callable

import pytest
from playwright.sync_api import Page

from .serving import live

pytestmark = [pytest.mark.e2e, pytest.mark.slow]

BUTTONS = """() => [...document.querySelectorAll("button, summary, [role=button]")]
    .filter((each) => each.checkVisibility({ checkOpacity: true, checkVisibilityCSS: true }) && each.offsetHeight > 1)
    .map((each) => each.ariaLabel || each.textContent.trim())"""
COLUMN = """async () => {
    for (const fold of document.querySelectorAll(".pd-lab .label-wrap:not(.open)")) fold.click();
    await new Promise((done) => setTimeout(done, 500));
    const [asked, settings] = [".pd-ask", ".pd-controls"].map((each) => document.querySelector(each));
    return settings.getBoundingClientRect().bottom - asked.getBoundingClientRect().top;
}"""
ACTIONS = """() => [...document.querySelectorAll(".pd-actions > *")]
    .map((each) => each.getBoundingClientRect()).filter(({ height }) => height > 0)
    .map(({ top, bottom }) => [top, bottom])"""

BEGAN = """addEventListener("DOMContentLoaded", () => (window.began = document.querySelector(".pdd-early .pdd")));
    (function look() { window.__pasdedeux?.frame > 0 ? (window.moved = Date.now()) : setTimeout(look, 10); })();"""


def opened(lab: str, open_page: Callable[..., Page], width: int, height: int) -> tuple[Page, list[float], float]:
    """A page of a browser that has seen none, once its example plays, the bytes of each answer, and the seconds."""
    sizes: list[float] = []

    def listen(tab: Page) -> None:
        tab.add_init_script(BEGAN)
        session = tab.context.new_cdp_session(tab)
        session.send("Network.enable")
        session.on("Network.loadingFinished", lambda event: sizes.append(event["encodedDataLength"]))

    began = time.time()
    page = open_page(lab, width=width, height=height, before=listen, color_scheme="light")
    page.wait_for_function("window.moved", timeout=120_000)
    return page, sizes, page.evaluate("moved") / 1000 - began  # the answer waits until Gradio's page is built


@pytest.mark.parametrize(("width", "height"), [(1440, 900), (390, 844)])
def test_little_is_in_sight_and_the_actions_on_a_result_are(
    lab: str, open_page: Callable[..., Page], width: int, height: int
) -> None:
    page, sizes, seconds = opened(lab, open_page, width, height)
    loaded = sum(sizes)
    asked = page.evaluate("performance.getEntriesByType('resource').map(({ name }) => name.split('/').at(-1))")
    assert "plotly-gl3d.min.js" in asked
    assert not {"scene.js", "main.js", "texts.js"}.intersection(asked), (
        "the document brings the scripts that it begins with"
    )
    page.wait_for_selector("#player .pdd")
    assert page.evaluate("began === document.querySelector('#player .pdd') && __pasdedeux.count === 1"), (
        "it plays first"
    )
    plain = page.evaluate("Object.getPrototypeOf(window.gradio_config.dependencies[0]) === Object.prototype")
    assert not plain, "Svelte would watch each event's parts"
    live(page)
    buttons = page.evaluate(BUTTONS)
    column = page.evaluate(COLUMN)
    page.fill("#prompt textarea", "A walks up to B and taps B on the shoulder.")
    page.click("#generate")
    page.wait_for_selector("#status .pd-done", timeout=120_000)
    page.evaluate("scrollTo(0, 0)")
    shown = page.evaluate(ACTIONS)
    print(f"{width} px: {len(buttons)} buttons, {loaded / 1e6:.2f} MB, playing after {seconds:.1f} s, {column:.0f} px")
    assert len(buttons) <= 16, buttons
    assert loaded <= 1.3e6
    assert len(shown) >= 5 and all(top >= 0 and bottom <= height for top, bottom in shown)
    assert width < 961 or column <= 1400
