"""The tour of the tab History: found, opened, written on, linked, taken along, compared, removed."""

from __future__ import annotations

import zipfile
from pathlib import Path

import pytest
from playwright.sync_api import Page, expect

from .hands import all_used, linked, made, number, open_all, pressed, visited
from .touring import SLOW, Tour

pytestmark = [pytest.mark.e2e, pytest.mark.slow]

ELSEWHERE = ("^History / study", "history-import / Clear", "history-publish / ")
"""The panel of a study, a button that is there only until a file is read (the field empties itself), and public pages,
which test_public_pages makes and ends."""
CARD = ".pdn-card >> nth={}"


def acted(page: Page, tour: Tour, act: str, times: int = 1) -> None:
    """Presses a button of the notebook."""
    pressed(page, tour, f"#history-{act}:enabled", times)


def chosen(page: Page, *numbers: int) -> None:
    """Chooses cards, of which the first is number 0."""
    page.locator(f"{CARD.format(numbers[0])} >> .pdn-thumb").click()
    for number_ in numbers[1:]:
        page.check(f"{CARD.format(number_)} >> [data-choose]")


def described(page: Page, tour: Tour, title: str) -> None:
    """Writes on the newest run."""
    if not page.locator(f"{CARD.format(0)} >> details[open]").count():
        page.click(f"{CARD.format(0)} >> summary")
    for field, value in (("title", title), ("tags", "tour"), ("note", "Hands late"), ("frame", "12")):
        page.fill(f"[data-field={field}]", value)
    pressed(page, tour, "[data-save]", 1)
    expect(page.locator(CARD.format(0))).to_contain_text(title)


def searched(page: Page, tour: Tour, words: str, count: int) -> None:
    page.fill("[data-find=words]", words)
    expect(page.locator(".pdn-card")).to_have_count(count, timeout=SLOW)
    tour.settle(page)


def test_history(page: Page, tour: Tour, tmp_path: Path) -> None:
    number(page, "seconds", 2)
    for words in ("They bow.", "They wave."):
        page.fill("#prompt textarea", words)
        made(page, tour, times=1)
    visited(page, "History")
    expect(page.locator(CARD.format(0))).to_contain_text("They wave.", timeout=SLOW)
    for title in ("A greeting", "Another greeting"):
        described(page, tour, title)
    everything = page.locator(".pdn-card").count()  # other tests of the tour have made some
    searched(page, tour, "another tour late", 1)
    searched(page, tour, "", everything)
    for _ in range(2):
        chosen(page, 0)
        acted(page, tour, "open")
        expect(page.locator("#status .pd-done")).to_contain_text("Made on", timeout=SLOW)
        visited(page, "History")
        chosen(page, 0)
        acted(page, tour, "link")
        linked(page, "#history-address")
        pressed(page, tour, "#history-address button", 1)
        acted(page, tour, "revoke")
        acted(page, tour, "favour", 2)
        acted(page, tour, "again")
        chosen(page, 0, 1)
        acted(page, tour, "compare")
        page.wait_for_function("window.__pasdedeux?.player?.grid?.cells.length === 2")
        visited(page, "History")
        chosen(page, 0, 1)
        acted(page, tour, "study")
        tour.press_rest(page, "History / study-question")
        acted(page, tour, "export")
        with page.expect_download(timeout=SLOW) as download:
            page.click("#history-saved")
        with zipfile.ZipFile(download.value.path()) as archive:
            archive.extractall(tmp_path)
        acted(page, tour, "remove")
        acted(page, tour, "restore")
    for _ in range(2):
        chosen(page, 0)
        page.click("#history-again:enabled")
        page.click("#history-stop:enabled")
        tour.settle(page)
    open_all(page)
    for _ in range(2):
        before = page.locator(".pdn-card").count()
        page.set_input_files("#history-import input[type=file]", sorted(tmp_path.glob("*.npz")))
        expect(page.locator(".pdn-card")).to_have_count(before + 2, timeout=SLOW)
        tour.settle(page)
        pressed(page, tour, "#history-export-all", 1)

    all_used(page, tour, "History", *ELSEWHERE)
