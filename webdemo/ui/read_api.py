"""``/read``: a sentence → its plan, for programs."""

from __future__ import annotations

from typing import Any

import gradio as gr

from acts import read
from webdemo.ui.components.reading import READERS, READING_EVENTS
from webdemo.ui.text.words import error_line

from .api import Endpoint


class ReadEndpoint(Endpoint):
    """``/read``: what is understood of a sentence; nothing is generated."""

    def publish(self) -> None:
        """Adds the endpoint to the page that is being built."""
        with gr.Row(visible=False):
            text = gr.Textbox(label="English text, at most 2,000 characters")
            plan = gr.JSON(label="plan: people, things, acts, and what was not understood")
            gr.Button().click(
                self.read,
                inputs=[text],
                outputs=[plan],
                api_name="read",
                concurrency_limit=READERS,
                concurrency_id=READING_EVENTS,
            )

    def read(self, text: str | None) -> dict[str, Any]:
        """The plan of a text: who does what to whom, in which order, and what was not understood.

        Returns the plan as JSON (docs/acts.md). An error is one sentence that says what to change.
        """
        try:
            return read(text or "").model_dump(mode="json")
        except Exception as error:
            raise gr.Error(error_line(error), print_exception=False) from None
