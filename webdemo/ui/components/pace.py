"""A switch between few denoising steps and many, beside the slider that takes any number of them."""

from __future__ import annotations

import gradio as gr

from webdemo.inference.requests import SamplingRequest

FAST, FAITHFUL = 8, SamplingRequest.steps
"""Steps of the two. With the shipped InterGen the rules obeyed at 8 and at 25 steps differ by no more than chance
(docs/scores.md)."""
AT_FIRST = FAST
"""The steps that the page begins with."""

CHOSEN = "(steps) => steps"
"""JavaScript that sets the slider as the switch says."""
FOLLOWED = f"(steps) => [{FAST}, {FAITHFUL}].includes(steps) ? steps : null"
"""JavaScript that sets the switch as the slider says; other numbers are neither."""


def pace_of(steps: int | None) -> int | None:
    """The choice of the switch for so many steps, None for neither."""
    return steps if steps in (FAST, FAITHFUL) else None


def pace_switch(elem_id: str) -> gr.Radio:
    """Fast or faithful; its values are steps."""
    return gr.Radio(
        [("Fast", FAST), ("Faithful", FAITHFUL)],
        value=AT_FIRST,
        label=f"{FAST} denoising steps or {FAITHFUL}",
        show_label=False,
        container=False,
        elem_id=elem_id,
        elem_classes="pd-way pd-pace",
    )
