"""A grid in a real browser: one WebGL context, one clock, one camera, and a cell that opens large."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from playwright.sync_api import Page, expect

from .playing import choose, stage_pixels, unfold, until
from .serving import SLOW, ask, live

pytestmark = pytest.mark.e2e

PLAYER = "window.__pasdedeux.player"
COUNT_CONTEXTS = """
window.contexts = 0;
const original = HTMLCanvasElement.prototype.getContext;
HTMLCanvasElement.prototype.getContext = function (kind, ...rest) {
  const made = original.call(this, kind, ...rest);
  if (/webgl/.test(kind) && made && !this.counted) { this.counted = true; window.contexts += 1; }
  return made;
};
"""


def sweep(page: Page, side: str, what: str, values: str) -> None:
    choose(page, f"#grid-{side}", what)
    page.fill(f"#grid-{side}-values textarea, #grid-{side}-values input", values)


def test_nine_results_share_one_context_and_one_opens_large(
    server: SimpleNamespace, open_page: Callable[..., Page], tmp_path: Path
) -> None:
    page = open_page(server.url, width=1280, height=900, before=lambda tab: tab.add_init_script(COUNT_CONTEXTS))
    live(page, slow=SLOW)
    ask(page, "Two people shake hands.")
    expect(page.locator("#status .pd-done")).to_be_visible()
    page.hover("#grid > button")  # a menu opens under the mouse
    expect(page.locator("#grid-across")).to_be_visible()
    page.wait_for_timeout(500)
    sweep(page, "across", "Seeds", "1-500")
    page.click("#grid-make")
    expect(page.locator("#status .pd-error")).to_contain_text("A grid has 1 to 9 cells")
    until(page, "window.__pasdedeux.player")
    before = page.evaluate("window.contexts")

    unfold(page, "#grid")
    sweep(page, "across", "Seeds", "1-3")
    sweep(page, "down", "Damping", "0, 0.4, 0.7")
    page.click("#grid-make")
    expect(page.locator("#status .pd-done")).to_contain_text("9 results done")
    until(page, f"{PLAYER}.grid.cells.length === 9 && window.__pasdedeux?.frame > 0")
    assert page.evaluate("window.contexts") == before, "a cell has a context of its own"
    expect(page.locator("#player .pdd-head:not(:empty)")).to_have_text(
        ["seed 1", "seed 2", "seed 3", "damping 0", "damping 0.4", "damping 0.7"]
    )
    expect(page.locator("#player [data-act=draw]")).to_be_hidden()  # on which of the nine floors?
    expect(page.locator("#player .pdd-label").first).to_be_hidden()  # whose would it be?
    expect(page.locator("#readouts thead th")).to_have_count(9)
    assert page.locator("#readouts .pd-better").count() > 0 and page.locator("#readouts .pd-worse").count() > 0
    page.evaluate(f"{PLAYER}.act('play')")
    page.wait_for_function("window.__pasdedeux?.loops === 0")
    until(page, f"{PLAYER}.pane.figures.length === 2")
    pixels = stage_pixels(page)
    rows = np.array_split(pixels, 3)
    cells = [cell for row in rows for cell in np.array_split(row, 3, axis=1)]
    for number, cell in enumerate(cells):
        warmth = cell[..., 0] - cell[..., 2]  # A is blue, B orange, which is stronger than skin
        seen = int((warmth < -60).sum()), int((warmth > 130).sum())
        assert min(seen) > 50, f"cell {number} shows {seen} pixels of A and B"

    box = page.locator("#player .pdd-cell").nth(4).bounding_box()
    assert box
    page.evaluate(f"{PLAYER}.orbit.following = false")
    page.mouse.click(box["x"] + 30, box["y"] + 30)
    until(page, f"{PLAYER}.focus === 4")
    target, wanted = page.evaluate(f"[{PLAYER}.orbit.targets[0], {PLAYER}.framing.wanted().targets[0]]")
    np.testing.assert_allclose(target, wanted, atol=0.5)  # also where the camera does not follow
    expect(page.locator("#player .pdd-caption").first).to_have_text("damping 0.4 · seed 2")
    expect(page.locator("#player .pdd-strip")).to_be_visible()
    page.click("#player .pdd-back")
    until(page, f"{PLAYER}.focus === null && {PLAYER}.grid.cells.length === 9")
    unfold(page, "#downloads")
    expect(page.locator("#download-csv")).to_be_enabled()
    with page.expect_download(timeout=SLOW) as download:
        page.click("#download-csv")
    download.value.save_as(tmp_path / "grid.csv")
    assert len((tmp_path / "grid.csv").read_text().splitlines()) == 10
    page.evaluate(f"{PLAYER}.enlarge(4)")
    expect(page.locator("#player .pdd-back")).to_be_visible()
    page.evaluate(f"{PLAYER}.load(null)")
    expect(page.locator("#player .pdd-back")).to_be_hidden()
