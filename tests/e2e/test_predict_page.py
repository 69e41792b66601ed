"""The Predict tab in a real browser, with an engine that needs no networks."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from playwright.sync_api import Page, expect

from motion.formats import write
from tests.ui.stub_engine import walking
from webdemo.ui.components.player import ROUNDS
from webdemo.ui.text.examples import example_clips

from .playing import choose, give_file, set_number, unfold
from .serving import SLOW, live

pytestmark = pytest.mark.e2e

PAUSE = 0.01
SAMPLE = "window.__pasdedeux.player.sample"


@pytest.fixture
def page(shared_page: Page) -> Page:
    return live(shared_page, "Predict")


def people(page: Page, count: int) -> None:
    page.wait_for_function(f"window.__pasdedeux?.positions?.length === {count}")


def marker(page: Page) -> float:
    return float(page.input_value("#predict-marker input[type=number]"))


def move_marker(page: Page, second: float) -> None:
    page.fill("#predict-marker input[type=number]", str(second))
    page.press("#predict-marker input[type=number]", "Tab")


def upload(page: Page, file: Path) -> None:
    give_file(page, "#predict-file", file)


def predict(page: Page) -> None:
    page.click("button#predict-generate")
    expect(page.locator("#predict-status .pd-done")).to_contain_text("Made")


def damaged(kind: str) -> np.ndarray:
    """(90, 22, 3) of a walker with NaN, or with a wrist that jumps."""
    positions = np.array(walking(3.0).a.positions)
    positions[20, 20] += np.nan if kind == "nan" else 3.0
    return positions


def test_it_opens_with_the_first_example_which_plays(page: Page) -> None:
    """It comes first, on a page where nothing was chosen yet."""
    (name, _), *_ = example_clips()
    expect(page.locator("#predict-player .pdd-title")).to_have_text(name)
    expect(page.locator("#predict-status")).to_contain_text(f"{name}: two people")
    page.wait_for_function("window.__pasdedeux?.playing && window.__pasdedeux.frame > 5")
    assert page.evaluate("window.__pasdedeux.player.data.rounds") == ROUNDS
    predict(page)
    page.wait_for_function(f"{SAMPLE}.past_until > 0")
    page.get_by_role("tab", name="Generate").click()
    live(page, "Predict")  # what is there stays
    page.wait_for_timeout(500)
    assert page.evaluate(f"{SAMPLE}.past_until") > 0


def test_what_cannot_be_predicted_is_a_sentence(page: Page, tmp_path: Path) -> None:
    error = page.locator("#predict-status .pd-error")
    for kind, read, sentence in (("jump", "one person, 3.0 s", "The left wrist jumps"), ("nan", None, "nan.npy")):
        np.save(tmp_path / f"{kind}.npy", damaged(kind))
        upload(page, tmp_path / f"{kind}.npy")
        if read:
            expect(page.locator("#predict-status")).to_contain_text(read)
            page.click("button#predict-generate")
        expect(error).to_contain_text(sentence)


def test_the_past_ends_at_the_marker_and_the_truth_is_a_ghost(page: Page, tmp_path: Path) -> None:
    upload(page, write(walking(4.0), tmp_path / "walkers.npz")[0])
    people(page, 2)
    expect(page.locator("#predict-status")).to_contain_text("two people, 4.0 s")
    page.wait_for_function("Number(document.querySelector('#predict-marker input[type=number]').value) > 1")
    move_marker(page, 3.0)
    page.evaluate("(() => { const c = window.__pasdedeux.player.clock; c.pause(); c.play = () => {}; })()")
    predict(page)
    page.wait_for_function(f"{SAMPLE}.frames === 150")  # two seconds after the marker, by default
    assert page.evaluate(f"{SAMPLE}.past_until") == 90
    assert page.evaluate("window.__pasdedeux.player.clock.frame") == 90  # playing begins at the marker
    page.evaluate("delete window.__pasdedeux.player.clock.play")
    assert page.evaluate(f"{SAMPLE}.ghost !== null")
    expect(page.locator("#predict-readouts")).to_contain_text("Holding the last pose would have been")
    assert page.locator("#predict-player .pdd-values dt").all_text_contents() == ["Error", "Speed"]
    unfold(page, "#predict-downloads")
    expect(page.locator("#predict-download-npz")).to_be_enabled()
    with page.expect_download(timeout=SLOW) as download:
        page.click("#predict-download-npz")
    assert download.value.suggested_filename.startswith("after-3-0-s-of-walkers-npz-")

    # The marker at the very end: nothing is left to compare with.
    move_marker(page, 4.0)
    page.click("button#predict-generate")
    page.wait_for_function(f"{SAMPLE}.frames === 180 && {SAMPLE}.ghost === null")
    expect(page.locator("#predict-readouts")).to_contain_text("The motion ends here")


def test_two_people_have_several_futures_by_a_seed(page: Page, tmp_path: Path) -> None:
    upload(page, write(walking(3.0), tmp_path / "walkers.npz")[0])
    expect(page.locator("#predict-status")).to_contain_text("two people, 3.0 s")
    page.wait_for_function("document.querySelector('#predict-marker input[type=number]').value === '1'")
    seed = page.locator("#predict-seed")
    expect(seed).to_be_hidden()
    choose(page, "#predict-method", "InterGen, both together")
    expect(seed).to_be_visible()
    seed.locator("input").fill("7")
    set_number(page, "#predict-samples", "2")
    page.click("button#predict-generate")
    expect(page.locator("#predict-status .pd-done")).to_contain_text("2 samples made")
    page.wait_for_function("window.__pasdedeux.player.data.samples.length === 2")
    assert page.evaluate(f"{SAMPLE}.past_until") == 30
    choose(page, "#predict-method", "Motion MLP")
    expect(seed).to_be_hidden()
    page.get_by_role("tab", name="History").click()
    page.locator(".pdn-card").first.click()
    page.click("#history-open")
    expect(seed).to_be_visible()  # as the run was made
    choose(page, "#predict-method", "Motion MLP")


def test_a_result_of_another_tab_goes_on(page: Page) -> None:
    page.get_by_role("tab", name="Generate").click()
    page.fill("#prompt textarea", "two people walk")
    page.click("button#generate")
    expect(page.locator("#status .pd-done")).to_be_visible()
    page.click("button#continue")
    expect(page.get_by_role("tab", name="Predict")).to_have_attribute("aria-selected", "true")
    page.wait_for_function("document.querySelector('#predict-marker input[type=number]').value === '5'")
    expect(page.locator("#predict-status .pd-done")).to_contain_text("Made")  # the prediction begins by itself
    predict(page)
    page.wait_for_function(f"{SAMPLE}.frames === 210 && {SAMPLE}.past_until === 150")
    page.click("button#predict-continue")  # and on from there
    page.wait_for_function("document.querySelector('#predict-marker input[type=number]').value === '7'")
    assert marker(page) == 7.0
