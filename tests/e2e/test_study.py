"""A grid's link, a comparison and a blind study in a browser: the owner, a voter with the link, the owner again."""

from __future__ import annotations

import csv
from collections.abc import Callable
from pathlib import Path

import pytest
from playwright.sync_api import Page, expect

from webdemo.ui.text.texts import say

from .playing import set_number, unfold

pytestmark = [pytest.mark.e2e, pytest.mark.slow]
SLOW = 120_000
CELLS = "window.__pasdedeux?.player?.grid?.cells.length"
LINK = "document.querySelector('{} textarea, {} input')?.value"


def link_in(page: Page, box: str) -> str:
    address = LINK.format(box, box)
    page.wait_for_function(address)
    return page.evaluate(address)


def test_a_grid_is_linked_compared_and_voted_on(
    lab: str, open_page: Callable, tmp_path: Path, expected_errors: list[str]
) -> None:
    small = {"width": 720, "height": 640}
    owner = open_page(lab, **small)
    owner.set_default_timeout(SLOW)
    owner.fill("#prompt textarea", "Two people shake hands.")
    set_number(owner, "#seconds", "1.5")  # files of short motions are written sooner
    owner.click("#generate")
    unfold(owner, "#grid")
    owner.get_by_role("button", name="Plain beside damped").first.click()
    expect(owner.locator("#status .pd-done")).to_contain_text("2 results done", timeout=SLOW)
    owner.click("#share")
    linked = open_page(link_in(owner, "#address"), **small)
    linked.wait_for_function(f"{CELLS} === 2", timeout=SLOW)
    expect(linked.locator("#player .pdd-cell-text")).to_have_text(["damping 0", "damping 0.7"])
    linked.close()

    owner.fill("#prompt textarea", "They bow.")
    owner.click("#generate:enabled")
    expect(owner.locator("#player .pdd-title")).to_have_text("They bow.", timeout=SLOW)
    owner.get_by_role("tab", name="History").click()
    owner.check(".pdn-card >> nth=1 >> .pdn-pick input")
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
    owner.check(".pdn-card:has-text('grid of 2') .pdn-pick input")
    expect(owner.locator(".pdn-count")).to_contain_text("2 of ")
    owner.click("#history-study")
    owner.click("#study-make")
    expect(owner.locator("#history-status")).to_contain_text("The study has one pair", timeout=SLOW)
    invitation = link_in(owner, "#study-link")
    expect(owner.locator("#study-result")).to_contain_text("Nobody has voted yet")

    voter = open_page(invitation, **small, color_scheme="dark")
    expect(voter.locator("h1")).to_have_text("Which does what the sentence says?")
    voter.wait_for_function(f"{CELLS} === 2 && window.__pasdedeux?.frame > 0", timeout=SLOW)
    expect(voter.locator(".pdd-head:not(:empty)")).to_have_text(["1", "2"])
    assert "damping" not in voter.content() and "They bow" not in voter.content()
    expect(voter.locator(".pst-progress")).to_have_text("Pair 1 of 1")
    expect(voter.locator("[data-answer='1']")).to_be_enabled(timeout=SLOW)
    voter.route("**/vote/**", lambda route: (route.fetch(), route.abort()))  # the vote is counted, its answer is lost
    voter.keyboard.press("=")
    expect(voter.locator(".pst-said")).to_have_text(say("vote.unreachable"))
    voter.unroute("**/vote/**")
    expected_errors.append("422 from /study/")  # it was voted on before
    voter.keyboard.press("=")
    expect(voter.locator(".pst-thanks")).to_contain_text("your votes are counted", timeout=SLOW)
    voter.reload()
    expect(voter.locator(".pst-progress")).to_have_text("All 1 pairs done", timeout=SLOW)
    voter.context.close()

    owner.click("#study-refresh")
    expect(owner.locator("#study-result")).to_contain_text("One vote of one voter", timeout=SLOW)
    with owner.expect_download(timeout=SLOW) as download:
        owner.click("#study-csv")
    download.value.save_as(tmp_path / "votes.csv")
    assert [row["chosen"] for row in csv.DictReader((tmp_path / "votes.csv").open())] == ["tie"]
    owner.on("dialog", lambda dialog: dialog.accept())
    owner.click("#study-delete")
    expect(owner.locator("#history-status")).to_contain_text("Deleted the study", timeout=SLOW)
    expect(owner.locator("#study-link")).not_to_be_visible()
