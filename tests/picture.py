"""Records the moving picture of the README from a running lab.

    python -m tests.picture http://127.0.0.1:7860 docs/page.webp

It needs playwright and Chromium, like the tests of the page.
"""

from __future__ import annotations

import argparse
import io
from pathlib import Path

from PIL import Image
from playwright.sync_api import Page, expect

from tests.e2e.playing import pause
from webdemo.benchmark.browser import chromium

SIZE = (1240, 775)
SHOWN = (992, 620)
"""Pixels of the window and of the picture."""
SENTENCE = "Two people walk up to each other and give each other a high five."
EVERY, FPS, LAST = 3, 10, 150
"""Frames of the motion from one picture to the next, pictures a second (the motion's own speed), and frames shown."""


def generate(page: Page) -> int:
    """Generates a motion on the page and pauses it; returns the number of its frames."""
    page.fill("#prompt textarea", SENTENCE)
    page.click("button#generate")
    page.wait_for_selector("#status .pd-done", timeout=120_000)
    page.wait_for_function("window.__pasdedeux.playing", timeout=60_000)
    pause(page)
    return 1 + int(page.locator(".pdd-range").get_attribute("max") or 0)


def record(page: Page, frames: int) -> list[Image.Image]:
    """Pictures of the page at every third frame of the motion."""
    pictures = []
    for frame in range(0, min(frames, LAST), EVERY):
        page.locator(".pdd-range").fill(str(frame))
        page.wait_for_timeout(120)
        shot = Image.open(io.BytesIO(page.screenshot())).convert("RGB")
        pictures.append(shot.resize(SHOWN, Image.Resampling.LANCZOS))
    return pictures


def main() -> None:
    """Runs the command."""
    parser = argparse.ArgumentParser(description="Record a moving picture of the page.")
    parser.add_argument("url", help="of a running lab")
    parser.add_argument("out", type=Path, help="the .webp to write")
    options = parser.parse_args()
    with chromium() as browser:
        page = browser.new_page(viewport={"width": SIZE[0], "height": SIZE[1]})
        page.goto(options.url)
        expect(page.locator("#model-state")).to_contain_text("Model ready", timeout=60_000)
        pictures = record(page, generate(page))
    pictures[0].save(
        options.out, save_all=True, append_images=pictures[1:], duration=round(1000 / FPS), loop=0, quality=45
    )


if __name__ == "__main__":
    main()
