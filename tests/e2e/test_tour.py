"""A visit to what ``python app.py`` serves: every control of the tab Generate is used twice, with the shipped networks.

Nothing may be refused, no error may be shown, no script may fail, and the server's log may tell of no error.
"""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace

import pytest
from playwright.sync_api import Page, expect

from tests.motion.formats.characters import a_pose, glb_character

from .conftest import FLAGS, Tabs
from .playing import choose
from .test_camera import FILM, as_mjpeg
from .touring import SLOW, Tour

pytestmark = [pytest.mark.e2e, pytest.mark.slow]

EXCUSED = {
    r"/ show-api|/ Use via API": "opens Gradio's own panel",
    r"player / act=fullscreen": "full screen has no window to fill here",
    r"/ continue / |-continue / ": "leads to the tab Predict, where it is used",
    r"cancel / ": "can be pressed only while a run goes on: each tab cancels one",
}
"""Patterns of controls that are not used twice, and why."""


@pytest.fixture(scope="module")
def tour(_app: SimpleNamespace) -> Tour:
    return Tour(_app.log)


@pytest.fixture(scope="module")
def visit(
    chromium, lab: str, tour: Tour, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[SimpleNamespace]:
    """The page in a browser with a webcam, which shows a film of somebody who waves."""
    film = as_mjpeg(FILM, tmp_path_factory.mktemp("film") / "wave.mjpeg")
    flags = ["--use-fake-ui-for-media-stream", "--use-fake-device-for-media-stream"]
    flags.append(f"--use-file-for-fake-video-capture={film}")
    browser = chromium.browser_type.launch(executable_path=shutil.which("chromium"), args=[*FLAGS, *flags])
    context = browser.new_context(viewport={"width": 1200, "height": 900})
    context.grant_permissions(["clipboard-read", "clipboard-write"])
    tabs = Tabs(browser, context)
    page = tabs.open(lab, before=tour.watch, width=1200, height=900)
    page.set_default_timeout(SLOW)
    expect(page.locator("#model-state")).to_contain_text("Model ready", timeout=SLOW)
    yield SimpleNamespace(page=page, tabs=tabs)
    browser.close()


@pytest.fixture
def page(visit: SimpleNamespace, tour: Tour) -> Iterator[Page]:
    yield visit.page
    wrong = tour.wrong[:]
    tour.wrong.clear()
    assert not wrong, f"the page told of errors: {wrong}"
    visit.tabs.check()


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
    page.evaluate("document.querySelectorAll('.pdd').forEach((e) => e.player?.clock?.pause())")


def twice(action: Callable[[], object]) -> None:
    for _ in range(2):
        action()


def cancelled(page: Page, tour: Tour, prefix: str = "") -> None:
    """Starts a long run and cancels it."""
    page.click(f"#{prefix}generate:enabled")
    page.click(f"#{prefix}cancel:enabled")
    expect(page.locator(f"#{prefix}status .pd-warning")).to_contain_text("Cancelled", timeout=SLOW)
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
        expect(page.locator(f"#{prefix}status .pd-done")).to_be_visible(timeout=SLOW)
    still(page)


def with_result(page: Page, tour: Tour, prefix: str, character: Path) -> None:
    """Uses what is offered for a result: a character, a film, and a link."""
    for _ in range(2):
        uploaded(page, tour, f"#{prefix}character", character)
        pressed(page, tour, f"#{prefix}film", 1)
        pressed(page, tour, f"#{prefix}download-film:enabled", 1)
        pressed(page, tour, f"#{prefix}link", 1)


def all_used(page: Page, tour: Tour, tab: str) -> None:
    tour.press_rest(page, tab, EXCUSED)
    assert tour.missing(EXCUSED, tab=tab) == []


@pytest.fixture(scope="module")
def character(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A rigged character of somebody else's."""
    file = tmp_path_factory.mktemp("character") / "x.glb"
    file.write_bytes(glb_character("unreal", places=a_pose()))
    return file


def test_generate(page: Page, tour: Tour, character: Path) -> None:
    open_all(page)
    page.fill("#prompt textarea", "They bow.")
    number(page, "seconds", 2)
    made(page, tour)
    number(page, "seconds", 10)
    number(page, "samples", 4)
    number(page, "steps", 100)
    twice(lambda: cancelled(page, tour))
    number(page, "seconds", 2)
    number(page, "samples", 1)
    for pace in ("Faithful", "Fast"):
        page.locator("#pace label", has_text=pace).click()
        made(page, tour, times=1)
    page.locator("#way").get_by_text("A class").click()
    for name in ("bow", "hug"):
        page.locator("#class input").click()
        page.keyboard.type(name)
        page.keyboard.press("Enter")
        made(page, tour, times=1)
    page.locator("#way").get_by_text("A sentence").click()
    number(page, "seconds", 2)
    page.fill("#prompt textarea", "They hug.")
    chips(page, tour, "Plain beside damped", "Four seeds", "Sentence beside class")
    choose(page, "#grid-across", "Seeds")
    page.fill("#grid-across-values textarea", "1-2")
    pressed(page, tour, "#grid-make")
    made(page, tour)
    with_result(page, tour, "", character)
    all_used(page, tour, "Generate")


def test_the_log_tells_of_no_error(tour: Tour) -> None:
    assert tour.errors_in_log() == []
