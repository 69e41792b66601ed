"""The History tab and links, in a browser; the page may ask no other host for anything."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import pytest

pytestmark = [pytest.mark.e2e, pytest.mark.slow]
SLOW = 120_000


@pytest.fixture(scope="module")
def lab(start_server: Callable[..., str], tmp_path_factory: pytest.TempPathFactory) -> str:
    data = str(tmp_path_factory.mktemp("lab"))
    env = {"STUB_PAUSE": "0", "PASDEDEUX_FREE_MEGABYTES": "0"}
    return start_server([str(Path("tests/server/lab.py")), "{port}", data], seconds=180, env=env)


def test_a_result_is_kept_and_its_link_opens_it_with_all_controls(lab: str, open_page: Callable) -> None:
    page = open_page(lab)
    page.set_default_timeout(SLOW)
    page.fill("#prompt textarea", "Two people walk up to each other.")
    for control, value in (("seed", "77"), ("steps", "12"), ("guidance", "4.5"), ("seconds", "2.5")):
        page.locator(f"#{control} input[type=number]").first.fill(value)
        page.locator(f"#{control} input[type=number]").first.press("Tab")
    page.click("#generate")
    page.wait_for_selector("#status .pd-done")
    page.click("button[role=tab]:has-text('History')")
    page.wait_for_selector("#history-list label:has-text('seed 77')")
    page.click("#history-link")
    box = page.locator("#history-address textarea, #history-address input")
    box.wait_for()
    page.wait_for_function(
        "document.querySelector('#history-address textarea, #history-address input').value"
    )
    link = box.input_value()
    assert re.fullmatch(re.escape(lab) + r"\?run=[\w-]{24}", link)
    page.click("#history-again")
    page.wait_for_selector("#history-status :text('the same motion, bit for bit')")

    other = open_page(link)
    other.set_default_timeout(SLOW)
    other.wait_for_selector("#status .pd-done:has-text('Made on')")
    assert other.input_value("#prompt textarea") == "Two people walk up to each other."
    for control, value in (("seed", "77"), ("steps", "12"), ("guidance", "4.5"), ("seconds", "2.5")):
        assert other.locator(f"#{control} input[type=number]").first.input_value() == value
    other.wait_for_selector("#download-npz:not([disabled])")

    page.click("#history-revoke")
    page.wait_for_selector("#history-status :text('1 links to it no longer work')")
    ended = open_page(link)
    ended.wait_for_selector("#status .pd-error:has-text('There is no such run')", timeout=SLOW)


def test_a_forged_link_is_a_sentence(lab: str, open_page: Callable) -> None:
    page = open_page(f"{lab}?run=../../etc/passwd<script>window.__hacked=1</script>")
    page.wait_for_selector("#status .pd-error:has-text('There is no such run')", timeout=SLOW)
    assert page.evaluate("window.__hacked") is None
