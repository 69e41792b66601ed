"""The player of two-person motion as a Gradio component.

``gr.Plot`` drops plotly's frames, so the player is a ``gr.HTML`` with modules of its own
(``static/player``). Its templates are constant files: what a user typed never becomes part of a
template, it travels as data and the browser sets it as text.
"""

from __future__ import annotations

import json
import uuid
from pathlib import Path
from typing import Any

import gradio as gr
import plotly

from motion.body import Body
from motion.character import packed_body
from webdemo.view.payload import Payload, player_payload

PLAYER_FOLDER = Path(__file__).resolve().parents[3] / "static" / "player"
BODIES_FOLDER = PLAYER_FOLDER.parent / "bodies"
PLOTLY_JS = Path(plotly.__file__).resolve().parent / "package_data" / "plotly.min.js"
EMPTY_TEXT = (
    "Say what two people do, or pick an example, and press Generate\n"
    "You can turn the scene while it plays, compare samples, see where the two touch,"
    " and download the motion."
)
"""What there is to do, and on a second line what comes of it."""

# Only these become reachable over the network: the player's own files, its bodies and plotly's single script.
gr.set_static_paths([PLAYER_FOLDER, BODIES_FOLDER, PLOTLY_JS])

_CSS = "& { min-height: 320px; } .pdd:not(.pdd-styled) { visibility: hidden; }"

_ON_LOAD = """
const config = window.gradio_config || {};
const root = (config.root || new URL(".", document.baseURI).href).replace(/[/]$/, "");
const encode = (path) => path.split("/").map(encodeURIComponent).join("/");
const file = (path) => root + (config.api_prefix || "/gradio_api") + "/file=" + encode(path);
import(file(%s)).then((player) => player.mount(element, props, watch, { plotly: file(%s), empty: %s }));
"""
"""To be filled with the player's script, plotly's and the text of the empty state: a tab that is opened late
knows its component's own properties late."""


class MotionPlayer(gr.HTML):
    """Plays one or two people in 3D.

    Its value is a payload of :func:`webdemo.view.player_payload`, or None for the empty state. While
    something is being made, :func:`busy` lays a message over the scene.

    Args:
        value: the payload shown at first.
        empty_text: shown while there is no motion: what to do, and on further lines what comes of it.
        elem_id: id of the element in the page.
    """

    def __init__(
        self,
        value: Payload | None = None,
        *,
        empty_text: str = EMPTY_TEXT,
        elem_id: str | None = None,
        **kwargs: Any,
    ) -> None:
        parts = ((PLAYER_FOLDER / "main.js").as_posix(), PLOTLY_JS.as_posix(), empty_text)
        kwargs = {
            "html_template": (PLAYER_FOLDER / "player.html").read_text(encoding="utf-8"),
            "css_template": _CSS,
            "js_on_load": _ON_LOAD % tuple(json.dumps(part) for part in parts),
            "apply_default_css": False,
            "busy": "",
            "progress": None,
            "live": None,
            "character": None,
            **kwargs,
        }
        super().__init__(value, elem_id=elem_id, **kwargs)

    def preprocess(self, payload: Payload | None) -> Payload | None:
        """The payload itself."""
        return payload

    def postprocess(self, value: Payload | None) -> Payload | None:
        """The payload itself; the browser tells payloads apart by their ``id``."""
        return value

    def api_info(self) -> dict[str, Any]:
        """Describes the component's value for the API page."""
        return {"type": "object", "description": "motion for the player, or null"}

    def example_payload(self) -> None:
        """None: the component takes no example."""
        return None

    def example_value(self) -> None:
        """None: the component takes no example."""
        return None

    def get_block_name(self) -> str:
        """Gradio's name of the front end that draws it."""
        return "html"


def busy(text: str = "", *, progress: float | None = None) -> dict[str, Any]:
    """An update that lays a message over the player; without text it takes the message away.

    Args:
        text: such as ``"Step 12 of 50"``.
        progress: 0 to 1 for the bar under it, None for none.
    """
    return gr.update(busy=text, progress=progress)


def show(payload: Payload | None) -> dict[str, Any]:
    """An update that shows a payload and takes the message away."""
    return gr.update(value=payload, busy="", progress=None)


def stream(message: dict[str, Any]) -> dict[str, Any]:
    """An update that hands a live payload more of its motion, see :mod:`webdemo.ui.components.live`."""
    return gr.update(live=message)


def wear(body: Body) -> dict[str, Any]:
    """An update that puts an uploaded character on both people."""
    packed = packed_body(body)
    return gr.update(character={"id": uuid.uuid4().hex, **packed})


__all__ = ["EMPTY_TEXT", "MotionPlayer", "busy", "player_payload", "show", "stream", "wear"]
