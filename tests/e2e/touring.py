"""A visitor who uses every control of a page twice, and notes everything that goes wrong meanwhile."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from playwright.sync_api import ElementHandle, Page

SCRIPT = Path(__file__).with_name("touring.js")
SLOW = 120_000
"""Milliseconds that a run with the networks may take on a busy machine."""
TWICE = 2
BUSY = """() => [...document.querySelectorAll(".pd-busy, .pd-run:disabled, .pd-sending")].some(
  (e) => e.checkVisibility({ visibilityProperty: true }))"""
WRONG = """() => [...document.querySelectorAll(".pd-error, .toast-body.error, .pdd-error")]
  .filter((e) => e.checkVisibility({ visibilityProperty: true })).map((e) => e.textContent.trim())"""


class Tour:
    """Watches pages; ``wrong`` holds what went wrong.

    Args:
        log: of the server, in which no line may be an error.
    """

    def __init__(self, log: Path) -> None:
        self.log = log
        self.wrong: list[str] = []
        self.seen: dict[str, str] = {}
        self.used: dict[str, dict[str, int]] = defaultdict(dict)
        self.excused: list[str] = []

    def watch(self, page: Page) -> None:
        """Begins to watch a page; call it before the page is opened."""
        page.add_init_script(path=SCRIPT)
        page.on("dialog", lambda dialog: dialog.accept())

    # ---- what was used -----------------------------------------------------------------------------

    def harvest(self, page: Page) -> None:
        """Takes over what the page noted; call it before a page is left."""
        found = page.evaluate("window.tour.take()")
        self.seen |= found["seen"]
        for key, kinds in found["used"].items():
            for kind, count in kinds.items():
                self.used[key][kind] = self.used[key].get(kind, 0) + count

    def times(self, key: str) -> int:
        """How often a control was used."""
        return max(self.used.get(key, {}).values(), default=0)

    def missing(self, excused: Iterable[str] = (), *, tab: str = "") -> list[str]:
        """Controls that could be seen and were not used twice, but for patterns of what is excused."""
        return sorted(
            key
            for key in self.seen
            if self.times(key) < TWICE
            and re.match(tab, key)
            and not any(re.search(pattern, key) for pattern in excused)
        )

    # ---- using -------------------------------------------------------------------------------------

    def settle(self, page: Page, *, expect: str = "") -> None:
        """Waits until nothing runs, and notes errors that are shown, but for ``expect``."""
        page.wait_for_timeout(150)
        page.wait_for_function(f"!({BUSY})()", timeout=SLOW)
        for sentence in page.evaluate(WRONG):
            if not (expect and expect in sentence):
                self.wrong.append(sentence)
        self.harvest(page)

    def press_rest(self, page: Page, tab: str, excused: Iterable[str] = ()) -> None:
        """Uses whatever of a tab can be seen and was not used twice."""
        tried: set[str] = set()
        while True:
            self.settle(page)
            left = [key for key in self.missing(excused, tab=tab) if key not in tried]
            if not left:
                return
            for key in left:
                tried.add(key)
                for _ in range(TWICE):
                    control = page.evaluate_handle("key => window.tour.find(key)", key).as_element()
                    if control is None:
                        break
                    _use(page, control)
                    self.settle(page)

    def errors_in_log(self) -> list[str]:
        """Lines of the server's log that tell of an error."""
        lines = self.log.read_text(encoding="utf-8", errors="replace").splitlines()
        bad = re.compile(r'"level": "(error|critical)"|^Traceback|^\w*(Error|Exception)\b')
        return [line[:600] for line in lines if bad.search(line)]


def _use(page: Page, control: ElementHandle) -> None:
    """Uses a control once as its kind is used, and leaves its value as it was."""
    kind: Any = control.evaluate(
        "e => ({ tag: e.tagName, type: e.type, role: e.getAttribute('role'), value: e.value })"
    )
    if kind["tag"] == "SELECT":
        values = control.evaluate("e => [...e.options].map((o) => o.value)")
        control.select_option(values[-1] if kind["value"] != values[-1] else values[0])
        control.select_option(kind["value"])
    elif kind["type"] in ("number", "date"):
        other = "2026-01-02" if kind["type"] == "date" else control.evaluate(
            "e => String(Number(e.value || e.min || 1) + (Number(e.max) && Number(e.value) >= Number(e.max) ? -1 : 1)"
            " * (Number(e.step) || 1))"
        )  # fmt: skip
        for value in (other, kind["value"]):
            control.fill(value)
            control.press("Tab")
    elif kind["type"] == "range" or kind["role"] == "slider":
        control.focus()
        for way in ("ArrowRight", "ArrowLeft"):
            control.press(way)
    elif kind["role"] == "listbox" or (kind["tag"] == "INPUT" and kind["type"] == "text"):
        control.click()
        control.press("ArrowDown")
        control.press("Enter")
        control.click()
        control.press("ArrowUp")
        control.press("Enter")
    elif kind["tag"] == "TEXTAREA" or kind["type"] in ("text", "search"):
        control.fill(f"{kind['value']} again")
        control.fill(kind["value"])
    else:
        control.click()
