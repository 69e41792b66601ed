"""Two people from one sentence or a class: the controls, the player and what is measured under it."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from typing import Any

import gradio as gr

from webdemo.inference.requests import DEFAULT_GUIDANCE, SECONDS, GenerateRequest
from webdemo.motion import InputError

from .classes import MODEL, installed_classes
from .examples import EXAMPLES
from .history import Opened
from .job_tab import QUIET, JobTab, Updates
from .panels import model_card, status
from .words import error_line

SENTENCE = GenerateRequest.model
"""The network that takes a sentence; the one that takes a class is :data:`.classes.MODEL`."""


class GenerateTab(JobTab):
    """Text, or a class → two people."""

    label = "Generate"
    restored = ("by_sentence", "class_name")

    def request(self, fields: Mapping[str, Any]) -> GenerateRequest:
        if fields.get("model") == MODEL and not fields["prompt"]:
            raise InputError("No class is chosen: choose what the two people do.")
        return GenerateRequest(**fields)

    def title(self, request: GenerateRequest) -> str:
        return request.prompt

    def opened(self, run: Opened) -> dict[gr.components.Component, Any]:
        """Also what was asked by: a sentence or a class."""
        asked = run.entry.request
        sentence, label, _ = self.asked_by(asked.get("model", SENTENCE))
        if asked.get("model") == MODEL:
            label = gr.update(value=asked.get("prompt"), visible=True)
        return super().opened(run) | {self.by_sentence: sentence, self.class_name: label}

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
            self.model, self.prompt, self.class_name, self.seconds, self.seed, self.samples, self.guidance,
            self.steps, self.damping,
        )  # fmt: skip
        self._wire_run(self.start, [self.go.click, self.prompt.submit], inputs, record)
        for chip, (_, sentence) in zip(self.chips, EXAMPLES, strict=True):
            focus = "document.querySelector('#prompt textarea').focus();"
            chip.click(
                None, outputs=self.prompt, js=f"() => {{ {focus} return {json.dumps(sentence)}; }}", **QUIET
            )
        fitted = [self.by_sentence, self.class_name, self.guidance]
        self.model.input(self.asked_by, inputs=self.model, outputs=fitted, queue=False, **QUIET)
        demo.load(self.describe_model, outputs=self.card, queue=False, **QUIET)

    def _ask(self) -> None:
        classes, self.class_card = installed_classes()
        with gr.Column(elem_classes="pd-panel pd-ask", min_width=0):
            self.model = gr.Radio(
                [("A sentence", SENTENCE), ("A class", MODEL)],
                value=SENTENCE,
                show_label=False,
                container=False,
                visible=bool(classes),
                elem_id="way",
                elem_classes="pd-way",
            )
            with gr.Column(min_width=0, elem_classes="pd-sentence") as self.by_sentence:
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
                        gr.Button(name, size="sm", elem_classes="pd-chip", min_width=0)
                        for name, _ in EXAMPLES
                    ]
            self.class_name = gr.Dropdown(
                classes,
                value=None,
                label="What do the two people do?",
                info=f"BiGraphDiff knows {len(classes)} classes.",
                visible=False,
                elem_id="class",
            )
            self._go("Generate")

    @staticmethod
    def asked_by(way: str) -> Updates:
        """What is asked for, a sentence with examples or a class, and the guidance that suits it."""
        guidance = DEFAULT_GUIDANCE.get(way, GenerateRequest.guidance)
        return gr.update(visible=way != MODEL), gr.update(visible=way == MODEL), gr.update(value=guidance)

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
        way: str,
        prompt: str,
        class_name: str | None,
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
            "model": way,
            "prompt": (class_name or "") if way == MODEL else prompt,
            "seconds": seconds,
            "seed": seed,
            "samples": samples,
            "guidance": guidance,
            "steps": steps,
            "damping": damping,
        }
        yield from self.run(str(request.session_hash), fields)

    def describe_model(self) -> str:
        """The cards of both models for the page."""
        try:
            return model_card(self.page.engine.info()) + (
                model_card(self.class_card) if self.class_card else ""
            )
        except Exception as error:
            return status(error_line(error), tone="error")
