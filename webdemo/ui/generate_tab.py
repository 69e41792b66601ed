"""Two people from one sentence: the controls, the player and what is measured under it."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from typing import Any

import gradio as gr

from webdemo.inference.requests import SECONDS, GenerateRequest

from .examples import EXAMPLES
from .job_tab import QUIET, JobTab, Updates
from .panels import model_card, status
from .words import error_line


class GenerateTab(JobTab):
    """Text → two people."""

    label = "Generate"

    def request(self, fields: Mapping[str, Any]) -> GenerateRequest:
        return GenerateRequest(**fields)

    def title(self, request: GenerateRequest) -> str:
        return request.prompt

    def build(self, demo: gr.Blocks, record: gr.State | None = None) -> None:
        """Lays out the tab inside ``demo`` and wires its events.

        Args:
            demo: the page.
            record: keeps the session's last result.
        """
        with gr.Row(elem_classes="pd-lab", equal_height=False):
            with gr.Column(elem_classes="pd-controls", min_width=0):
                self._ask()
                self._settings()
                with gr.Accordion("About the model", open=False, elem_classes="pd-panel pd-about"):
                    self.card = gr.HTML(elem_id="model-card")
            self._results()
        inputs = (
            self.prompt, self.seconds, self.seed, self.samples, self.guidance, self.steps, self.damping
        )  # fmt: skip
        self._wire_run(self.start, [self.go.click, self.prompt.submit], inputs, record)
        for chip, (_, sentence) in zip(self.chips, EXAMPLES, strict=True):
            focus = "document.querySelector('#prompt textarea').focus();"
            chip.click(
                None, outputs=self.prompt, js=f"() => {{ {focus} return {json.dumps(sentence)}; }}", **QUIET
            )
        demo.load(self.describe_model, outputs=self.card, queue=False, **QUIET)

    def _ask(self) -> None:
        with gr.Column(elem_classes="pd-panel pd-ask", min_width=0):
            self.prompt = gr.Textbox(
                label="What do the two people do?",
                placeholder=EXAMPLES[0][1],
                lines=1,  # so that Enter generates; the style sheet gives it the height of three
                max_lines=6,
                elem_id="prompt",
                autofocus=True,
            )
            with gr.Row(elem_classes="pd-chips"):
                self.chips = [
                    gr.Button(name, size="sm", elem_classes="pd-chip", min_width=0) for name, _ in EXAMPLES
                ]
            self._go("Generate")

    def _settings(self) -> None:
        with gr.Column(elem_classes="pd-panel pd-settings", min_width=0):
            with gr.Row(elem_classes="pd-pair"):
                self.seconds = gr.Slider(
                    *SECONDS, value=GenerateRequest.seconds, step=0.5, label="Seconds",
                    info="Length of the motion.", elem_id="seconds",
                )  # fmt: skip
                self.samples = self._samples()
            self._sampling()

    def start(
        self,
        prompt: str,
        seconds: float,
        seed: float | None,
        samples: float,
        guidance: float,
        steps: float,
        damping: float,
        request: gr.Request,
    ) -> Iterator[Updates]:
        """Runs what the controls ask for; yields updates of the page."""
        fields = {
            "prompt": prompt,
            "seconds": seconds,
            "seed": seed,
            "samples": samples,
            "guidance": guidance,
            "steps": steps,
            "damping": damping,
        }
        yield from self.run(str(request.session_hash), fields)

    def describe_model(self) -> str:
        """The model card for the page."""
        try:
            return model_card(self.page.engine.info())
        except Exception as error:
            return status(error_line(error), tone="error")
