"""Runs the page's own scripts over films in headless Chromium and collects the landmarks they would send."""

from __future__ import annotations

import functools
import http.server
import shutil
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

SCRIPTS = Path(__file__).resolve().parents[2] / "static" / "camera"
FLAGS = ["--no-sandbox", "--disable-gpu", "--use-gl=angle", "--use-angle=swiftshader",
         "--enable-unsafe-swiftshader"]  # fmt: skip
_RUN = """async ([name, people]) => {
  const { Detector } = await import("/detector.js");
  const { openFilm } = await import("/film.js");
  const { analyse } = await import("/analysis.js");
  const folder = new URL("/mediapipe/", location.href).href;
  window.detectors ??= [new Detector(folder), new Detector(folder)];
  const video = document.createElement("video");
  video.muted = true;
  const blob = await (await fetch(`/films/${name}`)).blob();
  await openFilm(video, new File([blob], name, { type: "video/mp4" }));
  const began = performance.now();
  const landmarks = await analyse(video, window.detectors, { people });
  return [landmarks.pack(), (performance.now() - began) / landmarks.times.length];
}"""


class _Handler(http.server.SimpleHTTPRequestHandler):
    extensions_map = {  # noqa: RUF012
        **http.server.SimpleHTTPRequestHandler.extensions_map,
        ".mjs": "text/javascript",
        ".js": "text/javascript",
        ".wasm": "application/wasm",
    }

    def __init__(self, *args: Any, films: Path, **kwargs: Any) -> None:
        self.films = films
        super().__init__(*args, directory=str(SCRIPTS), **kwargs)

    def translate_path(self, path: str) -> str:
        if path.startswith("/films/"):
            return str(self.films / Path(path).name)
        return super().translate_path(path)

    def do_GET(self) -> None:
        if self.path == "/":
            self.send_response(200)
            self.send_header("Content-Type", "text/html")
            self.end_headers()
            self.wfile.write(b"<!doctype html><title>films</title>")
            return
        super().do_GET()

    def log_message(self, format: str, *args: Any) -> None:
        """Says nothing."""


@contextmanager
def detector(films: Path) -> Iterator[Any]:
    """A function (name of a film, people) -> (landmarks as text, milliseconds a picture)."""
    from playwright.sync_api import sync_playwright

    handler = functools.partial(_Handler, films=films)
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    try:
        with sync_playwright() as playwright:
            browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=FLAGS)
            page = browser.new_page()
            page.goto(f"http://127.0.0.1:{server.server_port}/")
            yield lambda name, people=0: page.evaluate(_RUN, [name, people])
            browser.close()
    finally:
        server.shutdown()
        server.server_close()
