"""From a video and from the webcam to a partner on the screen, behind the server's real content security policy."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from fractions import Fraction
from pathlib import Path

import pytest
from playwright.sync_api import Page, expect

from webdemo.benchmark.browser import FLAGS

from .conftest import Tabs

pytestmark = [pytest.mark.e2e, pytest.mark.slow]

FILM = Path(__file__).resolve().parents[1] / "data" / "camera" / "wave.mp4"
SLOW = 240_000
"""Milliseconds: a busy machine takes seconds for a picture."""


@pytest.fixture
def filming(chromium, lab: str, tmp_path: Path, expected_errors: list[str]) -> Iterator[Page]:
    """The React tab in a browser whose webcam shows the film over and over."""
    flags = [
        "--use-fake-ui-for-media-stream",
        "--use-fake-device-for-media-stream",
        f"--use-file-for-fake-video-capture={as_mjpeg(FILM, tmp_path / 'wave.mjpeg')}",
    ]
    browser = chromium.browser_type.launch(executable_path=shutil.which("chromium"), args=[*FLAGS, *flags])
    page = browser.new_page(viewport={"width": 1280, "height": 900})
    page.set_default_timeout(SLOW)
    tabs = Tabs(chromium, None)
    tabs.watch(page)
    page.goto(lab)
    page.get_by_role("tab", name="React").click()
    page.click("#react-camera .pdcam-open")
    yield page
    browser.close()
    tabs.check(expected_errors)


def as_mjpeg(film: Path, path: Path) -> Path:
    """The film as Chromium's fake camera takes it."""
    av = pytest.importorskip("av")
    with av.open(str(film)) as source, av.open(str(path), "w", format="mjpeg") as made:
        (given,) = source.streams.video
        stream = made.add_stream("mjpeg", rate=Fraction(30))
        stream.width, stream.height, stream.pix_fmt = given.width, given.height, "yuvj420p"
        for frame in source.decode(given):
            picture = av.VideoFrame.from_ndarray(frame.to_ndarray(format="rgb24"), format="rgb24")
            made.mux(stream.encode(picture))
        made.mux(stream.encode(None))
    return path


def people(page: Page, count: int) -> None:
    page.wait_for_function(f"window.__pasdedeux?.positions?.length === {count}")


def partner(page: Page) -> None:
    page.click("button#react-generate")
    expect(page.locator("#react-status .pd-done")).to_be_visible(timeout=SLOW)
    people(page, 2)


def test_a_video_and_then_the_webcam_become_an_actor_who_gets_a_partner(filming: Page) -> None:
    line = filming.locator("#react-camera .pdcam-line")
    file = filming.locator("#react-camera input[type=file]")
    for name, kind, sentence in (
        ("me.jpg", "image/jpeg", "This is a photograph"),
        ("film.mov", "video/quicktime", "This browser cannot show the video"),
    ):
        file.set_input_files({"name": name, "mimeType": kind, "buffer": b"nothing that is a picture"})
        expect(line).to_contain_text(sentence, timeout=SLOW)

    file.set_input_files(FILM)
    filming.wait_for_function("document.querySelector('#react-camera .pdcam-line').textContent.includes('picture')")
    filming.click("#react-camera .pdcam-cancel")
    expect(line).to_have_text("Cancelled.")
    file.set_input_files(FILM)
    expect(filming.locator("#react-status")).to_contain_text("wave.mp4: 1.", timeout=SLOW)
    people(filming, 1)
    height = filming.evaluate("Math.max(...window.__pasdedeux.positions[0].map((joint) => joint[1]))")
    assert 1.2 < height < 2.2, "an adult who stands on the floor, and may hold up a hand"
    partner(filming)

    filming.click("#react-camera .pdcam-record")
    filming.click("#react-camera .pdcam-begin")
    stop = filming.locator("#react-camera .pdcam-stop")
    expect(stop).to_be_visible(timeout=SLOW)
    filming.wait_for_timeout(1200)
    stop.click()
    expect(filming.locator("#react-status")).to_contain_text("Webcam:", timeout=SLOW)
    people(filming, 1)
    assert filming.evaluate("document.querySelector('#react-camera video').srcObject") is None
    partner(filming)

    filming.click("#react-live .pdcam-open")
    filming.select_option("#react-live .pdlive-source", "webcam")
    filming.click("#react-live .pdcam-begin")
    people(filming, 2)
    filming.wait_for_function("window.__pasdedeux?.playing && window.__pasdedeux?.frame > 5")
    filming.click("#react-live .pdcam-stop")
    assert filming.evaluate("document.querySelector('#react-live video').srcObject") is None
