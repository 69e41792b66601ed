"""The whole page in a real browser, with an engine that needs no networks.

Every page comes from ``open_page``, which fails a test whose page asks another host or has a script error.
"""

from __future__ import annotations

import json
import re
import threading
import time
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from playwright.sync_api import Page, Route, expect

from webdemo.ui.tabs import results

from .playing import set_number, unfold
from .serving import SLOW, ask, live, status

pytestmark = pytest.mark.e2e

HOSTILE = (
    "<img src=x onerror=\"window.hacked='img'\"> ${(window.hacked='template')}{{value}} "
    "</script><script>window.hacked='script'</script> `${alert(1)}` 🕺💃 שלום 你好 unknown"
)
ERRORS = {
    "": "The prompt is empty",
    "something impossible": "The stub cannot do this",
    "a crash": "Something went wrong inside the program (RuntimeError)",
}
PAUSE = 0.01
"""Seconds that a step of the stub takes, where a test does not look at the steps."""
LONG_STEP = 1.0
"""Seconds that a step takes where a run must still go on when a browser on a busy machine is ready to press."""


@pytest.fixture
def page(shared_page: Page) -> Page:
    """The tab Generate, as the test before left it."""
    expect(shared_page.locator("button#generate")).to_be_enabled()
    return shared_page


@pytest.fixture
def phone(server: SimpleNamespace, open_page: Callable[..., Page]) -> Page:
    return live(open_page(server.url, width=390, height=844))


def wait_for_line(page: Page, pattern: str) -> None:
    expect(page.locator("#status")).to_contain_text(re.compile(pattern))


def shown_id(page: Page) -> str | None:
    return page.evaluate("window.__pasdedeux?.player?.data?.id ?? null")


def made(page: Page, prompt: str) -> str:
    """Makes a motion of a sentence that was not asked for yet, and gives the line on it."""
    ask(page, prompt)
    expect(page.locator("#player .pdd-title")).to_have_text(prompt)
    return status(page, "done")


def test_a_motion_plays_first_and_then_that_of_a_sentence(page: Page, server: SimpleNamespace) -> None:
    title = page.locator("#player .pdd-title")
    expect(title).to_have_text("Two people walk up to each other and shake hands.")
    page.wait_for_function("window.__pasdedeux?.frame > 5", timeout=SLOW)
    expect(page.locator("#downloads")).to_be_hidden()
    page.click("button.pd-chip >> nth=0")
    expect(page.locator("#prompt textarea")).to_have_value("Two people walk up to each other and shake hands.")
    assert status(page, "done").startswith("Made in"), "an example is made at once"
    for keys in ("Enter", "Control+Enter"):
        expect(page.locator("button#generate")).to_be_enabled()
        page.fill("#prompt textarea", f"two people walk, says {keys}")
        page.press("#prompt textarea", keys)
        expect(title).to_have_text(f"two people walk, says {keys}")
        assert status(page, "done").startswith("Made in")
    first = page.evaluate("window.__pasdedeux.positions")
    moved = "(joint, j) => joint.some((v, i) => Math.abs(v - was[j][i]) > 0.05)"
    for person in (0, 1):
        page.wait_for_function(
            f"([person, was]) => window.__pasdedeux.positions[person].some({moved})",
            arg=[person, first[person]],
            timeout=SLOW,
        )
    page.locator("#readouts summary").click()
    expect(page.locator("#readouts")).to_contain_text("Foot skate")
    assert server.engine.requests[-1].prompt == "two people walk, says Control+Enter"


def test_a_class_is_chosen_from_the_list(page: Page, server: SimpleNamespace) -> None:
    page.fill("#prompt textarea", "They hug.")
    page.locator("#way").get_by_text("A class").click()
    expect(page.locator("#prompt")).to_be_hidden()
    page.click("button#generate")
    assert status(page, "error").startswith("No class is chosen")
    page.locator("#way").get_by_text("A sentence").click()
    expect(page.locator("#reading .pdr-chip")).to_be_visible()
    expect(page.locator("#status .pd-error")).to_be_hidden()
    page.locator("#way").get_by_text("A class").click()
    page.locator("#class input").click()
    page.keyboard.type("shake")
    page.keyboard.press("Enter")
    expect(page.locator("#class input")).to_have_value("shake hands")
    page.click("button#generate:enabled")
    expect(page.locator("#player .pdd-title")).to_have_text("shake hands")
    asked = server.engine.requests[-1]
    assert (asked.model, asked.prompt) == ("bigraphdiff", "shake hands")
    page.locator("#way").get_by_text("A sentence").click()
    expect(page.locator("#class")).to_be_hidden()


def test_progress_is_told_and_cancel_keeps_the_last_motion(page: Page, server: SimpleNamespace) -> None:
    page.locator("#pace label", has_text="Faithful").click()  # many steps, so that the run is seen
    made(page, "two people hug")
    expect(page.locator("#player .pdd-busy")).to_be_hidden()
    before = shown_id(page)
    server.engine.pause = LONG_STEP
    try:
        ask(page, "two people dance for long")
        wait_for_line(page, r"step \d+ of 50")
        expect(page.locator("#player .pdd-busy-text")).to_contain_text("of 50")
        page.click("button#cancel")
        line = status(page, "warning")
    finally:
        server.engine.pause = PAUSE
    assert line.startswith("Cancelled at step")
    assert line.endswith("of 50.")
    done = server.engine.steps_done
    assert abs(int(line.split()[3]) - done) <= 1
    time.sleep(2 * LONG_STEP)
    assert server.engine.steps_done <= done + 1, "the loop went on after the step in which it was cancelled"
    assert shown_id(page) == before
    expect(page.locator("#player .pdd-busy")).to_be_hidden()
    expect(page.locator("button#cancel")).to_be_disabled()


