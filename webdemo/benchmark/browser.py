"""The page and the player in a headless Chromium that draws on the processor.

Part of ``python -m webdemo benchmark --browser``; needs Playwright and a Chromium of the system.
"""

from __future__ import annotations

import contextlib
import shutil
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from motion import InputError

from . import PROMPTS
from .server import serving, wait_until

CHROMIUM = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
FLAGS = (
    "--no-sandbox",
    "--disable-gpu",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
)
"""Drawing on the processor, and no requests of the browser's own."""
STAGE = (960, 640)
LONGEST_START = 120.0
LONGEST_RUN = 120.0
WATCHED = 3.0
"""Seconds over which frames a second are read."""
_STAGE_STYLE = """#player .pdd-stage {{ width: {0}px !important; min-width: {0}px !important;
height: {1}px !important; min-height: {1}px !important; flex: none !important }}"""
_PLAYED = "window.__pasdedeux?.player && !window.__pasdedeux.playing"
_FIRST_VIEW = """() => new Promise((done) => {
  let shifted = 0;
  new PerformanceObserver((list) => {
    for (const entry of list.getEntries()) if (!entry.hadRecentInput) shifted += entry.value;
  }).observe({ type: "layout-shift", buffered: true });
  const files = [...performance.getEntriesByType("navigation"), ...performance.getEntriesByType("resource")];
  const report = () => done({
    page_first_paint_seconds: performance.getEntriesByName("first-contentful-paint")[0].startTime / 1000,
    page_layout_shift: shifted,
    page_megabytes: files.reduce((sum, file) => sum + file.transferSize, 0) / 1e6,
  });
  setTimeout(report, 100);
})"""
_COUNT_PAINTED = """(seconds) => new Promise((done) => {
  const { player } = window.__pasdedeux;
  let painted = 0;
  player.paint = (pose) => {
    painted += 1;
    Object.getPrototypeOf(player).paint.call(player, pose);
  };
  setTimeout(() => {
    delete player.paint;
    done(painted / seconds);
  }, 1000 * seconds);
})"""
_FOLLOW_RUN = """() => {
  const before = window.__pasdedeux?.player?.data?.id ?? null;
  const seen = (window.__benchmark = { before, done: null, motion: null, body: null });
  let looks = 0;
  const look = (now) => {
    const { player, frame } = window.__pasdedeux ?? {};
    if (seen.done === null && document.querySelector("#status .pd-done")) seen.done = now;
    const fresh = player?.data && player.data.id !== seen.before;
    // At the second look the picture that was due at the first has been drawn.
    const dressed = fresh && player.scene.objects.bodyA.triangleCount > 0;
    if (seen.body === null && dressed && looks++ > 0) seen.body = now;
    if (seen.motion === null && seen.body !== null && frame > 0) seen.motion = now;
    // Every frame only where something moves: the page's own quiet is measured meanwhile.
    if (seen.done === null && !fresh) setTimeout(() => look(performance.now()), 30);
    else if (seen.done === null || seen.motion === null) requestAnimationFrame(look);
  };
  seen.asked = performance.now();
  look(seen.asked);
  document.querySelector("button#generate").click();
}"""


