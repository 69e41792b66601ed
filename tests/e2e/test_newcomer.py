"""Twenty tasks of a newcomer: each of them is done, in as many presses as the table says, and the table is told."""

from __future__ import annotations

import os
import re
from collections.abc import Callable
from pathlib import Path

import pytest
from playwright.sync_api import Page

from .newcomer import TASKS, TIDY, Newcomer
from .serving import live

pytestmark = pytest.mark.e2e

TABLE = Path(__file__).resolve().parents[2] / "docs" / "newcomer.md"


@pytest.mark.skipif(
    "PASDEDEUX_NEWCOMER" not in os.environ,
    reason="takes minutes, and has hung once on a busy machine: set PASDEDEUX_NEWCOMER=1",
)
def test_twenty_tasks_take_the_presses_of_the_table(lab: str, open_page: Callable[..., Page], tmp_path: Path) -> None:
    page = live(open_page(lab, width=1440, height=1800, accept_downloads=True))
    page.wait_for_function("window.__pasdedeux?.frame > 0")
    me = Newcomer(page, tmp_path)
    found = {}
    for task in TASKS:
        before = me.presses
        task.do(me)
        found[task.name] = me.presses - before
        page.evaluate(TIDY)
    assert found == {task.name: task.presses for task in TASKS}


def test_the_table_is_told() -> None:
    rows = re.findall(r"^\| \d+ \| ([^|]+?) \| [^|]* \| (\d+) \|$", TABLE.read_text(encoding="utf-8"), re.MULTILINE)
    assert rows == [(task.name, str(task.presses)) for task in TASKS]
    assert len(rows) == 20
