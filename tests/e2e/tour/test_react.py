"""The tour of the tab React: every method, streams, and two methods side by side."""

from __future__ import annotations

from pathlib import Path

import pytest
from playwright.sync_api import Page

from motion.formats import write
from tests.ui.stub_engine import walking
from webdemo.ui.components.actors import react_choices

from ..playing import choose
from .hands import all_used, cancelled, given, made, number, open_all, pressed, read_out, visited, with_result
from .touring import Tour

pytestmark = [pytest.mark.e2e, pytest.mark.slow]

EXCUSED_HERE = (
    "react-(camera|live) / ",  # test_live uses them
    "react-order / ",  # a file of 22 joints has no other order, which is a sentence
    "pdd-tick",  # only where hands meet: the tab Generate has them
)


def test_every_method_answers(page: Page, tour: Tour, tmp_path: Path) -> None:
    visited(page, "React")
    file = write(walking(2.0), tmp_path / "walkers.npz")[0]
    given(page, tour, "#react-file", file)
    open_all(page)
    number(page, "react-steps", 100)
    number(page, "react-samples", 4)
    choose(page, "#react-method", "InterGen, person to person")
    for _ in range(2):
        cancelled(page, tour, "react-")
    methods = [name for name, _ in react_choices()]
    page.fill("#react-prompt textarea", "They wave.")
    number(page, "react-steps", 4)
    number(page, "react-samples", 1)
    for name in methods:
        choose(page, "#react-method", name)
        made(page, tour, "react-", times=1)
    for name in methods[1:3]:
        choose(page, "#react-other", name)
        made(page, tour, "react-", times=1)
    choose(page, "#react-other", "nothing")
    pressed(page, tour, "#react-stream")
    for person in "ab":
        for _ in range(2):
            pressed(page, tour, f"#react-take-{person}", 1)
            made(page, tour, "react-", times=1)


def test_whatever_else_the_tab_offers(page: Page, tour: Tour, character: Path) -> None:
    open_all(page)
    read_out(page, tour, "react-")
    with_result(page, tour, "react-", character)

    choose(page, "#react-method", react_choices()[0][0])
    all_used(page, tour, "React", *EXCUSED_HERE)
