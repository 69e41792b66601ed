"""Pas de Deux: motion of two people from one sentence, in the browser.

``python app.py`` opens the page on http://127.0.0.1:7860; a Hugging Face Space runs the same file.
PASDEDEUX_HOST and PASDEDEUX_PORT change the address.
"""

from __future__ import annotations

import os
import sys
import threading

os.environ.setdefault("GRADIO_ANALYTICS_ENABLED", "False")  # before Gradio is imported: it asks no other host

from webdemo.ui.lazy import LazyEngine
from webdemo.ui.page import build_page, launch_options
from webdemo.ui.runs import Loader

WARM_UP_AFTER = 2.0
"""Seconds between the server's start and the loading of the networks, which would slow the first page."""


def address() -> tuple[str, int]:
    """Host and port from the environment: 127.0.0.1:7860, or all interfaces on a Hugging Face Space."""
    on_a_space = "SPACE_ID" in os.environ
    host = os.environ.get("PASDEDEUX_HOST", "0.0.0.0" if on_a_space else "127.0.0.1")
    port = os.environ.get("PASDEDEUX_PORT", "7860")
    if not port.isdigit() or not 0 < int(port) < 65536:
        sys.exit(f"PASDEDEUX_PORT is {port!r}: set it to a number from 1 to 65535.")
    return host, int(port)


def main() -> None:
    """Builds the page, launches it, and loads the networks while it is being looked at."""
    host, port = address()
    engine = LazyEngine()
    loader = Loader(engine)
    page = build_page(engine, loader=loader)
    timer = threading.Timer(WARM_UP_AFTER, loader.start)
    timer.daemon = True
    timer.start()
    try:
        page.launch(server_name=host, server_port=port, **launch_options())
    except OSError as error:
        sys.exit(f"The page cannot be served on {host}:{port} ({error}): set PASDEDEUX_PORT to a free port.")


if __name__ == "__main__":
    main()
