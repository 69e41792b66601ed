"""The History tab and links, in a browser; the page may ask no other host for anything."""

from __future__ import annotations

import re
import zipfile
from collections.abc import Callable
from pathlib import Path

import pytest
from playwright.sync_api import expect

from motion.formats import write
from tests.ui.stub_engine import walking

from .playing import choose, set_number, unfold

pytestmark = [pytest.mark.e2e, pytest.mark.slow]
SLOW = 120_000


def test_a_result_is_kept_and_its_link_opens_it_with_all_controls(lab: str, open_page: Callable) -> None:
    page = open_page(lab)
    page.set_default_timeout(SLOW)
    page.wait_for_selector("#generate:enabled")
    page.fill("#prompt textarea", "Two people walk up to each other.")
    unfold(page, "#more")
    for control, value in (("seed", "77"), ("steps", "12"), ("guidance", "4.5"), ("seconds", "2.5")):
        set_number(page, f"#{control}", value)
    page.click("#generate")
    page.wait_for_selector("#status .pd-done")
    page.click("button[role=tab]:has-text('History')")
    page.wait_for_selector(".pdn-card:has-text('seed 77')")
    page.click("#history-link")
    box = page.locator("#history-address textarea, #history-address input")
    box.wait_for()
    page.wait_for_function("document.querySelector('#history-address textarea, #history-address input').value")
    link = box.input_value()
    assert re.fullmatch(re.escape(lab) + r"\?run=[\w-]{24}", link)

    other = open_page(link)
    other.set_default_timeout(SLOW)
    other.wait_for_selector("#status .pd-done:has-text('Made on')")
    assert other.input_value("#prompt textarea") == "Two people walk up to each other."
    unfold(other, "#more")
    for control, value in (("seed", "77"), ("seconds", "2.5"), ("guidance", "4.5"), ("steps", "12")):
        assert other.locator(f"#{control} input[type=number]").first.input_value() == value
    unfold(other, "#downloads")
    other.wait_for_selector("#download-npz:not([disabled])")

    page.click("#history-revoke")
    page.wait_for_selector("#history-status :text('Its link no longer works')")
    other.reload()
    other.wait_for_selector("#status .pd-error:has-text('There is no such run')", timeout=SLOW)
    page.reload()  # the last result of this tab of the browser is there again
    page.wait_for_selector("#status .pd-done:has-text('Made on')")
    assert page.input_value("#prompt textarea") == "Two people walk up to each other."


def test_a_class_a_reaction_and_a_prediction_open_as_they_were(lab: str, open_page: Callable, tmp_path: Path) -> None:
    file = write(walking(2.0).a, tmp_path / "my walk.bvh")[0]
    page = open_page(lab)
    page.set_default_timeout(SLOW)
    page.locator("#way").get_by_text("A class").click()
    page.locator("#class input").click()
    page.keyboard.type("high five")
    page.keyboard.press("Enter")
    page.click("#generate")
    page.wait_for_selector("#status .pd-done")
    page.locator("#way").get_by_text("A sentence").click()

    page.click("button[role=tab]:has-text('React')")
    page.wait_for_selector("#react-status :text('high five:')")  # it begins with the last result
    page.set_input_files("#react-file input[type=file]", str(file))
    page.wait_for_selector("#react-status :text('my walk')")
    unfold(page, "#react-advanced")
    choose(page, "#react-method", "ReGenNet, offline")
    set_number(page, "#react-steps", "7")
    page.click("button#react-generate")
    page.wait_for_selector("#react-status .pd-done:has-text('Made')")
    choose(page, "#react-method", "Automatic")
    page.locator("#react-file button[aria-label='Clear']").click()

    page.click("button[role=tab]:has-text('Predict')")
    page.wait_for_selector("#predict-status :text('two people')")
    page.set_input_files("#predict-file input[type=file]", str(file))
    page.wait_for_selector("#predict-status :text('one person, 2.0 s')")
    for control, value in (("marker", "1.5"), ("seconds", "1")):
        set_number(page, f"#predict-{control}", value)
    page.click("button#predict-generate")
    page.wait_for_selector("#predict-status .pd-done:has-text('Made')")

    def opened(card: str, prefix: str) -> None:
        page.click("button[role=tab]:has-text('History')")
        page.click(f".pdn-card:has-text('{card}') >> nth=0")
        page.click("#history-open")
        page.wait_for_selector(f"#{prefix}status .pd-done:has-text('Made on')")

    opened("Reaction to", "react-")
    expect(page.locator("#react-method input")).to_have_value("ReGenNet, offline", timeout=SLOW)
    expect(page.locator("#react-steps input[type=number]")).to_have_value("7", timeout=SLOW)
    expect(page.locator("#react-pace label.selected")).to_have_count(0)  # neither fast nor faithful
    expect(page.locator("#react-end input[type=number]")).to_have_value("2", timeout=SLOW)
    opened("high five", "")
    expect(page.locator("#class input")).to_have_value("high five", timeout=SLOW)
    expect(page.locator("#prompt")).to_be_hidden()
    expect(page.locator("#pace label.selected")).to_have_text("Faithful", timeout=SLOW)
    opened("After my walk", "predict-")
    sample = "window.__pasdedeux.player.sample"
    page.wait_for_function(f"{sample}?.past_until === 45 && {sample}.frames === 75 && {sample}.ghost !== null")
    expect(page.locator("#predict-readouts")).to_contain_text("Holding the last pose would have been", timeout=SLOW)


