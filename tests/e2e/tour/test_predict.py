"""The tour of the tab Predict."""

from __future__ import annotations

from pathlib import Path

import pytest
from playwright.sync_api import Page

from motion.formats import write
from tests.ui.stub_engine import walking

from ..playing import choose
from .hands import all_used, given, made, number, open_all, pressed, visited, with_result
from .touring import Tour

pytestmark = [pytest.mark.e2e, pytest.mark.slow]

EXCUSED_HERE = (
    "predict-camera / ",  # the same panel as on the tab React
    "pdd-tick",  # only where hands meet: the tab Generate has them
)


def test_predict(page: Page, tour: Tour, character: Path, tmp_path: Path) -> None:
    visited(page, "Predict")
    file = write(walking(4.0), tmp_path / "walkers.npz")[0]
    given(page, tour, "#predict-file", file)
    open_all(page)
    number(page, "predict-marker", 2)
    number(page, "predict-seconds", 1)
    made(page, tour, "predict-")
    choose(page, "#predict-other", "Zero velocity (the last pose, held)")
    made(page, tour, "predict-")
    choose(page, "#predict-other", "nothing")
    made(page, tour, "predict-", times=1)
    for _ in range(2):
        pressed(page, tour, "#predict-continue", 1)
        made(page, tour, "predict-", times=1)
    open_all(page)
    pressed(page, tour, "#predict-readouts summary:has-text('All figures')", 4)
    with_result(page, tour, "predict-", character)
    choose(page, "#predict-grid-across", "Seconds to predict")
    page.fill("#predict-grid-across-values textarea", "1, 2")
    pressed(page, tour, "#predict-grid-make")

    all_used(page, tour, "Predict", *EXCUSED_HERE)
