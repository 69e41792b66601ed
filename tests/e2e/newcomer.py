"""Twenty tasks of a newcomer on one page, and the presses that each takes.

A press is a click, a drag or a key; a sentence that is typed counts once. The page itself counts, so nothing that is
done by a visitor's hands is left out. ``docs/newcomer.md`` lists the tasks with these numbers.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from playwright.sync_api import Page, expect

from .playing import until

SLOW = 240_000
"""Milliseconds that a busy machine may take for one thing."""
COUNT = """() => {
    window.presses = 0;
    const count = ({ isTrusted, repeat, key }) => (window.presses += isTrusted && !repeat && key !== "Control" ? 1 : 0);
    for (const kind of ["pointerdown", "keydown"]) window.addEventListener(kind, count, true);
}"""
TIDY = """() => {
    for (const fold of document.querySelectorAll(".pd-menu > .label-wrap.open")) fold.click();
    document.querySelector(".pdd [data-act=play]")?.closest(".pdd").player?.directing.end();
}"""
"""JavaScript that folds menus between two tasks, so that each begins on the page as it is after a run."""


class Newcomer:
    """Somebody with a mouse and a keyboard, whose presses are counted by the page.

    Args:
        page: the application, live; its window is large enough that nothing has to be scrolled to.
        folder: for what is downloaded.
    """

    def __init__(self, page: Page, folder: Path) -> None:
        self.page, self.folder = page, folder
        self.typed = 0
        page.evaluate(COUNT)

    @property
    def presses(self) -> int:
        """Since the page was opened."""
        return int(self.page.evaluate("window.presses")) + self.typed

    def press(self, selector: str) -> None:
        """A click on what can be seen."""
        self.page.locator(f"{selector} >> visible=true").first.click(timeout=SLOW)

    def rest(self, selector: str) -> None:
        """Rests the mouse on what can be seen, which is no press."""
        self.page.locator(f"{selector} >> visible=true").first.hover(timeout=SLOW)

    def type(self, field: str, text: str) -> None:
        """A sentence typed into a field, which the visitor clicks first unless it is ready for it."""
        if not self.page.locator(f"{field} textarea").evaluate("field => field === document.activeElement"):
            self.press(f"{field} textarea")
        self.page.fill(f"{field} textarea", text)
        self.typed += 1

    def drag(self, selector: str, dx: float, dy: float) -> None:
        """A drag from the middle of something."""
        until(self.page, "window.__pasdedeux.loops === 0")
        box = self.page.locator(f"{selector} >> visible=true").first.bounding_box()
        assert box is not None
        x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
        self.page.mouse.move(x, y)
        self.page.mouse.down()
        self.page.mouse.move(x + dx, y + dy, steps=15)
        self.page.mouse.up()

    def track(self, selector: str, share: float) -> None:
        """A click on a slider, at a share of its length."""
        slider = self.page.locator(f"{selector} >> visible=true").first
        slider.scroll_into_view_if_needed()
        box = slider.bounding_box()
        assert box is not None
        self.page.mouse.click(box["x"] + share * box["width"], box["y"] + box["height"] / 2)

    def made(self, act: Callable[[], None]) -> None:
        """Does what starts a run and waits until its motion is there."""
        shown = "window.__pasdedeux.player?.data?.id"
        before = self.page.evaluate(shown)
        act()
        until(self.page, f"{shown} && {shown} !== {json.dumps(before)}", SLOW / 1000)
        until(self.page, "!document.querySelector('.pdd[aria-busy=true]')", SLOW / 1000)

    def saved(self, act: Callable[[], None], suffix: str) -> None:
        """Does what downloads a file, and looks at its name and size."""
        with self.page.expect_download(timeout=SLOW) as found:
            act()
        path = self.folder / found.value.suggested_filename
        found.value.save_as(path)
        assert path.suffix == suffix and path.stat().st_size > 1000, path

    def tab(self, name: str) -> None:
        """Goes to a tab."""
        self.press(f"button[role=tab]:text-is('{name}')")


class Task(NamedTuple):
    """A task: its name, what a newcomer does, and the most presses it may take."""

    name: str
    do: Callable[[Newcomer], None]
    presses: int


def _hug(me: Newcomer) -> None:
    me.made(lambda: me.press(".pd-chip:text-is('Hug')"))


def _slowly(me: Newcomer) -> None:
    me.page.focus(".pdd >> visible=true")
    me.page.keyboard.press("ArrowDown")
    until(me.page, "window.__pasdedeux.player.clock.speed === 0.5")


def _moments(me: Newcomer) -> None:
    me.page.focus(".pdd >> visible=true")
    me.page.keyboard.press("g")
    until(me.page, "window.__pasdedeux.player.show.ghosts")


def _own_words(me: Newcomer) -> None:
    me.type("#prompt", "A walks up to B and taps B on the shoulder.")
    expect(me.page.locator("#reading .pdr-chip")).to_have_count(2, timeout=SLOW)
    me.made(lambda: me.press("#generate"))


def _otherwise(me: Newcomer) -> None:
    me.made(lambda: me.press("#another"))


def _other_person(me: Newcomer) -> None:
    me.press("#reading .pdr-chip >> nth=1")
    me.made(lambda: me.press("#reading [data-do=hand]"))
    expect(me.page.locator("#reading .pdr-badge")).to_be_visible(timeout=SLOW)


def _longer(me: Newcomer) -> None:
    me.track("#seconds input[type=range]", 0.8)
    me.made(lambda: me.press("#generate"))


def _path(me: Newcomer) -> None:
    me.press("[data-act=draw]")
    until(me.page, "document.querySelector('.pdd-grip')?.style.transform")
    me.made(lambda: me.drag(".pdd-grip[data-person=b]", 90, 10))
    expect(me.page.locator("#reading .pdr-paths li")).to_contain_text("B’s path")


def _side_by_side(me: Newcomer) -> None:
    me.tab("Generate")
    me.rest("#grid > button")
    me.made(lambda: me.press("#grid button:text-is('Four seeds')"))
    until(me.page, "window.__pasdedeux.player.grid.cells.length === 4")


def _picture(me: Newcomer) -> None:
    me.page.focus(".pdd >> visible=true")
    me.saved(lambda: me.page.keyboard.press("p"), ".png")


def _link(me: Newcomer) -> None:
    me.press("#share")
    until(me.page, "/run=/.test(document.querySelector('#address :is(textarea, input)')?.value)")


def _all_files(me: Newcomer) -> None:
    me.rest("#downloads > button")
    me.saved(lambda: me.press("#download-all"), ".zip")


def _blender(me: Newcomer) -> None:
    me.rest("#downloads > button")
    me.saved(lambda: me.press("#download-glb"), ".glb")


def _next(me: Newcomer) -> None:
    me.made(lambda: me.press("button:text-is('What comes next')"))


def _answer(me: Newcomer) -> None:
    me.tab("React")
    expect(me.page.locator("#react-status")).not_to_contain_text("Reading", timeout=SLOW)
    me.made(lambda: me.press("#react-generate"))


def _story(me: Newcomer) -> None:
    me.tab("Scene")
    until(me.page, "document.activeElement?.closest('#scene-prompt')")
    me.type("#scene-prompt", "They wave. Then they shake hands. Finally they bow.")
    me.made(lambda: me.press("#scene-generate"))
    expect(me.page.locator(".pds-lane-words .pds-cell")).to_have_count(3, timeout=SLOW)


def _correct(me: Newcomer) -> None:
    me.track(".pdd-range", 0.5)
    me.press("[data-act=pose]")
    me.drag(".pdd-handle[data-person='0'][data-joint='20']", -25, -60)
    me.made(lambda: me.press("#scene-remake"))


def _send(me: Newcomer) -> None:
    me.rest("#scene-downloads > button")
    me.saved(lambda: me.press("#scene-film"), ".mp4")


def _find(me: Newcomer) -> None:
    me.page.keyboard.press("Control+k")
    me.page.locator("#finder dialog input").fill("arm wrestl")
    me.typed += 1
    until(me.page, "document.querySelector('#finder datalist option')")
    me.page.keyboard.press("Enter")
    until(me.page, "document.querySelector('#prompt :is(textarea, input)').value.includes('wrestl')")


def _open_again(me: Newcomer) -> None:
    me.tab("History")
    me.press(".pdn-card:has-text('taps B') .pdn-thumb")
    until(me.page, "document.querySelector('#prompt :is(textarea, input)').value.includes('taps B')")


TASKS = (
    Task("See a hug", _hug, 1),
    Task("Play it slowly", _slowly, 1),
    Task("See the key moments at once", _moments, 1),
    Task("Make a motion of my own sentence", _own_words, 3),
    Task("See it come out another way", _otherwise, 1),
    Task("Let the other person do it", _other_person, 2),
    Task("Make it longer", _longer, 2),
    Task("Draw where somebody walks", _path, 2),
    Task("Save a picture", _picture, 1),
    Task("Copy a link to it", _link, 1),
    Task("Keep all its files", _all_files, 1),
    Task("Take it to Blender", _blender, 1),
    Task("Let a partner answer person A", _answer, 2),
    Task("See what comes next", _next, 1),
    Task("Compare four versions side by side", _side_by_side, 2),
    Task("Tell a story of three beats", _story, 3),
    Task("Correct a hand at one moment", _correct, 4),
    Task("Send a film of my corrected scene to a colleague", _send, 1),
    Task("Find an act by its name", _find, 3),
    Task("Open an earlier motion", _open_again, 2),
)
