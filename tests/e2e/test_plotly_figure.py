"""The HTML figure in a browser without a network: it draws, and its button plays it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from motion import Duet
from tests.motion.bodies import marching
from webdemo.view import write_figure

pytestmark = pytest.mark.slow


def test_the_button_plays_the_figure(chromium, tmp_path: Path) -> None:
    positions, _ = marching(61)
    duet = Duet.from_positions(np.stack([positions, positions + np.array([0, 0, 1.5])]), fps=30)
    path = write_figure(duet, tmp_path / "figure.html", title="Two people march")
    context = chromium.new_context(offline=True, viewport={"width": 900, "height": 600})
    try:
        page = context.new_page()
        errors: list[str] = []
        asked: list[str] = []
        page.on("pageerror", lambda error: errors.append(str(error)))
        page.on("request", lambda request: asked.append(request.url))
        page.goto(path.as_uri())
        page.wait_for_selector("text=Two people march")
        shown = "() => Array.from(document.querySelector('.js-plotly-plot')._fullData[2].x.slice(0, 2))"
        first = page.evaluate(shown)
        page.click("text=▶ Play")
        page.wait_for_function(f"first => String(({shown})()) !== String(first)", arg=first)
        page.wait_for_function("() => document.querySelector('.js-plotly-plot').layout.sliders[0].active > 3")
        assert not errors and asked == [path.as_uri()]
    finally:
        context.close()
