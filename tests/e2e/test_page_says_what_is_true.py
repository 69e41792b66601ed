"""What the page says of its controls, its methods and its results is so: several checks a page load."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import pytest
from playwright.sync_api import Page, expect

from motion.formats import write
from tests.ui.stub_engine import walking
from webdemo.inference.methods import method

from .playing import choose, unfold
from .serving import live

pytestmark = pytest.mark.e2e

SLOW = 120_000
"""Milliseconds that a busy machine may take to draw."""
PAUSE = 0.01
CHANGED = "Settings changed: run again"


@pytest.fixture
def page(server: SimpleNamespace, open_page: Callable[..., Page]) -> Page:
    return live(open_page(server.url, width=1024, height=700), slow=SLOW)


def set_number(page: Page, selector: str, value: str) -> None:
    field = page.locator(f"{selector} input[type=number]").first
    field.fill(value)
    field.press("Tab")


def generate(page: Page, prompt: str) -> None:
    page.fill("#prompt textarea", prompt)
    with page.expect_request(lambda sent: "queue/join" in sent.url and '"intergen"' in (sent.post_data or "")):
        page.click("button#generate")  # the sentence is read first, while the line still tells of the last run
    expect(page.locator("#player .pdd-title")).to_have_text(prompt, timeout=SLOW)
    expect(page.locator("#status .pd-done")).to_be_visible(timeout=SLOW)


def names_above_heads(page: Page, player: str) -> list[str]:
    return page.locator(f"{player} .pdd-label").all_text_contents()


def play_row_is_in_view(page: Page, player: str) -> None:
    expect(page.locator(f"{player} .pdd-play")).to_be_visible(timeout=SLOW)
    bottom = page.evaluate(
        f"(window.scrollTo(0, 0), document.querySelector('{player} .pdd-play').getBoundingClientRect().bottom)"
    )
    assert bottom <= 700, f"the play row ends at {bottom:.0f} of 700 pixels"


def choose_when_done(page: Page, box: str, option: str) -> None:
    """Chooses once all that a run changes on the page is there."""
    expect(page.locator(".pd-run:visible")).to_be_enabled(timeout=SLOW)
    choose(page, box, option)


def open_react(page: Page, file: Path) -> None:
    page.get_by_role("tab", name="React").click()
    page.set_input_files("#react-file input[type=file]", file)
    page.wait_for_function("window.__pasdedeux?.positions?.length === 1")


def test_controls_that_differ_from_what_is_shown_say_so(page: Page, server: SimpleNamespace) -> None:
    changed = page.locator("#changed")
    unfold(page, "#more")
    set_number(page, "#seed", "3")
    assert changed.inner_text().strip() == "", "nothing is shown yet that the settings could differ from"
    generate(page, "Two people walk.")
    assert changed.inner_text().strip() == ""
    set_number(page, "#seed", "4")
    expect(changed).to_contain_text(CHANGED)
    set_number(page, "#seed", "3")
    expect(changed).not_to_contain_text(CHANGED)
    page.fill("#prompt textarea", "Two people run.")
    expect(changed).to_contain_text(CHANGED)
    generate(page, "Two people run.")
    expect(changed).not_to_contain_text(CHANGED)

    folded = page.locator("#advanced")
    expect(folded).to_contain_text("Guidance 4.3, 8 steps, damping 0.7")
    page.locator("#pace label", has_text="Faithful").click()
    expect(folded).to_contain_text("Guidance 4.3, 50 steps, damping 0.7")
    expect(changed).to_contain_text(CHANGED)
    page.locator("#pace label", has_text="Fast").click()
    expect(folded).to_contain_text("Guidance 4.3, 8 steps, damping 0.7")
    expect(changed).not_to_contain_text(CHANGED)
    for width in (1440, 1024, 390):  # its line never wraps, and its arrow stays in the panel
        page.set_viewport_size({"width": width, "height": 844})
        button, panel = (part.bounding_box() for part in (folded.locator("button").first, folded))
        assert button and panel and button["height"] < 30
        assert button["x"] + button["width"] <= panel["x"] + panel["width"] + 1, width
    page.set_viewport_size({"width": 1280, "height": 800})
    unfold(page, "#advanced")
    set_number(page, "#steps", "12")
    expect(folded).to_contain_text("Guidance 4.3, 12 steps, damping 0.7")
    expect(page.locator("#pace input:checked")).to_have_count(0)
    expect(changed).to_contain_text(CHANGED)
    page.locator("#planned label", has_text="Let the network alone").click()
    expect(folded).to_contain_text("damping 0.7, no paths")
    set_number(page, "#seed", "3")
    generate(page, "Two people run.")
    assert server.engine.requests[-1].planned is False
    expect(changed).not_to_contain_text(CHANGED)

    seen = len(server.engine.requests)
    set_number(page, "#seed", "1.5")
    page.click("button#generate")
    expect(page.locator("#status .pd-error")).to_contain_text("Seed must be a whole number", timeout=SLOW)
    assert len(server.engine.requests) == seen, "a seed that is no integer was rounded in silence"
    expect(changed).not_to_contain_text(CHANGED)  # nothing was made


def test_a_sentence_is_warned_of_beside_done_and_names_say_who_acts(page: Page) -> None:
    generate(page, "One unknown person pushes the other.")
    play_row_is_in_view(page, "#player")
    expect(page.locator("#status .pd-warning")).to_contain_text("far from anything the model was trained on")
    assert names_above_heads(page, "#player") == ["A · acts first", "B · answers"]
    generate(page, "Two people shake hands with each other.")
    expect(page.locator("#status .pd-warning")).to_have_count(0)
    assert names_above_heads(page, "#player") == ["A", "B"]

    expect(page.locator("#about-method")).to_have_text(method("intergen").summary)
    page.locator("#way").get_by_text("A class").click()
    expect(page.locator("#about-method")).to_have_text(method("bigraphdiff").summary)


def test_a_reaction_chooses_its_method_and_greys_words_that_are_not_heard(
    page: Page, server: SimpleNamespace, tmp_path: Path
) -> None:
    open_react(page, write(walking(3.0).a, tmp_path / "walker.npz")[0])
    play_row_is_in_view(page, "#react-player")
    assert names_above_heads(page, "#react-player") == ["A · given"]
    expect(page.locator("#react-method input")).to_have_value("Automatic")
    expect(page.locator("#react-about")).to_contain_text("without words, the virtual agent")
    expect(page.locator("#react-live-method")).to_contain_text("Stream always uses ReGenNet, online")

    page.click("button#react-generate")
    expect(page.locator("#react-readouts .pd-asked")).to_contain_text("Virtual agent", timeout=SLOW)
    assert server.engine.requests[-1].model == "agent"
    assert names_above_heads(page, "#react-player") == ["A · given", "B · generated"]
    page.fill("#react-prompt textarea", "They shake hands.")
    expect(page.locator("#react-changed")).to_contain_text(CHANGED)
    page.click("button#react-generate")
    expect(page.locator("#react-readouts .pd-asked")).to_contain_text("InterGen", timeout=SLOW)
    assert server.engine.requests[-1].model == "intergen"
    expect(page.locator("#react-player .pdd-title")).to_have_text("They shake hands.")


def test_words_that_a_method_does_not_hear_are_greyed_and_frames_are_counted(
    page: Page, server: SimpleNamespace, tmp_path: Path
) -> None:
    open_react(page, write(walking(3.0).a, tmp_path / "walker.npz")[0])
    page.fill("#react-prompt textarea", "They shake hands.")
    choose_when_done(page, "#react-method", "Virtual agent")
    expect(page.locator("#react-prompt textarea")).to_be_disabled()
    expect(page.locator("#react-about")).to_contain_text(method("agent").summary)
    page.click("button#react-generate")
    expect(page.locator("#react-player .pdd-title")).to_have_text("Reaction to walker.npz", timeout=SLOW)
    assert server.engine.requests[-1].prompt == ""

    choose_when_done(page, "#react-method", "ReGenNet, online")
    expect(page.locator("#react-prompt textarea")).to_be_enabled()
    server.engine.pause = 5.0  # so that a slow browser sees the run while it goes on
    try:
        page.click("button#react-generate")
        expect(page.locator("#react-status")).to_contain_text("Generating: frame", timeout=SLOW)
        page.click("button#react-cancel")
    finally:
        server.engine.pause = 0.01
    expect(page.locator("#react-status .pd-warning")).to_contain_text("Cancelled at frame", timeout=SLOW)
    page.click("button#react-stream")
    expect(page.locator("#react-status .pd-done")).to_contain_text("by ReGenNet, online", timeout=SLOW)


def test_a_file_that_cannot_be_read_leaves_nothing_of_the_one_before(
    page: Page, server: SimpleNamespace, tmp_path: Path
) -> None:
    good = write(walking(3.0).a, tmp_path / "walker.npz")[0]
    broken = tmp_path / "broken.bvh"
    broken.write_text("HIERARCHY\nROOT hips\n{")
    page.get_by_role("tab", name="React").click()
    page.get_by_role("button", name="Wave", exact=True).last.click()
    page.wait_for_function("window.__pasdedeux?.positions?.length === 1")
    page.locator("#react-import button").first.click()
    read = page.locator("#react-import")
    expect(read).to_contain_text("Data set of a 15-joint file")
    assert page.locator("#react-up input").input_value() == "detect"
    page.set_input_files("#react-file input[type=file]", broken)
    expect(page.locator("#react-status .pd-error")).to_contain_text("broken.bvh", timeout=SLOW)
    expect(page.locator("#react-player .pdd-empty")).to_be_visible()
    expect(read).to_be_hidden()
    page.click("button#react-generate")
    expect(page.locator("#react-status .pd-error")).to_contain_text("There is no actor yet", timeout=SLOW)

    page.get_by_role("tab", name="Predict").click()
    expect(page.locator("#predict-about")).to_have_text(method("motion-mlp").summary)
    choose_when_done(page, "#predict-method", "PredictiveMA-WGAN")
    expect(page.locator("#predict-about")).to_have_text(method("mawgan").summary)
    page.set_input_files("#predict-file input[type=file]", good)
    expect(page.locator("#predict-status")).to_contain_text("one person, 3.0 s", timeout=SLOW)
    page.click("button#predict-generate")
    expect(page.locator("#predict-status .pd-done")).to_be_visible(timeout=SLOW)
    play_row_is_in_view(page, "#predict-player")
    set_number(page, "#predict-marker", "2")
    expect(page.locator("#predict-changed")).to_contain_text(CHANGED)
    page.click("button#predict-take")  # the result is the past now, and the field of files is empty
    expect(page.locator("#predict-status")).to_contain_text("After 1.5 s", timeout=SLOW)
    page.set_input_files("#predict-file input[type=file]", broken)
    expect(page.locator("#predict-status .pd-error")).to_contain_text("broken.bvh", timeout=SLOW)
    page.click("button#predict-generate")
    expect(page.locator("#predict-status .pd-error")).to_contain_text("There is no motion yet", timeout=SLOW)
