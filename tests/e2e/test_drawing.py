"""Paths that are drawn on the stage's floor: seen, measured, sent with the next run and taken away."""

from __future__ import annotations

import re
from typing import Any

import pytest
from playwright.sync_api import Page, expect

from webdemo.inference.requests import GenerateRequest

from .playing import until
from .serving import SLOW, ask, status

pytestmark = pytest.mark.e2e

TOOL = "#player [data-act=draw]"


@pytest.fixture
def drawing(shared_page: Page) -> Page:
    """The tab Generate at the first frame of its motion, seen from above, with the tool taken up and no path."""
    page = shared_page
    until(page, "window.__pasdedeux.player?.directing.drawing && window.__pasdedeux.frame !== null")
    if page.locator("#player .pdd[data-first]").count():  # the tool comes with the first result
        ask(page, "two people walk")
        status(page, "done")
        expect(page.locator("button#generate")).to_be_enabled()
    page.keyboard.press("Escape")
    page.evaluate(
        """() => { const { player } = window.__pasdedeux;
        player.clock.pause(); player.clock.seek(0); player.orbit.elevation = 1.2;
        player.directing.director.open([]); player.directing.drawing.toggle(false); player.refresh(); }"""
    )
    page.click(TOOL)
    until(page, "document.querySelector('#player .pdd-grip')?.style.transform && window.__pasdedeux.loops === 0")
    return page


def drag(page: Page, person: str, *by: tuple[float, float]) -> None:
    """Drags a person's handle with the mouse, by pixels on each way."""
    grip = page.locator(f"#player .pdd-grip[data-person={person}]")
    box, before = grip.bounding_box(), None
    while box != before:  # the page may still be laid out
        page.wait_for_timeout(150)
        box, before = grip.bounding_box(), box
    assert box is not None
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    for dx, dy in by:
        x, y = x + dx, y + dy
        page.mouse.move(x, y, steps=12)
    page.mouse.up()


def paths(page: Page) -> list[dict[str, Any]]:
    return page.evaluate("window.__pasdedeux.player.directing.director.paths")


def chips(page: Page) -> Any:
    return page.locator("#reading .pdr-paths li")


def generated(page: Page, server: Any, prompt: str) -> GenerateRequest:
    """The request of a run of a sentence that was not asked for yet, once it is done."""
    ask(page, prompt)
    expect(page.locator("#player .pdd-title")).to_have_text(prompt)
    status(page, "done")
    request = server.engine.requests[-1]
    assert isinstance(request, GenerateRequest)
    return request


def test_a_drawn_path_is_sent_with_the_next_run(drawing: Page, server: Any) -> None:
    page = drawing
    drag(page, "a", (-120, 30), (0, -60))
    (path,) = paths(page)
    assert path["person"] == "a" and path["points"][0][0] == 0 and len(path["points"]) > 2
    expect(chips(page)).to_have_text(re.compile(r"A’s path 1\.\d m ✕"))
    length = chips(page).inner_text().removeprefix("A’s path ").split(" m")[0]
    expect(page.locator("#player .pdd-length")).to_have_text(f"{length} m")
    assert page.evaluate("window.__pasdedeux.player.pane.scene.layers.get('paths').points.length") > 40
    (sent,) = generated(page, server, "A waves to B.").paths
    assert sent.person == "a"
    assert [[point.x, point.z] for point in sent.points] == [point[1:] for point in path["points"]]
    # It stays for the run after, until it is taken away: then the motion is made again without it.
    expect(chips(page)).to_have_count(1)
    expect(page.locator("button#generate")).to_be_enabled()
    made = len(server.engine.requests)
    chips(page).get_by_role("button").click()
    expect(chips(page)).to_have_count(0)
    for _ in range(300):
        if len(server.engine.requests) > made:
            break
        page.wait_for_timeout(100)
    (again,) = server.engine.requests[made:]
    assert (again.prompt, again.paths) == ("A waves to B.", ())
    status(page, "done")


def test_keys_draw_as_well(drawing: Page) -> None:
    page = drawing
    page.locator("#player .pdd-grip[data-person=a]").focus()
    for _ in range(3):
        page.keyboard.press("ArrowLeft")
    expect(chips(page)).to_contain_text(re.compile(r"A’s path 1\.[01] m"))
    page.keyboard.press("Delete")
    assert paths(page) == []
    page.keyboard.press("Escape")
    expect(page.locator("#player .pdd-drawing")).to_be_hidden()
    expect(page.locator("#player .pdd-grip")).to_have_count(0)


def test_a_story_keeps_what_is_drawn(shared_page: Page) -> None:
    page = shared_page
    page.get_by_role("tab", name="Scene").click()
    page.fill("#scene-prompt textarea", "They wave. Then they hug.")
    page.click("button#scene-generate", timeout=SLOW)
    expect(page.locator("#scene-status .pd-done")).to_be_visible()
    player = "document.querySelector('.pds').editor.player"
    until(page, f"{player}.directing.drawing && {player}.frameShown !== null")
    page.evaluate(f"{player}.seek(0); {player}.clock.pause()")
    page.click("#scene-player [data-act=draw]")
    page.locator("#scene-player .pdd-grip[data-person=b]").focus()
    page.keyboard.press("ArrowRight")
    expect(page.locator(".pds-walks li")).to_contain_text(re.compile(r"B’s path 0\.[34] m"))
    (path,) = page.evaluate("document.querySelector('.pds').editor.story.paths")
    assert path["person"] == "b" and len(path["points"]) == 2
    page.locator(".pds-walks button").click()
    assert page.evaluate("document.querySelector('.pds').editor.story.paths") == []
    page.get_by_role("tab", name="Generate").click()


def test_a_kept_run_brings_its_paths_back(drawing: Page, server: Any) -> None:
    page = drawing
    drag(page, "a", (-120, 0))
    generated(page, server, "A bows to B.")
    (path,) = paths(page)
    page.evaluate("window.__pasdedeux.player.directing.director.open([])")
    page.get_by_role("tab", name="History").click()
    expect(page.locator(".pdn-card").first).to_contain_text("A bows to B.")
    page.click("#history-open")
    expect(chips(page)).to_have_count(1)
    assert [point[1:3] for point in paths(page)[0]["points"]] == [point[1:3] for point in path["points"]]
