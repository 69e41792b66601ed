"""The page and the player in a headless Chromium that draws on the processor.

Part of ``python -m webdemo benchmark --browser``; needs Playwright and a Chromium of the system.
"""

from __future__ import annotations

import contextlib
import shutil
import statistics
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from motion import InputError

from . import PROMPTS
from .server import serving, wait_until

CHROMIUM = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
SOFTWARE_GL = (
    "--no-sandbox",
    "--disable-gpu",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-background-networking",
)
STAGE = (960, 640)
LONGEST_START = 120.0
LONGEST_RUN = 120.0
WATCHED = 3.0
"""Seconds over which frames a second and processor time are read."""
GIVE_BACK_EVERY = 5.0
"""Seconds after which a server at rest has given memory back, see :mod:`webdemo.server.app`."""
LONGEST_SETTLING = 15.0
"""Seconds that a page gets to draw what it owes, such as the finer picture of a motion just paused."""

_STAGE_STYLE = """#player .pdd-stage {{ width: {0}px !important; min-width: {0}px !important;
height: {1}px !important; min-height: {1}px !important; flex: none !important }}"""
_PLAYED = "window.__pasdedeux?.open && !window.__pasdedeux.playing"
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
_FOLLOW_RUN = """() => {
  const seen = (window.__benchmark = { before: window.__pasdedeux?.id ?? null, done: null, motion: null, body: null });
  let looks = 0;
  const look = (now) => {
    const player = window.__pasdedeux;
    if (seen.done === null && document.querySelector("#status .pd-done")) seen.done = now;
    const fresh = player?.id && player.id !== seen.before;
    // At the second look the picture that was due at the first has been drawn.
    const dressed = fresh && player.player.scene.objects.bodyA.triangleCount > 0;
    if (seen.body === null && dressed && looks++ > 0) seen.body = now;
    if (seen.motion === null && seen.body !== null && player.frame > 0) seen.motion = now;
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
        the first picture of bodies and to the first that moves; ``player_fps_still`` and
        ``player_fps_turning`` (the camera at rest, and dragged) while bodies with their skeletons play, as at first,
        ``player_fps_bodies``, ``player_fps_skeletons`` and ``player_pixels``. ``browser_cores_idle`` and
        ``browser_cores_paused`` are what all of the browser's processes took of a core while the page was left alone,
        and while a motion was paused. ``page_memory_mb`` is the
        memory of the page's process at rest after these runs, ``page_memory_mb_own`` without libraries and mapped
        files, in megabytes (Linux).

    Raises:
        InputError: where Playwright, Chromium or the model's weights are missing, or the page does not come.
    """
    with _chromium() as browser:
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
            page.wait_for_timeout(1000)
            figures["browser_cores_idle"] = _cores(browser, lambda: page.wait_for_timeout(1000 * WATCHED))
            figures |= _follow_a_run(page) | _frame_rates(page)
            if page.evaluate("window.__pasdedeux.playing"):
                page.locator("#player .pdd-play").click()
            _let_settle(page, browser)
            figures["browser_cores_paused"] = _cores(browser, lambda: page.wait_for_timeout(1000 * WATCHED))
            page.wait_for_timeout(1000 * (GIVE_BACK_EVERY + 2))
            figures |= _memory(server.pid)
            page.close()  # a server waits for pages that listen before it ends
            return figures


@contextlib.contextmanager
def _chromium() -> Iterator[Any]:
    """A headless browser, closed afterwards."""
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
        browser = playwright.chromium.launch(executable_path=path, args=list(SOFTWARE_GL))
        try:
            yield browser
        finally:
            browser.close()


def _memory(process: int) -> dict[str, float]:
    """Megabytes in memory of a process, and the part that is no file's; nothing where the system does not tell."""
    with contextlib.suppress(OSError):
        lines = Path(f"/proc/{process}/smaps_rollup").read_text().splitlines()[1:]
        sizes = {name: int(rest.split()[0]) / 1024 for name, rest in (line.split(":") for line in lines)}
        return {"page_memory_mb": sizes["Rss"], "page_memory_mb_own": sizes["Anonymous"]}
    return {}


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


def _cores(browser: Any, act: Callable[[], Any]) -> float:
    """Of a core, what all of the browser's processes took by their own clocks while ``act()`` went on."""
    session = browser.new_browser_cdp_session()

    def spent() -> float:
        return sum(p["cpuTime"] for p in session.send("SystemInfo.getProcessInfo")["processInfo"])

    before, began = spent(), time.perf_counter()
    act()
    share = (spent() - before) / (time.perf_counter() - began)
    session.detach()
    return share


def _let_settle(page: Any, browser: Any) -> None:
    """Waits for half a second in which the browser takes little, or until it has had its time."""
    until = time.monotonic() + LONGEST_SETTLING
    while time.monotonic() < until and _cores(browser, lambda: page.wait_for_timeout(500)) > 0.2:
        pass


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


def _frame_rates(page: Any) -> dict[str, Any]:
    """Frames a second while the motion plays, with the camera at rest and with it dragged about."""
    page.add_style_tag(content=_STAGE_STYLE.format(*STAGE))
    stage = page.locator("#player .pdd-stage")
    stage.scroll_into_view_if_needed()
    if not page.evaluate("window.__pasdedeux.playing"):
        page.locator("#player .pdd-play").click()
    page.wait_for_timeout(1500)  # the scene is laid out anew
    still = _read_fps(page, lambda i: page.wait_for_timeout(50))
    box = stage.bounding_box()
    x, y = box["x"] + 0.3 * box["width"], box["y"] + 0.4 * box["height"]
    page.mouse.move(x, y)
    page.mouse.down()
    turning = _read_fps(page, lambda i: page.mouse.move(x + 8 * (i % 40), y))
    page.mouse.up()
    alone = []
    for _ in ("bodies", "skeletons"):
        page.evaluate("window.__pasdedeux.player.act('figure')")
        page.wait_for_timeout(1500)
        alone.append(_read_fps(page, lambda i: page.wait_for_timeout(50)))
    width, height = page.evaluate(
        "(({ clientWidth, clientHeight }) => [clientWidth, clientHeight])(window.__pasdedeux.player.stage)"
    )
    return {
        "player_pixels": f"{width}x{height}",
        "player_fps_still": still,
        "player_fps_turning": turning,
        "player_fps_bodies": alone[0],
        "player_fps_skeletons": alone[1],
    }


def _read_fps(page: Any, act: Any) -> float:
    """The median of the player's own count while ``act(i)`` is done again and again."""
    counts, i, until = [], 0, time.monotonic() + WATCHED
    while time.monotonic() < until:
        act(i)
        i += 1
        if until - time.monotonic() < WATCHED / 2:  # the count looks back over a while
            counts.append(page.evaluate("window.__pasdedeux.fps"))
    return statistics.median(counts)
