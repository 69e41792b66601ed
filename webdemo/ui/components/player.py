"""The player of two-person motion as a Gradio component.

``gr.Plot`` drops plotly's frames, so the player is a ``gr.HTML`` with modules of its own
(``static/player``). Its templates are constant files: what a user typed never becomes part of a
template, it travels as data and the browser sets it as text.
"""

from __future__ import annotations

from typing import Any, ClassVar

import gradio as gr

from webdemo.ui.text.texts import TEXTS, TEXTS_JS
from webdemo.ui.theme import COLOURS
from webdemo.view.payload import Payload

from .part import STATIC, Part

PLAYER_FOLDER = STATIC / "player"
BODIES_FOLDER = PLAYER_FOLDER.parent / "bodies"
PLOTLY_JS = STATIC / "plotly" / "plotly-gl3d.min.js"
"""plotly.js with its 3D charts alone: a third of what the whole of it weighs."""

# Only these become reachable over the network: the player's files, its bodies, plotly.js, the colours and the texts.
gr.set_static_paths([BODIES_FOLDER, PLOTLY_JS, COLOURS, TEXTS_JS, TEXTS])


class MotionPlayer(Part):
    """Plays one or two people in 3D.

    Its value is a payload of :func:`webdemo.view.player_payload`, or None for the empty state. While
    something is being made, :func:`busy` lays a message over the scene.

    Args:
        value: the payload shown at first.
        elem_id: id of the element in the page.
    """

    template = PLAYER_FOLDER / "player.html"
    style = "& { min-height: 320px; } .pdd:not(.pdd-styled) { visibility: hidden; }"
    declared: ClassVar = {"busy": "", "progress": None}


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
