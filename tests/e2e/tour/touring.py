"""A visitor who uses every control of a page twice, and notes everything that goes wrong meanwhile."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from playwright.sync_api import Page

SCRIPT = Path(__file__).with_name("touring.js")
SLOW = 120_000
"""Milliseconds that a run with the networks may take on a busy machine."""
TWICE = 2


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

    def watch(self, page: Page) -> None:
        """Begins to watch a page; call it before the page is opened."""
        page.add_init_script(path=SCRIPT)
        page.on("dialog", lambda dialog: dialog.accept())

    # ---- what was used -----------------------------------------------------------------------------

    def harvest(self, page: Page, *, expect: str = "") -> None:
        """Takes over what the page noted; call it before a page is left."""
        self._note(page.evaluate("window.tour.take()"), expect)

    def _note(self, found: dict[str, Any], expect: str = "") -> None:
        self.seen |= found["seen"]
        for key, kinds in found["used"].items():
            for kind, count in kinds.items():
                self.used[key][kind] = self.used[key].get(kind, 0) + count
        for key, sentence in found["wrong"]:
            if not (expect and expect in sentence):
                self.wrong.append(f"{sentence} (after {key})" if key else sentence)

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
        self._note(page.evaluate("limit => window.tour.settle(limit)", SLOW), expect)

    def press_rest(self, page: Page, tab: str, excused: Iterable[str] = ()) -> None:
        """Uses whatever of a tab can be seen and was not used twice.

        The page presses them itself, one after the other, and waits only after what starts something.
        """
        tried: set[str] = set()
        while True:
            self.settle(page)
            left = [key for key in self.missing(excused, tab=tab) if key not in tried]
            if not left:
                return
            tried.update(left)
            by_keys = page.evaluate(
                "([keys, times, limit]) => window.tour.press(keys, times, limit)", [left, TWICE, SLOW]
            )
            for key in by_keys:
                for _ in range(TWICE):
                    self._choose(page, key)

    def _choose(self, page: Page, key: str) -> None:
        """Chooses another entry of a list with the keys, and goes back."""
        control = page.evaluate_handle("key => window.tour.find(key)", key).as_element()
        if control is None:
            return
        for way in ("ArrowDown", "ArrowUp"):
            control.click()
            control.press(way)
            control.press("Enter")
            self.settle(page)

    def errors_in_log(self) -> list[str]:
        """Lines of the server's log that tell of an error."""
        lines = self.log.read_text(encoding="utf-8", errors="replace").splitlines()
        bad = re.compile(r'"level": "(error|critical)"|^Traceback|^\w*(Error|Exception)\b')
        return [line[:600] for line in lines if bad.search(line)]
