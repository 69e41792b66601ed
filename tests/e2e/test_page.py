"""The whole page in a real browser, with an engine that needs no networks.

Every page comes from ``open_page``, which fails a test whose page asks another host or has a script error.
"""

from __future__ import annotations

import json
import re
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from playwright.sync_api import Page, Route, expect

from webdemo.ui.tabs import results

from .playing import unfold
from .serving import SLOW, ask, live, status

pytestmark = pytest.mark.e2e

HOSTILE = (
    "<img src=x onerror=\"window.hacked='img'\">",
    "${(window.hacked='template')}{{value}}",
    "</script><script>window.hacked='script'</script>",
    "`${alert(1)}` 🕺💃 שלום 你好",
)
ERRORS = {
    "": "The prompt is empty",
    "x" * 10_000: "The prompt has 10,000 characters",
    "something impossible": "The stub cannot do this",
    "a crash": "Something went wrong inside the program (RuntimeError)",
}
PAUSE = 0.01
"""Seconds that a step of the stub takes, where a test does not look at the steps."""
LONG_STEP = 1.0
"""Seconds that a step takes where a run must still go on when a browser on a busy machine is ready to press."""


@pytest.fixture
def page(server: SimpleNamespace, open_page: Callable[..., Page]) -> Page:
    return live(open_page(server.url))


@pytest.fixture
def slow_steps(server: SimpleNamespace) -> Iterator[None]:
    """Steps slow enough for a browser on a busy machine to be seen following them."""
    server.engine.pause = 0.12
    yield
    server.engine.pause = PAUSE


@pytest.fixture
def phone(server: SimpleNamespace, open_page: Callable[..., Page]) -> Page:
    return live(open_page(server.url, width=390, height=844))


def wait_for_line(page: Page, pattern: str) -> None:
    expect(page.locator("#status")).to_contain_text(re.compile(pattern), timeout=SLOW)


def shown_id(page: Page) -> str | None:
    return page.evaluate("window.__pasdedeux?.id ?? null")


def set_number(page: Page, selector: str, value: float) -> None:
    field = page.locator(f"{selector} input[type=number]")
    field.fill(str(value))
    field.press("Tab")


def test_a_motion_plays_before_anything_is_asked(page: Page) -> None:
    expect(page.locator(".pdd-title").first).to_have_text(
        "Two people walk up to each other and shake hands.", timeout=SLOW
    )
    page.wait_for_function("window.__pasdedeux?.frame > 5", timeout=SLOW)
    expect(page.locator("#player .pdd-empty")).to_be_hidden()
    expect(page.locator("#downloads")).to_be_hidden()


def test_a_prompt_becomes_two_moving_people(page: Page, server: SimpleNamespace) -> None:
    ask(page, "two people walk up to each other")
    assert status(page, "done").startswith("Made in")
    page.wait_for_function("window.__pasdedeux?.positions?.length === 2")
    first = page.evaluate("window.__pasdedeux.positions")
    pose = "window.__pasdedeux.positions[person]"
    moved = f"{pose}.some((joint, j) => joint.some((v, i) => Math.abs(v - was[j][i]) > 0.05))"
    for person in (0, 1):
        page.wait_for_function(f"([person, was]) => {moved}", arg=[person, first[person]], timeout=SLOW)
    expect(page.locator("#readouts")).to_contain_text("Foot skate")
    expect(page.locator("#readouts")).to_contain_text("Before")
    assert server.engine.requests[-1].prompt == "two people walk up to each other"


def test_enter_and_ctrl_enter_generate(page: Page) -> None:
    for keys in ("Enter", "Control+Enter"):
        expect(page.locator("button#generate")).to_be_enabled(timeout=SLOW)
        page.fill("#prompt textarea", f"two people wave, says {keys}")
        page.press("#prompt textarea", keys)
        expect(page.locator(".pdd-title")).to_have_text(f"two people wave, says {keys}", timeout=SLOW)
        status(page, "done")


def test_chips_fill_the_prompt(page: Page) -> None:
    page.click("button.pd-chip >> nth=0")
    expect(page.locator("#prompt textarea")).to_have_value("Two people walk up to each other and shake hands.")
    expect(page.locator("#prompt textarea")).to_be_focused()


def test_a_class_is_chosen_from_the_list(page: Page, server: SimpleNamespace) -> None:
    page.locator("#way").get_by_text("A class").click()
    expect(page.locator("#prompt")).to_be_hidden()
    page.click("button#generate")
    assert status(page, "error").startswith("No class is chosen")
    page.locator("#class input").click()
    page.keyboard.type("shake")
    page.keyboard.press("Enter")
    expect(page.locator("#class input")).to_have_value("shake hands")
    page.click("button#generate")
    expect(page.locator(".pdd-title")).to_have_text("shake hands", timeout=SLOW)
    asked = server.engine.requests[-1]
    assert (asked.model, asked.prompt) == ("bigraphdiff", "shake hands")
    page.locator("#way").get_by_text("A sentence").click()
    expect(page.locator("#prompt")).to_be_visible()
    expect(page.locator("#class")).to_be_hidden()


def test_progress_counts_the_steps_in_text_and_over_the_player(page: Page, slow_steps: None) -> None:
    page.locator("#pace label", has_text="Faithful").click()  # many steps, so that the run is seen
    ask(page, "two people bow")
    page.wait_for_function(
        "/step \\d+ of 50/.test(document.querySelector('#status').innerText) &&"
        "/step \\d+ of 50/.test(document.querySelector('.pdd-busy-text').innerText)",
        timeout=SLOW,
    )
    assert page.locator("button#cancel").is_enabled()
    status(page, "done")
    expect(page.locator(".pdd-busy")).to_be_hidden()
    expect(page.locator("button#cancel")).to_be_disabled()


