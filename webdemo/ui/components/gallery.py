"""The drawer of examples: scenes that show what the lab can do, each one press from being made and changed.

``static/gallery/scenes.json`` holds each scene's ``prompt``, ``seconds`` and ``seed``, and a moving thumbnail.
"""

from __future__ import annotations

from typing import Any

import gradio as gr

from .part import Part

_TAKEN = "(scene) => [scene.prompt, scene.seconds, scene.seed]"


class Gallery(Part):
    """A button and a drawer; its value is the scene that was pressed, which the browser keeps to itself.

    Args:
        elem_id: id of the element in the page.
    """

    folder = "gallery"
    styled = True

    def fill(self, prompt: gr.Textbox, seconds: gr.Slider, seed: gr.Number, run: gr.Button, **quiet: Any) -> None:
        """Puts the scene that is pressed into the controls and presses the button that makes it.

        ``quiet`` are the options of the page's own events.
        """
        press = f"() => document.getElementById({run.elem_id!r}).click()"
        self.input(None, inputs=self, outputs=[prompt, seconds, seed], js=_TAKEN, **quiet).then(None, js=press, **quiet)
