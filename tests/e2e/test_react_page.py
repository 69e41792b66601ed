"""The React tab in a real browser, with an engine that needs no networks."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import pytest
from playwright.sync_api import Page, expect

from motion.formats import write
from tests.motion.bodies import marching
from tests.motion.formats.characters import glb_takes
from tests.ui.stub_engine import walking

from .playing import choose, unfold
from .serving import SLOW, live

pytestmark = pytest.mark.e2e

PAUSE = 0.01


@pytest.fixture
def page(server: SimpleNamespace, open_page: Callable[..., Page]) -> Page:
    return live(open_page(server.url), "React")


def people(page: Page, count: int) -> None:
    page.wait_for_function(f"window.__pasdedeux?.positions?.length === {count}")


def test_an_uploaded_person_is_seen_trimmed_and_gets_a_partner(page: Page, tmp_path: Path) -> None:
    file = write(walking(12.0), tmp_path / "walkers.npz")[0]
    page.set_input_files("#react-file input[type=file]", file)
    people(page, 1)
    expect(page.locator("#react-status")).to_contain_text("0.0 to 10.0 s of 12.0 s", timeout=SLOW)
    page.fill("#react-end input[type=number]", "3")
    page.press("#react-end input[type=number]", "Tab")
    expect(page.locator("#react-status")).to_contain_text("0.0 to 3.0 s", timeout=SLOW)

    page.click("button#react-generate")
    expect(page.locator("#react-status .pd-done")).to_be_visible(timeout=SLOW)
    people(page, 2)
    expect(page.locator("#react-readouts")).to_contain_text("walkers.npz")
    unfold(page, "#react-downloads")
    button = page.locator("#react-download-npz")
    expect(button).to_be_enabled(timeout=SLOW)

    page.click("button#react-take-b")
    people(page, 1)
    expect(page.locator("#react-status")).to_contain_text("0.0 to 3.0 s of 3.0 s", timeout=SLOW)
    expect(page.locator("#react-person input[value=b]")).to_be_checked(timeout=SLOW)


def test_another_animation_of_a_character_is_chosen(page: Page, tmp_path: Path) -> None:
    positions, rotations = marching(60)
    file = tmp_path / "takes.glb"
    file.write_bytes(glb_takes(rotations, positions[:, 0], ["walk", "glide"]))
    page.set_input_files("#react-file input[type=file]", file)
    expect(page.locator("#react-status")).to_contain_text("1 (“walk”) was taken", timeout=SLOW)
    choose(page, "#react-animation", "2 · glide")
    expect(page.locator("#react-status")).to_contain_text("2 (“glide”) was taken", timeout=SLOW)
    expect(page.locator("#react-animation input")).to_have_value("2 · glide")


def test_a_result_of_the_other_tab_is_taken_and_bad_files_are_a_sentence(page: Page, tmp_path: Path) -> None:
    broken = tmp_path / "broken.bvh"
    broken.write_text("HIERARCHY\nROOT hips\n{")
    page.set_input_files("#react-file input[type=file]", broken)
    expect(page.locator("#react-status .pd-error")).to_contain_text("broken.bvh", timeout=SLOW)

    page.get_by_role("tab", name="Generate").click()
    page.fill("#prompt textarea", "two people walk")
    page.click("button#generate")
    expect(page.locator("#status .pd-done")).to_be_visible(timeout=SLOW)
    page.get_by_role("tab", name="React").click()
    page.click("button#react-take-a")
    expect(page.locator("#react-status")).to_contain_text("two people walk: 0.0 to 5.0 s", timeout=SLOW)


def test_a_streamed_reaction_comes_while_the_actor_plays_and_can_be_cancelled(
    page: Page, server: SimpleNamespace, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(server.engine, "live_waits_at", 72)  # so that a slow browser sees the run while it goes on
    (file, _) = write(walking(4.0), tmp_path / "walker.bvh")
    page.set_input_files("#react-file input[type=file]", file)
    people(page, 1)
    page.click("button#react-stream")
    expect(page.locator("#react-player .pdd-chip")).to_contain_text("streaming · delay", timeout=SLOW)
    people(page, 2)
    known = "(window.__pasdedeux.player.sample.live?.known ?? null)"
    page.wait_for_function(f"{known} === 72 && window.__pasdedeux?.frame > 20")
    assert page.evaluate("window.__pasdedeux.frame") < 72, "the actor does not run ahead of the reactor"
    other = "window.__pasdedeux.player.everybody(15)"
    apart = page.evaluate(f"(([a, b]) => b[0][1] - a[0][1])({other})")
    assert abs(apart - 1.0) < 0.01, "the stub's reactor stands a metre aside"
    expect(page.locator("button#react-generate")).to_be_disabled()
    server.engine.live_waits_at = None
    expect(page.locator("#react-status .pd-done")).to_contain_text("longest", timeout=SLOW)
    page.wait_for_function(f"{known} === null && window.__pasdedeux?.player?.sample.frames === 120")
    unfold(page, "#react-downloads")
    expect(page.locator("#react-download-npz")).to_be_enabled(timeout=SLOW)

    server.engine.live_waits_at = 72
    page.click("button#react-stream")
    page.wait_for_function(f"{known} >= 18")
    page.click("button#react-cancel")
    expect(page.locator("#react-status .pd-warning")).to_contain_text("Cancelled at frame", timeout=SLOW)
    page.wait_for_function(f"{known} === null && window.__pasdedeux?.player?.sample.frames < 120")
    people(page, 2)


def test_two_methods_are_seen_side_by_side_on_one_clock(page: Page, tmp_path: Path) -> None:
    (file, _) = write(walking(3.0), tmp_path / "walker.bvh")
    page.set_input_files("#react-file input[type=file]", file)
    people(page, 1)
    choose(page, "#react-method", "InterGen, person to person")
    unfold(page, "#react-grid")
    choose(page, "#react-other", "ReGenNet, online")
    page.click("button#react-generate")
    expect(page.locator("#react-status .pd-done")).to_contain_text("Both done", timeout=SLOW)
    people(page, 4)
    captions = page.locator("#react-player .pdd-caption")
    expect(captions).to_have_text(["InterGen, person to person", "ReGenNet, online"])
    left, right = (captions.nth(i).locator("..").bounding_box() for i in (0, 1))
    assert left and right and abs(left["width"] - right["width"]) < 2 and left["x"] < right["x"]
    expect(page.locator("#react-readouts thead").first).to_contain_text("ReGenNet, online")
    unfold(page, "#react-downloads")
    with page.expect_download(timeout=SLOW) as download:
        page.click("#react-download-npz")
    assert download.value.suggested_filename.endswith(".zip")

    page.click("button#react-take-a")
    people(page, 1)
    expect(captions).to_have_count(2)
    expect(captions.nth(1)).to_be_hidden()


def test_the_console_stays_quiet_while_runs_are_started(
    server: SimpleNamespace, open_page: Callable[..., Page]
) -> None:
    said: list[str] = []
    page = open_page(server.url, before=lambda tab: tab.on("console", lambda message: said.append(message.text)))
    page.set_default_timeout(SLOW)
    page.fill("#prompt textarea", "two people walk")
    page.click("button#generate")
    expect(page.locator("#status .pd-done")).to_be_visible(timeout=SLOW)
    assert not [line for line in said if "arguments" in line or "Uncaught" in line]


def test_the_button_stays_in_view_once_a_person_is_chosen(
    server: SimpleNamespace, open_page: Callable[..., Page]
) -> None:
    page = live(open_page(server.url, width=1024, height=700), "React")
    page.locator("#react-file").locator("xpath=..").locator("button.pd-chip").first.click()
    expect(page.locator("#react-status")).to_contain_text("0.0 to", timeout=SLOW)
    for part in ("button#react-generate", "#react-player .pdd-stage"):
        box = page.locator(part).bounding_box()
        assert box and box["y"] >= 0 and box["y"] + box["height"] <= 700, part


@pytest.mark.parametrize("width", [1280, 390])
def test_the_names_of_the_methods_are_shown_whole(
    server: SimpleNamespace, open_page: Callable[..., Page], width: int
) -> None:
    tab = live(open_page(server.url, width=width, height=844), "React")
    unfold(tab, "#react-grid")
    for field in ("#react-method", "#react-other"):
        tab.locator(f"{field} input").wait_for()
        room = tab.evaluate(_ROOM, [field, "InterGen, person to person"])
        assert room >= 0, f"{field} lacks {-room:g} pixels"


_ROOM = """([field, text]) => {
    const input = document.querySelector(`${field} input`);
    const pen = document.createElement("canvas").getContext("2d");
    pen.font = getComputedStyle(input).font;
    const arrow = document.querySelector(`${field} .icon-wrap`).getBoundingClientRect();
    return arrow.left - input.getBoundingClientRect().left - pen.measureText(text).width;
}"""
"""Pixels between a text in a list's field and the field's arrow."""
