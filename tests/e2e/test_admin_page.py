"""The administrators' page on a telephone: each act in reach without scrolling sideways."""

from __future__ import annotations

import pytest

from webdemo.server.http import admin_pages
from webdemo.server.http.error_pages import card

pytestmark = pytest.mark.e2e
BUTTONS = "<form><button>Suspend</button></form>"
ROW = ["<strong>a.person.of.a.long.name</strong>", "1,234", "0.9 MB", BUTTONS]


@pytest.mark.parametrize("width", [390, 1280])
def test_every_act_is_in_reach(open_page, tmp_path, width: int) -> None:
    people = admin_pages.table([ROW, ROW])
    page = card(f"{admin_pages._STYLE}<h2>People</h2>{people}")
    (tmp_path / "admin.html").write_text(page)
    shown = open_page((tmp_path / "admin.html").as_uri(), width=width)
    for button in shown.get_by_role("button").all():
        box = button.bounding_box()
        assert box is not None and box["x"] >= 0 and box["x"] + box["width"] <= width
    names = shown.eval_on_selector_all("td", "cells => cells.map(c => getComputedStyle(c, '::before').content)")
    assert ('"Runs kept"' in names) == (width == 390), "a card says what each number is"