def measure_browser() -> dict[str, Any]:
    """Seconds to the page and to motion on screen, and the player's frames a second.

    Returns:
        ``page_first_answer_seconds`` and ``page_prompt_seconds``, both from the command ``python app.py``;
        ``page_model_ready_seconds``, from the same; ``page_first_paint_seconds`` from the address to the first
        text or picture, ``page_layout_shift`` (Chromium's sum, without unit) and ``page_megabytes`` over the network,
        all until the first motion has played; ``page_request_seconds`` from the button to the end of a
        run of 4 s of motion; ``page_result_to_body_seconds`` and ``page_result_to_motion_seconds``, from there to
        the first picture of bodies and to the first that moves; ``player_fps`` while bodies with their skeletons play,
        as at first, and ``player_pixels``.

    Raises:
        InputError: where Playwright, Chromium or the model's weights are missing, or the page does not come.
    """
    with chromium() as browser:
        page = browser.new_page(viewport={"width": 1440, "height": 1000})
        began = time.perf_counter()
        with tempfile.TemporaryDirectory(prefix="pas-de-deux-benchmark-") as data, serving(Path(data)) as (url, server):
            wait_until(url, "", server, every=0.05)
            figures = {"page_first_answer_seconds": time.perf_counter() - began}
            page.goto(url)
            page.locator("#prompt textarea").wait_for(state="visible", timeout=1000 * LONGEST_START)
            figures["page_prompt_seconds"] = time.perf_counter() - began
            _wait_for_model(page)
            figures["page_model_ready_seconds"] = time.perf_counter() - began
            page.wait_for_function(_PLAYED, timeout=1000 * LONGEST_RUN)
            figures |= page.evaluate(_FIRST_VIEW)
            figures |= _follow_a_run(page) | _frame_rate(page)
            page.close()  # a server waits for pages that listen before it ends
            return figures


@contextlib.contextmanager
def chromium() -> Iterator[Any]:
    """A headless Chromium of the system, closed afterwards; raises InputError where it or Playwright is missing."""
    try:
        from playwright.sync_api import sync_playwright
    except ImportError:
        raise InputError(
            "Playwright is not installed: `pip install -r requirements-dev.txt`, or leave --browser out."
        ) from None
    path = next(filter(None, map(shutil.which, CHROMIUM)), None)
    if path is None:
        raise InputError("There is no Chromium here: install the package chromium, or leave --browser out.")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=path, args=FLAGS)
        try:
            yield browser
        finally:
            browser.close()


def _wait_for_model(page: Any) -> None:
    from playwright.sync_api import TimeoutError as TookTooLong

    mark = page.locator("#model-state")
    with contextlib.suppress(TookTooLong):
        settled = mark.locator(".pd-model-ready, .pd-model-failed")
        settled.wait_for(timeout=1000 * LONGEST_START)
    if not mark.locator(".pd-model-ready").count():
        raise InputError(
            f"The page's model did not load (it says {mark.inner_text()!r}): run `python -m webdemo info`."
        )


def _follow_a_run(page: Any) -> dict[str, float]:
    """Asks for motion as a visitor does; the page's own clock times what happens."""
    from playwright.sync_api import TimeoutError as TookTooLong

    page.fill("#prompt textarea", PROMPTS[0])
    page.locator("button#generate:enabled").wait_for(timeout=1000 * LONGEST_RUN)
    page.evaluate(_FOLLOW_RUN)
    try:
        page.wait_for_function("window.__benchmark.motion !== null", timeout=1000 * LONGEST_RUN)
    except TookTooLong:
        said = page.locator("#status").inner_text()
        raise InputError(f"No motion came on screen; the page says {said!r}: try again.") from None
    seen = page.evaluate("window.__benchmark")
    return {
        "page_request_seconds": (seen["done"] - seen["asked"]) / 1000,
        "page_result_to_body_seconds": max(0.0, seen["body"] - seen["done"]) / 1000,
        "page_result_to_motion_seconds": max(0.0, seen["motion"] - seen["done"]) / 1000,
    }


def _frame_rate(page: Any) -> dict[str, Any]:
    """The frames that the player paints in a second while the motion plays."""
    page.add_style_tag(content=_STAGE_STYLE.format(*STAGE))
    page.locator("#player .pdd-stage").scroll_into_view_if_needed()
    if not page.evaluate("window.__pasdedeux.playing"):
        page.locator("#player .pdd-play").click()
    page.wait_for_timeout(1500)  # the scene is laid out anew
    rate = page.evaluate(_COUNT_PAINTED, WATCHED)
    width, height = page.evaluate(
        "(({ clientWidth, clientHeight }) => [clientWidth, clientHeight])(window.__pasdedeux.player.stage)"
    )
    return {"player_pixels": f"{width}x{height}", "player_fps": rate}
