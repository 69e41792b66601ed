"""The harness' player in a page without Gradio, which opens in a fraction of the time."""

from __future__ import annotations

import functools
import json
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from urllib.parse import parse_qs, urlsplit

from webdemo.ui.components.player import PLAYER_FOLDER

from .harness import UPDATES

PAGE = """<!doctype html>
<html lang="en">
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>Player</title>
<link rel="stylesheet" href="/colours.css">
<style>
  body { margin: 0; padding: 16px; font-family: sans-serif; }
  body.dark { background: #12161e; color: #e5e9f0; }
  .pdd:not(.pdd-styled) { visibility: hidden; }
</style>
<body class="%(theme)s">
<div id="player"></div>
<nav>%(buttons)s</nav>
<template id="fresh">%(player)s</template>
<script type="module">
  import { mount } from "/player/main.js";
  const host = document.getElementById("player");
  let props, changed;
  window.restart = (theme) => {
    document.body.className = theme;
    window.__pasdedeux.player?.close();
    localStorage.clear();
    host.replaceChildren(document.getElementById("fresh").content.cloneNode(true));
    props = { value: null, busy: "", progress: null, live: null };
    mount(host, props, (names, act) => (changed = act), null);
  };
  for (const button of document.querySelectorAll("nav button")) {
    button.onclick = async () => {
      Object.assign(props, await (await fetch("/update/" + button.textContent)).json());
      changed();
    };
  }
  window.restart("%(theme)s");
</script>
"""


@functools.cache
def update(name: str) -> bytes:
    """The properties that a button of the harness changes, as JSON."""
    return json.dumps({k: v for k, v in UPDATES[name]().items() if k != "__type__"}).encode()


class Handler(SimpleHTTPRequestHandler):
    """Serves the page, the player's files, plotly and what the buttons do."""

    protocol_version = "HTTP/1.1"

    def do_GET(self) -> None:
        address = urlsplit(self.path)
        if address.path == "/":
            theme = parse_qs(address.query).get("__theme", ["light"])[0]
            parts = {
                "theme": theme,
                "player": (PLAYER_FOLDER / "player.html").read_text(encoding="utf-8"),
                "buttons": "".join(f"<button>{name}</button>" for name in UPDATES),
            }
            self._send((PAGE % parts).encode(), "text/html; charset=utf-8")
        elif address.path.removeprefix("/update/") in UPDATES:
            self._send(update(address.path.removeprefix("/update/")), "application/json")
        else:
            super().do_GET()

    def _send(self, body: bytes, kind: str) -> None:
        self.send_response(200)
        self.send_header("Content-Type", kind)
        self.send_header("Content-Length", str(len(body)))
        self.send_header("Cache-Control", "max-age=600")
        self.end_headers()
        self.wfile.write(body)

    def log_message(self, *_: object) -> None:
        pass


@contextmanager
def serve(folder: Path = PLAYER_FOLDER.parent) -> Iterator[str]:
    """Serves the page and a folder while it is entered; yields its address."""
    handler = functools.partial(Handler, directory=str(folder))
    with ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_port}/"
        server.shutdown()
