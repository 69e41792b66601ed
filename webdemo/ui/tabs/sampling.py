"""The settings of a tab whose motion is sampled: seed, samples, guidance, steps and damping."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import gradio as gr

from webdemo.inference.method import DEFAULT_STEPS
from webdemo.inference.requests import DAMPING, GUIDANCE, MAX_SEED, SAMPLES, TRIES, SamplingRequest
from webdemo.ui.components.pace import CHOSEN, FOLLOWED, pace_of, pace_switch
from webdemo.ui.components.settings import ADVANCED, advanced_label, folded_at_first
from webdemo.ui.text.texts import say

from .results import QUIET, ResultsTab

STEPS_SHOWN = (1, 100)
"""What the slider offers; the API takes more."""
_DAMPING_INFO = say("sampling.damping_info")
_GUIDANCE_INFO = say("sampling.guidance_info")
_STEPS_INFO = say("sampling.steps_info")
_TRIES_INFO = say("sampling.tries_info")
_SEED_INFO = say("sampling.seed_info")
_SAMPLES_INFO = say("sampling.samples_info")


class SamplingTab(ResultsTab):
    """The part of a tab that sets how its motion is sampled, for tabs that have such settings."""

    dice: gr.Button | None = None
    """Draws a seed, where the tab's motion is random."""
    folded: gr.Accordion | None = None
    """Holds guidance, steps and damping, where the tab has them."""
    more: gr.Accordion | None = None
    """Holds the settings that are rarely needed, where the tab has them."""
    laid: gr.HTML | None = None
    """Says what share of the motion the plan lays out, where the tab takes sentences."""
    pace: gr.Radio | None = None
    """Switches between few steps and many, where the tab has it."""
    tries: gr.Slider | None = None
    """Seeds to try until the motion shows all that is said, where the tab takes sentences."""
    compare: dict[str, Any]
    """The event that says what was changed since the result; set where runs are wired."""

    def _sampling(self, beside: Callable[[], Sequence[gr.Radio]] = tuple, *, said: bool = False) -> None:
        """Guidance, steps, damping and ``beside`` under a line with their values; in *More* samples and the seed.

        ``said``, in a tab of sentences, puts a switch over them, fast or faithful, a line under them, how much of
        the motion is planned, and tries into *More*.
        """
        if said:
            self.pace = pace_switch(self._id("pace"))
        values = (SamplingRequest.guidance, DEFAULT_STEPS, SamplingRequest.damping)
        with gr.Accordion(
            folded_at_first(*values), open=True, elem_id=self._id("advanced"), elem_classes="pd-advanced"
        ) as self.folded:
            self.guidance = gr.Slider(
                *GUIDANCE,
                value=values[0],
                step=0.1,
                label=say("sampling.guidance"),
                info=_GUIDANCE_INFO,
                elem_id=self._id("guidance"),
            )
            self.steps = gr.Slider(
                *STEPS_SHOWN,
                value=values[1],
                step=1,
                label=say("sampling.steps"),
                info=_STEPS_INFO,
                elem_id=self._id("steps"),
            )
            self.damping = gr.Slider(
                *DAMPING,
                value=values[2],
                step=0.05,
                label=say("sampling.damping"),
                info=_DAMPING_INFO,
                elem_id=self._id("damping"),
            )
            added = beside()
            if said:
                self.laid = gr.HTML(elem_id=self._id("laid"))
        with gr.Accordion(
            say("sampling.more"), open=False, elem_id=self._id("more"), elem_classes="pd-advanced"
        ) as self.more:
            self._more(said=said)
        tries = [] if self.tries is None else [self.tries]
        parts: list[Any] = [self.guidance, self.steps, self.damping, *tries, *added]
        # A folded part tells nobody of its changes before it was seen, so others also use this.
        self.tell_advanced = {"inputs": parts, "outputs": self.folded, "js": ADVANCED, **QUIET}
        gr.on([part.change for part in parts], None, **self.tell_advanced)
        if self.pace is not None:
            self.steps.change(None, inputs=self.steps, outputs=self.pace, js=FOLLOWED, **QUIET)

    def _more(self, *, said: bool) -> None:
        """The settings that are rarely needed."""
        self.samples = gr.Slider(
            *SAMPLES,
            value=SamplingRequest.samples,
            step=1,
            label=say("sampling.samples"),
            info=_SAMPLES_INFO,
            elem_id=self._id("samples"),
        )
        with gr.Row(elem_classes="pd-seed"):
            self.seed = gr.Number(
                value=SamplingRequest.seed,
                label=say("sampling.seed"),
                info=_SEED_INFO,
                elem_id=self._id("seed"),
                elem_classes="pd-seed-field",
                min_width=0,
            )
            self.dice = gr.Button(
                say("sampling.random"), size="sm", elem_id=self._id("dice"), elem_classes="pd-dice", min_width=0
            )
        if said:
            self.tries = gr.Slider(
                *TRIES,
                value=SamplingRequest.tries,
                step=1,
                label=say("sampling.tries"),
                info=_TRIES_INFO,
                elem_id=self._id("tries"),
            )

    def _wire_sampling(self) -> None:
        """The switch of the pace and the button that draws a seed, where the tab has them."""
        if self.pace is not None:
            chosen = self.pace.input(None, inputs=self.pace, outputs=self.steps, js=CHOSEN, **QUIET)
            chosen.then(None, **self.tell_advanced).then(None, **self.compare)
        if self.dice is None:
            self.another.visible = False
            return
        drawn = f"() => Math.floor(Math.random() * {MAX_SEED + 1})"
        press = f"() => document.getElementById({self._id('generate')!r}).click()"
        self.dice.click(None, outputs=self.seed, js=drawn, **QUIET)
        self.another.click(None, outputs=self.seed, js=drawn, **QUIET).then(None, js=press, **QUIET)

    def _opened_sampling(self, request: Mapping[str, Any]) -> dict[Any, Any]:
        """Updates that show the settings of a kept request."""
        found: dict[Any, Any] = {}
        values: list[Any] = [request.get(name) for name in ("guidance", "steps", "damping")]
        values.append(request.get("tries") or 1)
        if self.folded is not None and None not in values:
            found[self.folded] = gr.update(label=advanced_label(*values))
        if self.tries is not None:
            found[self.tries] = gr.update(value=values[-1])
        if self.pace is not None:
            found[self.pace] = gr.update(value=pace_of(request.get("steps")))
        return found
