"""Two people from one sentence or a class: the controls, the player and what is measured under it."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from typing import Any

import gradio as gr

from motion import InputError
from webdemo.inference.actor import SECONDS
from webdemo.inference.methods import installed, method
from webdemo.inference.requests import GenerateRequest
from webdemo.ui.components.show import arrival_payload
from webdemo.ui.history import Opened
from webdemo.ui.text.classes import installed_classes, takes_class
from webdemo.ui.text.examples import CLIPS, EXAMPLES
from webdemo.ui.text.panels import model_card, status
from webdemo.ui.text.words import error_line

from .job import QUIET, JobTab, Updates


def generate_choices() -> list[tuple[str, str]]:
    """(label, name) of the methods that make two people: by what they take, and from the second on by name."""
    choices: list[tuple[str, str]] = []
    plain = {"words": "A sentence", "class": "A class"}
    for found in installed("generate"):
        kind = next((kind for kind in plain if kind in found.takes), "")
        choices.append((plain.pop(kind, found.label), found.name))
    return choices


ARRIVAL = "shake-hands.npz"
"""The example that plays before anything is asked for."""


class GenerateTab(JobTab):
    """Text, or a class → two people."""

    label = "Generate"
    restored = ("by_sentence", "class_name")

    def request(self, fields: Mapping[str, Any]) -> GenerateRequest:
        """See :meth:`JobTab.request`; raises InputError if no class is chosen."""
        if takes_class(fields.get("model", GenerateRequest.model)) and not fields["prompt"]:
            raise InputError("No class is chosen: choose what the two people do.")
        return GenerateRequest(**fields)

    def title(self, request: GenerateRequest) -> str:
        """The sentence or class."""
        return request.prompt

    def opened(self, run: Opened) -> dict[gr.components.Component, Any]:
        """Also what was asked by: a sentence or a class."""
        asked = run.entry.request
        model = asked.get("model", GenerateRequest.model)
        sentence, label, _ = self.asked_by(model)
        if takes_class(model):
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
            self._results(first=arrival_payload(CLIPS / ARRIVAL))
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
        choices = generate_choices()
        with gr.Column(elem_classes="pd-panel pd-ask", min_width=0):
            self.model = gr.Radio(
                choices,
                value=GenerateRequest.model,
                show_label=False,
                container=False,
                visible=len(choices) > 1,
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
        """Shows the input that a method takes, a sentence with examples or a class, and sets its guidance."""
        guidance, by_class = method(way).default("guidance", GenerateRequest.guidance), takes_class(way)
        return gr.update(visible=not by_class), gr.update(visible=by_class), gr.update(value=guidance)

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
            "prompt": (class_name or "") if takes_class(way) else prompt,
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
