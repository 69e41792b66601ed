"""A panel in which a partner answers somebody at once: the webcam, a video while it plays, or a chosen clip.

The browser sends points or poses to the server's live streams (:mod:`webdemo.server.live`) and gives what comes back
to the player beside the panel. No event of the page is part of it.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import gradio as gr

from .camera import CAMERA_FOLDER
from .player import PLAYER_FOLDER

LIVE_FOLDER = Path(__file__).resolve().parents[3] / "static" / "live"

gr.set_static_paths([LIVE_FOLDER, CAMERA_FOLDER, PLAYER_FOLDER])

_ON_LOAD = """
const config = window.gradio_config || {};
const root = (config.root || new URL(".", document.baseURI).href).replace(/[/]$/, "");
const encode = (path) => path.split("/").map(encodeURIComponent).join("/");
const file = (path) => root + (config.api_prefix || "/gradio_api") + "/file=" + encode(path);
const addresses = { address: root + "/live", mediapipe: file(%s) + "/mediapipe/" };
import(file(%s) + "/live.js").then((live) => live.mount(element, addresses));
"""


class LivePanel(gr.HTML):
    """Lets a partner answer live in the player of the same tab.

    Args:
        elem_id: id of the element in the page.
    """

    def __init__(self, *, elem_id: str | None = None, **kwargs: Any) -> None:
        folders = (CAMERA_FOLDER.as_posix(), LIVE_FOLDER.as_posix())
        kwargs = {
            "html_template": (LIVE_FOLDER / "live.html").read_text(encoding="utf-8"),
            "js_on_load": _ON_LOAD % tuple(map(json.dumps, folders)),
            "apply_default_css": False,
            **kwargs,
        }
        super().__init__(None, elem_id=elem_id, **kwargs)

    def get_block_name(self) -> str:
        """Gradio's name of the front end that draws it."""
        return "html"
