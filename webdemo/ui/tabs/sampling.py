"""The form of the settings with which a motion is sampled: the same on every tab that samples one."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import gradio as gr

from webdemo.inference.method import DEFAULT_STEPS
from webdemo.inference.requests import GenerateRequest, SamplingRequest
from webdemo.inference.requests.sampling import DAMPING, GUIDANCE, MAX_SEED, SAMPLES, STRICTNESS, TRIES
from webdemo.ui.components.fields import slider
from webdemo.ui.text.texts import say

from .results import QUIET

STEPS_SHOWN = (1, 100)
"""Steps that the slider offers; the API takes more."""
FAST, FAITHFUL = DEFAULT_STEPS, 50
"""Steps of the two choices of the switch over the slider."""
_FOLLOWED = f"(steps) => [{FAST}, {FAITHFUL}].includes(steps) ? steps : null"
"""JavaScript that sets the switch as the slider says; other numbers are neither choice."""


class Sampling:
    """*Fast* or *Faithful*, guidance, steps, damping and, for sentences, the plan; in *More* samples, seed and tries.

    Args:
        prefix: before the ids of the elements.
        sentences: puts the plan's slider under the others.
    """

    tries: gr.Slider | None = None
    strictness: gr.Slider | None = None

    def __init__(self, prefix: str, *, sentences: bool = False) -> None:
        self.prefix, self.sentences = prefix, sentences

    def build(self, beside: Callable[[], None] = lambda: None) -> None:
        """Lays out the form; ``beside`` lays out more under the sliders."""
        self.pace = gr.Radio(
            [(say("sampling.fast"), FAST), (say("sampling.faithful"), FAITHFUL)],
            value=FAST,
            label=say("sampling.pace", fast=FAST, faithful=FAITHFUL),
            show_label=False,
            container=False,
            elem_id=f"{self.prefix}pace",
            elem_classes="pd-way",
        )
        usual = SamplingRequest
        self.guidance = self._slider("sampling.guidance", GUIDANCE, usual.guidance, 0.1)
        self.steps = self._slider("sampling.steps", STEPS_SHOWN, DEFAULT_STEPS)
        self.damping = self._slider("sampling.damping", DAMPING, usual.damping, 0.05)
        if self.sentences:
            usual_plan = GenerateRequest.strictness
            self.strictness = self._slider("sampling.plan", STRICTNESS, usual_plan, 0.05)
        beside()
        self.laid = gr.HTML(elem_id=f"{self.prefix}laid")
        with gr.Accordion(say("sampling.more"), open=False, elem_id=f"{self.prefix}more", elem_classes="pd-advanced"):
            self.samples = self._slider("sampling.samples", SAMPLES, usual.samples)
            self.seed = seed_field(self.prefix)
            if self.sentences:
                self.tries = self._slider("sampling.tries", TRIES, usual.tries)

    def _slider(self, key: str, bounds: tuple[float, float], value: float, step: float = 1) -> gr.Slider:
        return slider(key, bounds, value, step, elem_id=self.prefix + key.split(".")[1])

    @property
    def controls(self) -> dict[str, gr.components.Component]:
        """The controls by the names of a request's fields."""
        more = {"tries": self.tries, "strictness": self.strictness}
        return {
            "seed": self.seed,
            "samples": self.samples,
            "guidance": self.guidance,
            "steps": self.steps,
            "damping": self.damping,
            **{name: control for name, control in more.items() if control is not None},
        }

    def wire(self, another: gr.Button, go: gr.Button) -> None:
        """Lets the switch and the slider follow each other, and ``another`` draw a seed and press ``go``."""
        self.pace.input(None, inputs=self.pace, outputs=self.steps, js="(steps) => steps", **QUIET)
        self.steps.change(None, inputs=self.steps, outputs=self.pace, js=_FOLLOWED, **QUIET)
        drawn = another.click(None, outputs=self.seed, js=f"() => Math.floor(Math.random() * {MAX_SEED + 1})", **QUIET)
        drawn.then(None, js=f"() => document.getElementById({go.elem_id!r}).click()", **QUIET)


def seed_field(prefix: str, info: str = "sampling.seed_info", **options: Any) -> gr.Number:
    """The field of the seed; an empty one is drawn."""
    return gr.Number(
        value=SamplingRequest.seed,
        label=say("sampling.seed"),
        info=say(info),
        elem_id=f"{prefix}seed",
        min_width=0,
        **options,
    )