def test_cancel_stops_at_a_step_and_keeps_the_last_motion(page: Page, server: SimpleNamespace) -> None:
    page.locator("#pace label", has_text="Faithful").click()  # many steps, so that the run is seen
    ask(page, "two people hug")
    status(page, "done")
    before = shown_id(page)
    server.engine.pause = LONG_STEP
    try:
        ask(page, "two people dance for long")
        wait_for_line(page, r"step \d+ of")
        page.click("button#cancel")
        line = status(page, "warning")
    finally:
        server.engine.pause = PAUSE
    assert line.startswith("Cancelled at step")
    assert line.endswith("of 50.")
    done = server.engine.steps_done
    assert abs(int(line.split()[3]) - done) <= 1
    time.sleep(3 * LONG_STEP)
    assert server.engine.steps_done <= done + 1, "the loop went on after the step in which it was cancelled"
    assert shown_id(page) == before
    expect(page.locator(".pdd-busy")).to_be_hidden()
    ask(page, "two people hug again")
    status(page, "done")


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
        page.locator("#pace label", has_text="Faithful").click()  # many steps, so that the run is seen
        ask(page, "two people hug")
        status(page, "done")
        expect(page.locator("button#generate")).to_be_enabled(timeout=SLOW)
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


def test_errors_are_sentences_and_the_next_request_works(page: Page) -> None:
    for prompt, sentence in ERRORS.items():
        ask(page, prompt)
        expect(page.locator("#status .pd-error")).to_contain_text(sentence, timeout=SLOW)
        assert "Traceback" not in page.content()
    ask(page, "two people shake hands")
    status(page, "done")


def test_hostile_prompts_are_shown_literally_and_run_nothing(page: Page) -> None:
    for prompt in HOSTILE:
        ask(page, prompt + " unknown")
        expect(page.locator(".pdd-title")).to_have_text(prompt + " unknown", timeout=SLOW)
        status(page, "done")
        expect(page.locator("#status .pd-warning")).to_contain_text("<b>hello</b>")
    page.wait_for_timeout(200)
    assert page.evaluate("window.hacked ?? null") is None
    assert page.locator("img[src='x']").count() == 0


def test_the_used_seed_is_shown_and_repeats_the_motion(page: Page, server: SimpleNamespace, slow_steps: None) -> None:
    unfold(page, "#more")
    page.locator("#seed input").fill("")
    ask(page, "two people walk")
    status(page, "done")
    seed = server.engine.requests[-1].seed
    expect(page.locator(".pd-asked")).to_contain_text(str(seed))
    first = shown_id(page)
    page.click("button#dice")
    page.wait_for_function("document.querySelector('#seed input').value !== ''")
    page.locator("#seed input").fill(str(seed))
    seen = len(server.engine.requests)
    ask(page, "two people walk")
    expect(page.locator("button#cancel")).to_be_enabled(timeout=SLOW)
    expect(page.locator("button#generate")).to_be_enabled(timeout=SLOW)
    assert [request.seed for request in server.engine.requests[seen:]] == [seed]
    assert shown_id(page) == first


def test_samples_become_tabs_and_columns(page: Page) -> None:
    unfold(page, "#more")
    set_number(page, "#samples", 3)
    ask(page, "two people walk")
    assert status(page, "done").startswith("3 samples")
    expect(page.locator(".pdd-tabs button")).to_have_count(3)
    expect(page.locator("#readouts")).to_contain_text("Sample 3")


def test_downloads_are_files(page: Page, tmp_path: Path) -> None:
    ask(page, "two people walk home")
    status(page, "done")
    unfold(page, "#downloads", "#share")
    button = page.locator("#download-json")
    expect(button).to_be_enabled(timeout=SLOW)
    with page.expect_download() as waiting:
        button.click()
    path = tmp_path / "manifest.json"
    waiting.value.save_as(path)
    assert waiting.value.suggested_filename.startswith("two-people-walk-home-seed")
    assert json.loads(path.read_text())["request"]["prompt"] == "two people walk home"
    for kind in ("npz", "bvh", "png"):
        with page.expect_download() as waiting:
            page.locator(f"#download-{kind}").click()
        assert Path(waiting.value.path()).stat().st_size > 1000


def test_a_button_never_gives_the_file_of_the_run_before(page: Page, monkeypatch: pytest.MonkeyPatch) -> None:
    ask(page, "two people walk home")
    status(page, "done")
    unfold(page, "#downloads")
    button = page.locator("#download-json")
    expect(button).to_be_enabled(timeout=SLOW)
    written = threading.Event()
    write_record = results.write_record
    monkeypatch.setattr(results, "write_record", lambda *given: written.wait(60) and write_record(*given))
    try:
        ask(page, "two people hug")
        expect(page.locator("#player .pdd-title")).to_have_text("two people hug", timeout=SLOW)
        expect(page.locator("button#generate")).to_be_enabled(timeout=SLOW)
        expect(button).to_be_disabled()
    finally:
        written.set()
    expect(button).to_be_enabled(timeout=SLOW)
    with page.expect_download() as waiting:
        button.click()
    assert json.loads(Path(waiting.value.path()).read_text())["request"]["prompt"] == "two people hug"


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