def test_a_run_can_be_cancelled_whose_first_updates_arrive_together(
    page: Page, server: SimpleNamespace, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Gradio holds back what comes before the answer to a press, and then applies only the last of it."""
    written = threading.Event()
    write_record = results.write_record

    def slowly(*given: Any) -> Any:
        written.wait(SLOW / 1000)
        return write_record(*given)

    def late(route: Route) -> None:
        answer = route.fetch()
        time.sleep(2)
        route.fulfill(response=answer)

    monkeypatch.setattr(results, "write_record", slowly)  # so that the page goes on listening to the server
    try:
        made(page, "two people hug once more")
        expect(page.locator("button#generate")).to_be_enabled()
        unfold(page, "#downloads")
        page.route("**/queue/join*", late)
        server.engine.pause = LONG_STEP
        ask(page, "two people dance for long")
        wait_for_line(page, r"step \d+ of")
        expect(page.locator("button#generate")).to_be_disabled()
        page.click("button#cancel", timeout=5000)
        assert status(page, "warning").startswith("Cancelled at step")
    finally:
        written.set()
        server.engine.pause = PAUSE
        page.unroute("**/queue/join*")


def test_errors_are_sentences_and_hostile_prompts_are_shown_literally(page: Page) -> None:
    page.locator("#pace label", has_text="Fast").click()
    for prompt, sentence in ERRORS.items():
        ask(page, prompt)
        expect(page.locator("#status .pd-error")).to_contain_text(sentence)
        assert "Traceback" not in page.content()
    made(page, HOSTILE)
    expect(page.locator("#status .pd-warning").first).to_contain_text("<b>hello</b>")
    page.locator("#prompt textarea").press_sequentially(" They bow.")
    expect(page.locator("#status .pd-warning")).to_be_hidden()
    assert page.evaluate("window.hacked ?? null") is None
    assert page.locator("img[src='x']").count() == 0


def test_an_empty_seed_is_drawn_and_samples_become_tabs(page: Page, server: SimpleNamespace) -> None:
    unfold(page, "#more")
    set_number(page, "#seed", "")
    set_number(page, "#samples", 3)
    ask(page, "two people stroll")
    expect(page.locator("#status .pd-done")).to_contain_text("3 samples")
    expect(page.locator("#player .pdd-tabs button")).to_have_count(3)
    expect(page.locator("#readouts .pd-asked")).to_contain_text(str(server.engine.requests[-1].seed))
    set_number(page, "#samples", 1)
    seen = len(server.engine.requests)
    page.click("#another:enabled")
    expect(page.locator("#player .pdd-tabs")).to_be_hidden()
    page.wait_for_function("document.querySelector('#seed input').value !== ''")
    assert server.engine.requests[seen].seed == int(page.input_value("#seed input"))


def test_downloads_are_files_and_never_those_of_the_run_before(page: Page, monkeypatch: pytest.MonkeyPatch) -> None:
    made(page, "two people walk home")
    unfold(page, "#downloads")
    button = page.locator("#download-json")
    expect(button).to_be_enabled()
    for kind in ("npz", "bvh", "png"):
        with page.expect_download() as waiting:
            page.locator(f"#download-{kind}").click()
        assert Path(waiting.value.path()).stat().st_size > 1000
    written = threading.Event()
    write_record = results.write_record
    monkeypatch.setattr(results, "write_record", lambda *given: written.wait(60) and write_record(*given))
    try:
        made(page, "two people hug at last")
        expect(page.locator("button#generate")).to_be_enabled()
        unfold(page, "#downloads")
        expect(button).to_be_disabled()
    finally:
        written.set()
    expect(button).to_be_enabled()
    with page.expect_download() as waiting:
        button.click()
    assert waiting.value.suggested_filename.startswith("two-people-hug-at-last-seed")
    assert json.loads(Path(waiting.value.path()).read_text())["request"]["prompt"] == "two people hug at last"


def test_undo_brings_the_motion_before_and_its_words(page: Page) -> None:
    for prompt in ("two people nod", "two people skip"):
        made(page, prompt)
        expect(page.locator("button#generate")).to_be_enabled()
    page.click("#undo")
    expect(page.locator("#player .pdd-title")).to_have_text("two people nod")
    expect(page.locator("#prompt textarea")).to_have_value("two people nod")
    unfold(page, "#downloads")
    with page.expect_download() as waiting:
        page.click("#download-json:enabled")
    assert waiting.value.suggested_filename.startswith("two-people-nod-seed")
    page.focus("#player .pdd")
    page.keyboard.press("Escape")
    expect(page.locator("#download-json")).to_be_hidden()


def test_two_sessions_do_not_cancel_each_other(page: Page, phone: Page, server: SimpleNamespace) -> None:
    for each in (page, phone):
        each.locator("#pace label", has_text="Faithful").click()  # many steps, so that the run is seen
    server.engine.pause = LONG_STEP
    try:
        ask(page, "the first of two")
        wait_for_line(page, r"step \d+ of")
        ask(phone, "the second of two")
        wait_for_line(phone, "Waiting in line: place 1 of 1")
        phone.click("button#cancel")
        assert status(phone, "warning").startswith("Cancelled")
        expect(page.locator("#status .pd-busy")).to_be_visible()
        server.engine.pause = PAUSE
        status(page, "done")
    finally:
        server.engine.pause = PAUSE
