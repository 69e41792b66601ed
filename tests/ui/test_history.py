"""The History tab's list: what is there, and what can be done with it."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from webdemo.ui.history import Entry
from webdemo.ui.history_tab import HistoryTab


def tab(*entries: Entry) -> HistoryTab:
    """A tab of a history that holds just these runs."""
    history: Any = SimpleNamespace(
        entries=lambda owner: list(entries), revoke=lambda run, owner: len(entries)
    )
    page: Any = SimpleNamespace(history=history)
    return HistoryTab(page, {}, tabs=None)  # type: ignore[arg-type] # no tab is opened here


def entry(name: str) -> Entry:
    return Entry(
        id=name, kind="generate", title=f"They {name}.", state="done", request={"seconds": 5, "seed": 3}
    )


def test_an_empty_list_says_so_and_has_no_buttons() -> None:
    chosen, empty, _, actions = tab().refresh(None)
    assert chosen["choices"] == []
    assert empty["visible"] is True
    assert actions["visible"] is False


def test_a_run_that_is_still_there_stays_chosen() -> None:
    chosen, empty, _, actions = tab(entry("hug"), entry("wave")).refresh("wave")
    assert chosen["value"] == "wave"
    assert chosen["choices"][0] == ("They hug. · 5 s · seed 3 · 01 Jan 00:00", "hug")
    assert empty["visible"] is False
    assert actions["visible"] is True
    assert tab(entry("hug")).refresh("wave")[0]["value"] == "hug"


@pytest.mark.parametrize(("runs", "sentence"), [(1, "Its link no longer works."), (2, "2 links to it")])
def test_ended_links_are_counted(runs: int, sentence: str) -> None:
    assert sentence in tab(*(entry(str(i)) for i in range(runs))).revoke("0")
    assert "Choose a run first" in tab().revoke(None)
