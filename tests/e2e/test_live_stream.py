"""A partner who answers while somebody moves: on the page, with a recorded person as the stream."""

from __future__ import annotations

import math
import time
from collections.abc import Callable

import pytest
from playwright.sync_api import Page, Route, expect

from .playing import unfold, until

pytestmark = [pytest.mark.e2e, pytest.mark.slow]

PANEL = "#react-live"
SLOW = 120_000


def start(page: Page, source: str) -> None:
    page.wait_for_function("document.querySelector('#react-player .pdd')?.player", timeout=SLOW)
    page.select_option(f"{PANEL} .pdlive-source", source)
    page.click(f"{PANEL} .pdcam-begin")


def two_people(page: Page) -> None:
    page.wait_for_function("window.__pasdedeux?.positions?.length === 2", timeout=SLOW)


def late(route: Route) -> None:
    """Lets a message reach the server as late as on a busy machine: a recorded person loses nothing by it."""
    time.sleep(1.0)
    route.continue_()


def keep_it(page: Page) -> None:
    """Makes the stream that has ended a result: the same frames, with read-outs and files."""
    before = page.evaluate("window.__pasdedeux.positions")
    frame = page.evaluate("window.__pasdedeux.player.clock.pause(), window.__pasdedeux.player.clock.frame")
    page.click(f"{PANEL} .pdlive-keep")
    expect(page.locator("#react-status")).to_contain_text("Kept: 5.0 s live.", timeout=SLOW)
    expect(page.locator("#react-readouts")).to_contain_text("Foot skate")
    unfold(page, "#react-downloads")
    expect(page.locator("#react-download-npz")).to_be_enabled(timeout=SLOW)
    until(page, "!window.__pasdedeux.player.data.id.startsWith('stream-')", seconds=SLOW / 1000)
    assert page.evaluate("window.__pasdedeux.player.sample.frames") == 150
    assert page.evaluate("window.__pasdedeux.positions.length") == 2
    assert len(before) == 2 and frame is not None
    expect(page.locator(f"{PANEL} .pdlive-keep")).to_be_hidden()
    expect(page.locator(f"{PANEL} .pdcam-line")).to_be_empty()  # the tab says it


def test_a_recorded_person_is_answered_as_they_move(lab: str, open_page: Callable[..., Page]) -> None:
    page = open_page(lab, width=1100, height=700)
    page.get_by_role("tab", name="React").click()
    line = page.locator(f"{PANEL} .pdcam-line")
    page.click(f"{PANEL} .pdcam-open")

    for name, sentence in (
        ("NotAllowedError", "The browser blocks the camera"),
        ("NotFoundError", "No camera was found"),
    ):
        page.evaluate(
            "name => { navigator.mediaDevices.getUserMedia = () => Promise.reject(new DOMException('', name)); }", name
        )
        start(page, "webcam")
        expect(line).to_contain_text(sentence, timeout=SLOW)
        expect(page.locator(f"{PANEL} .pdcam-begin")).to_be_visible()

    page.get_by_role("button", name="Push").click()
    expect(line).to_be_empty()  # the camera is no longer asked for
    page.wait_for_function("window.__pasdedeux?.positions?.length === 1", timeout=SLOW)
    page.route("**/live/*", late)
    start(page, "clip")
    two_people(page)
    expect(page.locator(f"{PANEL} .pdlive-text")).to_contain_text("push", timeout=SLOW)
    expect(page.locator(f"{PANEL} .pdlive-chances li").first).to_contain_text("push")
    expect(line).to_contain_text("The end. You can play it again", timeout=SLOW)
    page.unroute("**/live/*")
    shown = page.evaluate("[window.__pasdedeux.player.sample.frames, window.__pasdedeux.playing]")
    assert shown == [150, True], "five seconds, which play again"
    kinds = page.evaluate("window.__pasdedeux.player.sample.things.figures.map(({ body }) => body.kind)")
    assert kinds == ["window", "sash", "sash", "curtain", "curtain", "hi-fi"], "the agent's room is drawn"
    person, partner = page.evaluate("window.__pasdedeux.positions")
    assert 0.3 < math.dist(person[0], partner[0]) < 4

    keep_it(page)
    expect(page.locator("#react-share")).to_be_visible()
    start(page, "clip")
    two_people(page)
    for of_result in ("#react-share", "#react-status .pd-done"):
        expect(page.locator(of_result)).to_be_hidden()  # a stream is no result yet
    assert page.locator("#react-player .pdd-label").all_text_contents() == ["A · given", "B · generated"]
    page.get_by_role("button", name="Push").click()
    expect(line).to_contain_text("something else is shown now", timeout=SLOW)
    page.get_by_role("button", name="Push").click()
    expect(line).to_be_empty()  # what was kept is no longer on the stage
    page.wait_for_function("window.__pasdedeux?.positions?.length === 1", timeout=SLOW)
    page.route("**/live/*", lambda route: route.abort())
    page.click("#react-stream")
    expect(line).to_contain_text("The server cannot be reached", timeout=SLOW)
    page.unroute("**/live/*")
    start(page, "clip")
    two_people(page)
    page.get_by_role("button", name="Push").click()
    expect(line).to_contain_text("something else is shown now", timeout=SLOW)
    expect(page.locator(f"{PANEL} .pdlive-keep")).to_be_hidden()
    start(page, "clip")
    two_people(page)
    opened = page.evaluate("fetch('live', {method: 'POST', body: '{\"partner\": \"agent\"}'}).then((a) => a.status)")
    assert opened == 200
    expect(line).to_contain_text("Another live stream of yours has begun", timeout=SLOW)
