"""What a visitor's hands do on a page, for the tests of the tour."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from playwright.sync_api import Page, expect

from .touring import SLOW, Tour

EXCUSED = {
    r"/ show-api|/ Use via API": "opens Gradio's own panel",
    r"/ finder / ": "opens a dialog over everything: test_finder uses it",
    r"/ gallery / ": "opens a dialog over everything: test_finder uses it",
    r"player / act=fullscreen": "full screen has no window to fill here",
    r"/ continue / |-continue / ": "leads to the tab Predict, where it is used",
    r"cancel / ": "can be pressed only while a run goes on: each tab cancels one",
}
"""Patterns of controls that are not used twice on any tab, and why."""
STILL = "document.querySelectorAll('.pdd').forEach((e) => e.player?.clock?.pause())"


def number(page: Page, name: str, value: float) -> None:
    field = page.locator(f"#{name} input[type=number]")
    field.fill(str(value))
    field.press("Tab")


def open_all(page: Page) -> None:
    """Opens whatever is folded on the tab that is shown."""
    for folded in ("button.label-wrap:not(.open):visible", "details:not([open]) > summary:visible"):
        while (fold := page.locator(folded)).count():
            fold.first.click()


def still(page: Page) -> None:
    """Pauses the players, which take the processor from everything else."""
    page.evaluate(STILL)


def twice(action: Callable[[], object]) -> None:
    for _ in range(2):
        action()


def cancelled(page: Page, tour: Tour, prefix: str = "") -> None:
    """Starts a long run and cancels it; starts again where a slow machine's page hears of a run as it ends."""
    ended = page.locator(f"#{prefix}status").locator(".pd-warning, .pd-done, .pd-error")
    cancel = page.locator(f"#{prefix}cancel:enabled").locator("visible=true")
    for _ in range(3):
        page.click(f"#{prefix}generate:enabled")
        cancel.dispatch_event("click")  # at once: a click waits until the page stands still
        expect(ended).to_be_visible(timeout=SLOW)
        if "pd-done" not in str(ended.get_attribute("class")):
            break
    expect(ended).to_contain_text("Cancelled")
    tour.settle(page)


def pressed(page: Page, tour: Tour, selector: str, times: int = 2) -> None:
    """Presses a button and waits for what it starts."""
    for _ in range(times):
        page.locator(selector).locator("visible=true").first.click()
        tour.settle(page)


def chips(page: Page, tour: Tour, *names: str) -> None:
    """Presses each of the buttons with these names twice."""
    for name in names:
        pressed(page, tour, f"button:has-text('{name}')")


def uploaded(page: Page, tour: Tour, selector: str, file: Path) -> None:
    """Chooses a file in the dialog that a press opens."""
    with page.expect_file_chooser() as chooser:
        page.locator(selector).locator("visible=true").first.click()
    chooser.value.set_files(file)
    tour.settle(page)


def made(page: Page, tour: Tour, prefix: str = "", times: int = 2) -> None:
    """Starts a run and waits for its result."""
    for _ in range(times):
        page.click(f"#{prefix}generate:enabled")
        tour.settle(page)
        assert not tour.wrong, tour.wrong
        expect(page.locator(f"#{prefix}status .pd-done")).to_be_visible(timeout=SLOW)
    still(page)


def with_result(page: Page, tour: Tour, prefix: str, character: Path) -> None:
    """Uses what is offered for a result: a character, a film, a figure and a mesh, and a link.

    A run that begins takes the files of the one before from their buttons, so that they are pressed at once.
    """
    if page.locator(f"#{prefix}another").is_visible():  # a run, whose result takes the place of what is shown
        pressed(page, tour, f"#{prefix}another")
        still(page)
    open_all(page)
    for _ in range(2):
        uploaded(page, tour, f"#{prefix}character", character)
        pressed(page, tour, f"#{prefix}film", 1)
        pressed(page, tour, f"#{prefix}download-film:enabled", 1)
        pressed(page, tour, f"#{prefix}figure", 1)
        for kind in ("html", "ply"):
            pressed(page, tour, f"#{prefix}download-{kind}:enabled", 1)
        pressed(page, tour, f"#{prefix}link", 1)


def read_out(page: Page, tour: Tour, prefix: str) -> None:
    """Folds the figures under a result away and out again, twice."""
    for name in ("All figures", "What the figures mean"):
        pressed(page, tour, f"#{prefix}readouts summary:has-text('{name}')", 4)


def all_used(page: Page, tour: Tour, tab: str, *excused: str) -> None:
    """Uses what is left of a tab; fails where something could be seen and was not used twice, but for patterns."""
    patterns = (*EXCUSED, *excused)
    tour.press_rest(page, tab, patterns)
    left = tour.missing(patterns, tab=tab)
    assert not left, f"not used twice: {[(key, tour.seen[key]) for key in left]}"


def visited(page: Page, tab: str) -> None:
    """Goes to a tab."""
    page.get_by_role("tab", name=tab).click()
    page.locator(f"#{tab.lower()}-status").wait_for(state="attached")


def given(page: Page, tour: Tour, field: str, *files: Path) -> None:
    """Gives files to a field, and clears it twice between."""
    for again in (False, True, True):
        if again:
            pressed(page, tour, f"{field} button[aria-label='Clear']", 1)
        page.set_input_files(f"{field} input[type=file]", files)
        tour.settle(page)


def linked(page: Page, box: str) -> str:
    """The address in a box, once it is there."""
    address = f"document.querySelector('{box} textarea, {box} input')?.value"
    page.wait_for_function(address)
    return str(page.evaluate(address))
