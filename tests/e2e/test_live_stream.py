"""A partner who answers while somebody moves: on the page, with a recorded person as the stream."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from playwright.sync_api import Page, expect

pytestmark = [pytest.mark.e2e, pytest.mark.slow]

PANEL = "#react-live"
SLOW = 120_000


@pytest.fixture(scope="module")
def lab(start_server: Callable[..., str], tmp_path_factory: pytest.TempPathFactory) -> str:
    data = str(tmp_path_factory.mktemp("lab"))
    env = {"STUB_PAUSE": "0", "PASDEDEUX_FREE_MEGABYTES": "0"}
    return start_server([str(Path("tests/server/lab.py")), "{port}", data], env=env)


def start(page: Page, source: str) -> None:
    page.select_option(f"{PANEL} .pdlive-source", source)
    page.click(f"{PANEL} .pdcam-begin")


def two_people(page: Page) -> None:
    page.wait_for_function("window.__pasdedeux?.positions?.length === 2", timeout=SLOW)


def test_a_recorded_person_is_answered_as_they_move(lab: str, open_page: Callable[..., Page]) -> None:
    page = open_page(lab, width=1100, height=700)
    page.get_by_role("tab", name="React").click()
    line = page.locator(f"{PANEL} .pdcam-line")
    page.click(f"{PANEL} .pdcam-open")
    start(page, "clip")
    expect(line).to_contain_text("Nobody is chosen yet", timeout=SLOW)

    for name, sentence in (
        ("NotAllowedError", "The camera may not be used"),
        ("NotFoundError", "No camera was found"),
    ):
        page.evaluate(
            "name => { navigator.mediaDevices.getUserMedia = () => Promise.reject(new DOMException('', name)); }",
            name,
        )
        start(page, "webcam")
        expect(line).to_contain_text(sentence, timeout=SLOW)
        expect(page.locator(f"{PANEL} .pdcam-begin")).to_be_visible()

    page.get_by_role("button", name="Push").click()
    page.wait_for_function("window.__pasdedeux?.positions?.length === 1", timeout=SLOW)
    start(page, "clip")
    two_people(page)
    expect(page.locator(f"{PANEL} .pdlive-text")).to_have_text("The stub watches.")
    expect(page.locator(f"{PANEL} .pdlive-chances li")).to_have_text(["wave75 %", "bow20 %"])
    expect(page.locator(f"{PANEL} .pdlive-figures")).to_contain_text("ms to the partner")
    expect(line).to_contain_text("The end. What happened can be played again.", timeout=SLOW)
    shown = page.evaluate("[window.__pasdedeux.player.sample.frames, window.__pasdedeux.playing]")
    assert shown == [150, True], "five seconds, which play again"
    person, partner = page.evaluate("window.__pasdedeux.positions")
    assert partner[0] == pytest.approx([-person[0][0], person[0][1], 1.5 - person[0][2]], abs=0.01)

    page.get_by_role("button", name="Push").click()
    page.wait_for_function("window.__pasdedeux?.positions?.length === 1", timeout=SLOW)
    page.route("**/live/*", lambda route: route.abort())
    start(page, "clip")
    expect(line).to_contain_text("The connection was lost", timeout=SLOW)
    page.unroute("**/live/*")
    two_people(page)
    opened = page.evaluate(
        "fetch('live', {method: 'POST', body: '{\"partner\": \"agent\"}'}).then((a) => a.status)"
    )
    assert opened == 200
    expect(line).to_contain_text("Another live stream of yours has begun", timeout=SLOW)
