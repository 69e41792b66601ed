"""The drawer of examples: scenes that show what the lab can do, each one press from being made and changed.

``static/gallery/scenes.json`` holds each scene's ``prompt``, ``seconds`` and ``seed``, and a moving thumbnail.
"""

from __future__ import annotations

from typing import Any

import gradio as gr
from pydantic import TypeAdapter

from .accepts import Finite, Sent, Text
from .part import MOUNT, STATIC, Part, on_load, scoped

GALLERY_FOLDER = STATIC / "gallery"
SCENES = GALLERY_FOLDER / "scenes.json"

_TAKEN = "(scene) => [scene.prompt, scene.seconds, scene.seed]"


class SentScene(Sent):
    """The scene that was pressed, as the browser sends it: its words, its length in seconds and its seed."""

    prompt: Text
    seconds: Finite
    seed: Finite


class Gallery(Part):
    """A button and a drawer; its value is the scene that was pressed.

    Args:
        elem_id: id of the element in the page.
    """

    accepts = TypeAdapter(SentScene | None)
    template = GALLERY_FOLDER / "gallery.html"
    script = on_load(MOUNT, GALLERY_FOLDER / "main.js")
    style = scoped(GALLERY_FOLDER / "gallery.css")

    def fill(self, prompt: gr.Textbox, seconds: gr.Slider, seed: gr.Number, run: gr.Button, **quiet: Any) -> None:
        """Puts the scene that is pressed into the controls and presses the button that makes it.

        ``quiet`` are the options of the page's own events.
        """
        press = f"() => document.getElementById({run.elem_id!r}).click()"
        self.input(None, inputs=self, outputs=[prompt, seconds, seed], js=_TAKEN, **quiet).then(None, js=press, **quiet)