def test_a_notebook_is_searched_written_in_and_taken_along(lab: str, open_page: Callable, tmp_path: Path) -> None:
    page = open_page(lab)
    page.set_default_timeout(SLOW)
    prompts = (f"They bow in the rehearsal{', and they bow again' * 10}.", "They salute in the rehearsal.")
    for prompt in prompts:
        page.fill("#prompt textarea", prompt)
        page.click("#generate:enabled")
        expect(page.locator("#player .pdd-title")).to_have_text(prompt, timeout=SLOW)
    page.evaluate(
        "(() => { const p = window.__pasdedeux.player; p.act('play'); p.seek(42); p.orbit.turn(0.5, 0.1); })()"
    )
    yaw = page.evaluate("window.__pasdedeux.player.orbit.yaw")
    page.click("#share")
    address = "document.querySelector('#address textarea, #address input')?.value"
    page.wait_for_function(address)
    link = page.evaluate(address)

    page.click("button[role=tab]:has-text('History')")
    cards = page.locator(".pdn-card")
    page.fill("[data-find=words]", "rehearsal")
    expect(cards).to_have_count(2, timeout=SLOW)
    drawn = "[...document.querySelector('.pdn-thumb').getContext('2d').getImageData(0, 0, 88, 88).data].join()"
    first = page.evaluate(drawn)
    page.wait_for_function(f"({drawn}) !== {first!r}")  # it moves
    page.click(".pdn-card >> nth=0 >> summary")
    for field, value in (("title", "<b>The salute</b>"), ("tags", "paper"), ("note", "Hands late")):
        page.fill(f"[data-field={field}]", value)
    page.click("[data-save]")
    expect(cards.first).to_contain_text("<b>The salute</b>")
    expect(cards.first).to_contain_text("Hands late")
    page.click(".pdn-card >> nth=1 >> summary")
    page.fill(".pdn-card >> nth=1 >> [data-field=tags]", "long")  # of a run whose prompt is longer than a name may be
    page.click(".pdn-card >> nth=1 >> [data-save]")
    expect(cards.nth(1).locator(".pdn-tags")).to_have_text("#long", timeout=SLOW)
    asked = """(() => {
        const notebook = document.querySelector(".pdn").notebook, limits = [], { tell } = notebook;
        notebook.tell = ({ limit }) => limits.push(limit);
        notebook.search(120);
        notebook.act("favour");
        Object.assign(notebook, { tell, limit: null });
        return limits;
    })()"""
    assert page.evaluate(asked) == [120, 120], "what is done to a run leaves as many shown"
    page.fill("[data-find=words]", "rehearsal late salute")
    expect(cards).to_have_count(1, timeout=SLOW)
    page.fill("[data-find=words]", "rehearsal")
    expect(cards).to_have_count(2, timeout=SLOW)

    page.check(".pdn-card >> nth=1 >> .pdn-pick input")
    page.click("#history-export")
    page.wait_for_selector("#history-status :text('2 runs in one file')")
    with page.expect_download(timeout=SLOW) as download:
        page.click("#history-saved")
    with zipfile.ZipFile(download.value.path()) as archive:
        archive.extractall(tmp_path)
    page.click("#history-study")
    expect(page.locator("#history-saved")).to_be_hidden(timeout=SLOW)  # something else is done now
    page.click("#history-remove")
    expect(cards).to_have_count(0, timeout=SLOW)
    page.click("#history-restore")
    expect(cards).to_have_count(2, timeout=SLOW)
    page.click("#history-files button >> nth=0")
    page.set_input_files("#history-import input[type=file]", sorted(tmp_path.glob("*.npz")))
    page.wait_for_selector("#history-status :text('Imported 2 runs')")
    expect(cards).to_have_count(4, timeout=SLOW)
    last = cards.last.get_attribute("data-id")
    cards.last.press("Delete")  # which was not chosen
    expect(page.locator(f".pdn-card[data-id='{last}']")).to_have_count(0, timeout=SLOW)

    other = open_page(link)
    other.set_default_timeout(SLOW)
    other.wait_for_selector("#status .pd-done:has-text('Made on')")
    other.wait_for_function("window.__pasdedeux?.frame === 42 && !window.__pasdedeux?.playing")
    expect(other.locator("#player .pdd-title")).to_have_text("<b>The salute</b>")
    assert other.evaluate("window.__pasdedeux.player.orbit.yaw") == pytest.approx(yaw, abs=0.01)
