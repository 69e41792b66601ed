"""The tour of a visitor's camera on the tab React: a video, the webcam, and a partner who answers live."""

from __future__ import annotations

import pytest
from playwright.sync_api import Page, expect

from ..test_camera import FILM
from .hands import all_used, pressed, uploaded, visited
from .touring import SLOW, Tour

pytestmark = [pytest.mark.e2e, pytest.mark.slow]

EXPECTED = ("410 from /live/",)  # of a message on its way when its stream ends
CAMERA, LIVE = "#react-camera", "#react-live"


def filmed(page: Page, tour: Tour, name: str) -> None:
    """Waits until a film has become the actor."""
    expect(page.locator("#react-status")).to_contain_text(f"{name}: 0.0 to", timeout=SLOW)
    tour.settle(page)


def test_camera(page: Page, tour: Tour) -> None:
    visited(page, "React")
    page.click(f"{CAMERA} .pdcam-open")
    page.click(f"{CAMERA} summary")
    line = page.locator(f"{CAMERA} .pdcam-line")
    for _ in range(2):
        uploaded(page, tour, f"{CAMERA} .pdcam-choose", FILM)
        page.click(f"{CAMERA} .pdcam-cancel")
        expect(line).to_have_text("Cancelled.")
    page.select_option(f"{CAMERA} .pdcam-people", "1")
    uploaded(page, tour, f"{CAMERA} .pdcam-choose", FILM)
    filmed(page, tour, "wave.mp4")
    for _ in range(2):
        page.click(f"{CAMERA} .pdcam-record")
        page.click(f"{CAMERA} .pdcam-begin")
        stop = page.locator(f"{CAMERA} .pdcam-stop")
        expect(stop).to_be_visible(timeout=SLOW)
        page.wait_for_timeout(1200)
        stop.click()
        filmed(page, tour, "Webcam")
    all_used(page, tour, "React / react-camera /")


def test_live(page: Page, tour: Tour) -> None:
    pressed(page, tour, "button:has-text('Push')")
    page.click(f"{LIVE} .pdcam-open")
    for source in ("webcam", "clip"):
        for partner in ("regennet", "agent"):
            page.select_option(f"{LIVE} .pdlive-source", source)
            page.select_option(f"{LIVE} .pdlive-partner", partner)
            page.click(f"{LIVE} .pdcam-begin")
            expect(page.locator(f"{LIVE} .pdlive-figures")).to_contain_text("ms to the partner", timeout=SLOW)
            if source == "webcam":
                expect(page.locator(f"{LIVE} .pdlive-keep")).to_be_visible(timeout=SLOW)
                page.click(f"{LIVE} .pdcam-stop")
            else:
                expect(page.locator(f"{LIVE} .pdcam-line")).to_contain_text("The end.", timeout=SLOW)
            tour.settle(page)
            if partner == "agent":
                pressed(page, tour, f"{LIVE} .pdlive-keep", 1)
                expect(page.locator("#react-status")).to_contain_text("Kept:", timeout=SLOW)
    page.select_option(f"{LIVE} .pdlive-source", "webcam")
    page.click(f"{LIVE} summary")
    all_used(page, tour, "React / react-live /")
