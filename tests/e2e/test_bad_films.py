"""Films and cameras that cannot be used: a sentence each. The modules run in a browser without the page around them."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from playwright.sync_api import Page

pytestmark = pytest.mark.e2e

PRELUDE = """
const { openFilm } = await import("/camera/film.js");
const { openWebcam } = await import("/camera/webcam.js");
const { analyse } = await import("/camera/camera.js");
const said = async (job) => {
  try {
    await job();
    return "nothing was wrong";
  } catch (error) {
    return error.constructor.name + ": " + error.message;
  }
};
/** A film whose every picture is there at once. */
class Film extends EventTarget {
  videoWidth = 1280; videoHeight = 720; duration = 2; readyState = 4;
  set currentTime(time) { queueMicrotask(() => this.dispatchEvent(new Event("seeked"))); }
}
const person = { image: Array(33).fill([0.5, 0.5]), seen: Array(33).fill(1), world: Array(33).fill([0, 0, 0]) };
const detector = (...people) => ({ begin: async () => {}, detect: async () => people });
"""


@pytest.fixture
def page(open_page: Callable[..., Page], plain_url: str) -> Page:
    page = open_page(f"{plain_url}camera/README.md", width=400, height=300)
    page.set_content("<video muted></video><input type=file>")
    return page


def said(page: Page, job: str, argument: Any = None) -> str:
    """What a job of the modules ends with."""
    return str(page.evaluate(f"async (given) => {{ {PRELUDE} return said(async () => {{ {job} }}); }}", argument))


def test_a_camera_that_is_refused_absent_or_taken(page: Page) -> None:
    for error, sentence in (
        ("NotAllowedError", "The browser blocks the camera: allow it in the address bar and try again."),
        ("NotFoundError", "No camera was found: connect one, or choose a video."),
        ("NotReadableError", "The camera does not start: close other programs that use it and try again."),
    ):
        refused = f"navigator.mediaDevices.getUserMedia = () => Promise.reject(new DOMException('', '{error}'));"
        opens = "await openWebcam(document.querySelector('video'));"
        assert said(page, refused + opens) == f"FilmError: {sentence}"
    hidden = "Object.defineProperty(navigator, 'mediaDevices', { value: undefined, configurable: true });"
    assert "over https" in said(page, hidden + "await openWebcam(document.querySelector('video'));")


def test_nobody_is_told(page: Page) -> None:
    looks = """
    const found = await analyse(new Film(), detector({0}));
    throw new Error(found.people.length);
    """
    assert said(page, looks.format("")).startswith("FilmError: Nobody was found in the video")
    assert said(page, looks.format("person")) == "Error: 30", "one person in each of 30 pictures"


def encoded(path: Path, codec: str, times: list[float]) -> bytes:
    """A film with a grey picture at each of the times."""
    av = pytest.importorskip("av")
    if codec not in av.codecs_available:
        pytest.skip(f"this PyAV cannot make a film with {codec}")
    with av.open(str(path), "w") as film:
        stream = film.add_stream(codec, rate=30)
        stream.width, stream.height, stream.pix_fmt = 64, 48, "yuv420p"
        for time in times:
            picture = av.VideoFrame.from_ndarray(np.full((48, 64, 3), 128, np.uint8), format="rgb24")
            picture.pts, picture.time_base = round(30 * time), Fraction(1, 30)
            film.mux(stream.encode(picture))
        film.mux(stream.encode(None))
    return path.read_bytes()


OPENS = "await openFilm(document.querySelector('video'), document.querySelector('input').files[0]);"


@pytest.mark.parametrize(
    ("codec", "times", "sentence"),
    [
        ("libx264", [0.0], "The video is a single picture or very short"),
        ("libx264", [0.0, 1.0, 75.0], "The video lasts 75 s: cut it to 60 s or less."),
        ("libx264", [0.0, 0.1, 0.5, 0.6, 1.4, 2.0], "nothing was wrong"),
    ],
    ids=["one frame", "75 seconds", "uneven times"],
)
def test_films_of_the_wrong_kind(page: Page, tmp_path: Path, codec: str, times: list[float], sentence: str) -> None:
    film = {"name": "film.mp4", "mimeType": "video/mp4", "buffer": encoded(tmp_path / "film.mp4", codec, times)}
    page.set_input_files("input", film)
    assert sentence in said(page, OPENS)
