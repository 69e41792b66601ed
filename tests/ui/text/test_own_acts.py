"""What the foot of the page says of a lab's own acts."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from acts import config, lexicon
from acts.config import look_again
from acts.lexicon import Entry
from webdemo.ui.page import _own_acts
from webdemo.ui.text.panels import own_acts

ENTRY = Entry(frames=("{a} ollie",), caption=("{a} [jump]",), reads=("She <b>ollies</b>.",), group="skate")


def test_nothing_is_said_where_nothing_was_added() -> None:
    assert own_acts(lexicon()) == ""


def test_acts_and_problems_are_listed_and_escaped() -> None:
    known = replace(
        lexicon(), entries={"kick-flip": ENTRY}, own=("kick-flip",), problems=("a.toml, line 3, [<i>]: wrong.",)
    )
    shown = own_acts(known)
    assert "<summary>This lab&#x27;s own acts: 1 (left out: 1)</summary>" in shown
    assert "<td>kick flip</td><td>She &lt;b&gt;ollies&lt;/b&gt;.</td><td>skate.toml</td>" in shown
    assert "a.toml, line 3, [&lt;i&gt;]: wrong." in shown


def test_a_visit_shows_what_the_folders_hold_now(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(config, "LOOK_EVERY", 0.0)
    monkeypatch.delenv("PASDEDEUX_ACTS", raising=False)
    assert _own_acts() == ""
    monkeypatch.setenv("PASDEDEUX_ACTS", str(tmp_path))
    (tmp_path / "own.toml").write_text("[x\n")
    assert "own.toml is no TOML" in _own_acts()
    monkeypatch.undo()
    look_again()
