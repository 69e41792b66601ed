"""A switch between few denoising steps and many, beside the slider that takes any number of them."""

from __future__ import annotations

import gradio as gr

from webdemo.inference.method import DEFAULT_STEPS
from webdemo.ui.text.texts import say

FAST, FAITHFUL = DEFAULT_STEPS, 50
"""Steps of the two."""

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
        [(say("sampling.fast"), FAST), (say("sampling.faithful"), FAITHFUL)],
        value=FAST,
        label=say("sampling.pace", fast=FAST, faithful=FAITHFUL),
        show_label=False,
        container=False,
        elem_id=elem_id,
        elem_classes="pd-way pd-pace",
    )
