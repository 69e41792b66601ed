"""A grid's link, a comparison and a blind study in a browser: the owner, a voter with the link, the owner again."""

from __future__ import annotations

import csv
import re
from collections.abc import Callable
from pathlib import Path

import pytest
from playwright.sync_api import Page, expect

from motion.formats import write
from tests.ui.stub_engine import walking

from .playing import unfold

pytestmark = [pytest.mark.e2e, pytest.mark.slow]
SLOW = 120_000
CELLS = "window.__pasdedeux?.player?.grid?.cells.length"
LINK = "document.querySelector('{} textarea, {} input')?.value"


def link_in(page: Page, box: str) -> str:
    address = LINK.format(box, box)
    page.wait_for_function(address)
    return page.evaluate(address)


def vote(page: Page, number: int, total: int, key: str) -> None:
    expect(page.locator(".pst-progress")).to_have_text(f"Pair {number} of {total}", timeout=SLOW)
    expect(page.locator("[data-answer='1']")).to_be_enabled(timeout=SLOW)
    page.keyboard.press(key)


def test_a_grid_is_linked_compared_and_voted_on(lab: str, open_page: Callable, tmp_path: Path) -> None:
    small = {"width": 720, "height": 640}
    owner = open_page(lab, **small)
    owner.set_default_timeout(SLOW)
    owner.fill("#prompt textarea", "Two people shake hands.")
    owner.locator("#seconds input[type=number]").fill("1.5")  # files of short motions are written sooner
    owner.locator("#seconds input[type=number]").press("Tab")
    unfold(owner, "#grid")
    owner.get_by_role("button", name="Plain beside damped").first.click()
    expect(owner.locator("#status .pd-done")).to_contain_text("2 results done", timeout=SLOW)
    unfold(owner, "#share")
    owner.click("#link")
    linked = open_page(link_in(owner, "#address"), **small)
    linked.wait_for_function(f"{CELLS} === 2", timeout=SLOW)
    expect(linked.locator("#player .pdd-cell-text")).to_have_text(["damping 0", "damping 0.7"])
    linked.close()

    owner.fill("#prompt textarea", "They bow.")
    owner.click("#generate:enabled")
    expect(owner.locator("#player .pdd-title")).to_have_text("They bow.", timeout=SLOW)
    owner.get_by_role("tab", name="History").click()
    owner.check(".pdn-card >> nth=1 >> [data-choose]")
    owner.click("#history-compare")
    owner.wait_for_function(f"{CELLS} === 2")
    expect(owner.locator("#player .pdd-cell-text").first).to_have_text("They bow., seed 0")
    owner.locator("#player .pdd-cell").nth(1).scroll_into_view_if_needed()
    box = owner.locator("#player .pdd-cell").nth(1).bounding_box()
    assert box
    owner.mouse.click(box["x"] + 30, box["y"] + 30)
    owner.wait_for_function("window.__pasdedeux?.player?.focus === 1")
    owner.click("#player .pdd-back")
    owner.wait_for_function(f"{CELLS} === 2 && window.__pasdedeux?.player?.focus === null")

    owner.get_by_role("tab", name="History").click()
    owner.click(".pdn-card:has-text('grid of 2') .pdn-thumb")
    expect(owner.locator(".pdn-count")).to_contain_text("1 of ")
    owner.click("#history-study")
    expect(owner.locator("#study-way input")).to_have_value(
        "Damping: damping 0 (1) against damping 0.7 (1)", timeout=SLOW
    )
    owner.locator("#study-checks input[type=number]").fill("1")
    owner.locator("#study-checks input[type=number]").press("Tab")
    owner.click("#study-make")
    expect(owner.locator("#study-status")).to_contain_text("The study has one pair", timeout=SLOW)
    invitation = link_in(owner, "#study-link")
    expect(owner.locator("#study-result")).to_contain_text("Nobody has voted yet")

    voter = open_page(invitation, **small, color_scheme="dark")
    expect(voter.locator("h1")).to_have_text("Which does what the sentence says?")
    voter.wait_for_function(f"{CELLS} === 2 && window.__pasdedeux?.frame > 0", timeout=SLOW)
    expect(voter.locator(".pdd-head:not(:empty)")).to_have_text(["1", "2"])
    expect(voter.locator(".pdd-title")).to_have_text("Two people shake hands.")
    assert "damping" not in voter.content()
    vote(voter, 1, 2, "=")
    vote(voter, 2, 2, "s")
    expect(voter.locator(".pst-thanks")).to_contain_text("your votes are counted", timeout=SLOW)
    voter.reload()
    expect(voter.locator(".pst-progress")).to_have_text("All 2 pairs done", timeout=SLOW)
    voter.context.close()

    owner.click("#study-refresh")
    # "=" and "skip" are both wrong for an attention check, so the votes of this person do not count.
    expect(owner.locator("#study-result")).to_contain_text(
        "0 votes of 0 people count, 1 more left out", timeout=SLOW
    )
    with owner.expect_download(timeout=SLOW) as download:
        owner.click("#study-csv")
    download.value.save_as(tmp_path / "votes.csv")
    rows = list(csv.DictReader((tmp_path / "votes.csv").open()))
    assert sorted(row["pressed"] for row in rows) == ["skip", "tie"]
    assert {row["rater_counts"] for row in rows} == {"no"}


def test_two_sets_of_files_are_a_study_without_any_run(lab: str, open_page: Callable, tmp_path: Path) -> None:
    files: dict[str, list[str]] = {"ours": [], "theirs": []}
    for side, paths in files.items():
        for name in ("hug", "wave"):
            (tmp_path / side).mkdir(exist_ok=True)
            paths.append(str(write(walking(1.0), tmp_path / side / f"{name}.npz")[0]))
    page = open_page(lab, width=720, height=640)
    page.set_default_timeout(SLOW)
    page.get_by_role("tab", name="History").click()
    page.click("#study > button")
    page.click("#study-begin")
    expect(page.locator("#study-make")).to_be_visible()
    expect(page.locator("#study-way")).not_to_be_visible()
    page.set_input_files("#study-files input[type=file]", files["ours"])
    expect(page.locator("#study-files")).to_contain_text("wave", timeout=SLOW)
    page.click("#study-make")
    expect(page.locator("#study-status .pd-error")).to_contain_text(
        "upload files for another set", timeout=SLOW
    )
    page.set_input_files("#study-more-files input[type=file]", files["theirs"])
    expect(page.locator("#study-more-files")).to_contain_text("wave", timeout=SLOW)
    page.click("#study-make")
    expect(page.locator("#study-status .pd-done")).to_contain_text("The study has 2 pairs", timeout=SLOW)
    expect(page.locator("#study-which input")).to_have_value(re.compile("Recorded, Uploaded"))
    page.click("#study-begin")
    expect(page.locator("#study-make")).to_be_visible()
    for name in ("#study-files", "#study-more-files"):
        expect(page.locator(f"{name} input[type=file]")).to_be_attached()
        expect(page.locator(name)).not_to_contain_text("wave")
