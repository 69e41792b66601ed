"""Fields of the page: what several tabs ask for in the same way."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any

import gradio as gr

from motion.formats import READABLE, RIGS
from motion.formats.recording import Animations
from webdemo.ui.text.texts import say, texts


def file_field(key: str, *, elem_id: str) -> gr.File:
    """A field that takes a motion file; ``key`` names its text."""
    named = say(key, types=" ".join(RIGS))  # all would lie under the cross that takes it away
    return gr.File(label=named, file_types=READABLE, height=64, elem_id=elem_id, elem_classes="pd-file")


def chip(label: str, *, elem_id: str | None = None) -> gr.Button:
    """A small round button."""
    return gr.Button(label, size="sm", elem_classes="pd-chip", elem_id=elem_id, min_width=0)


MOST_OFFERED = 200
"""Animations in the list; an endpoint takes the name or the number of any other."""


def animation_field(elem_id: str) -> gr.Dropdown:
    """The list, hidden until there is something to choose."""
    return gr.Dropdown(
        [], value=None, label=say("actor.animation"), elem_id=elem_id, visible=False, filterable=False, min_width=0
    )


def animation_labels(animations: Animations | None) -> tuple[str, ...]:
    """A label for each animation, "1 · idle"; none where there is nothing to choose."""
    if animations is None or not animations.note:
        return ()
    return tuple(
        f"{number} · {name}" if name else str(number) for number, name in enumerate(animations.names[:MOST_OFFERED], 1)
    )


def animation_list(labels: tuple[str, ...], chosen: int | None) -> Any:
    """An update of the list: these labels, with the chosen number, which is the first by default."""
    value = (chosen if chosen in range(1, len(labels) + 1) else 1) if labels else None
    choices = [(label, number) for number, label in enumerate(labels, 1)]
    return gr.update(choices=choices, value=value, visible=bool(labels))


def slider(
    key: str,
    bounds: tuple[float, float],
    value: float,
    step: float = 1,
    *,
    kind: type[gr.Slider] = gr.Slider,
    **more: Any,
) -> gr.Slider:
    """A slider called by the text of a key, with the text of ``key_info`` below it where there is one."""
    info = texts().get(f"{key}_info")
    return kind(*bounds, value=value, step=step, label=say(key), info=info, buttons=[], **more)


def prompt_field(label: str, placeholder: str, elem_id: str, **more: Any) -> gr.Textbox:
    """A field for sentences, of one line, so that Enter runs it; the style sheet gives it the height of three."""
    return gr.Textbox(label=label, placeholder=placeholder, lines=1, max_lines=8, elem_id=elem_id, **more)


def method_list(choices: Sequence[tuple[str, str]], value: str, elem_id: str) -> gr.Dropdown:
    """The list of a tab's methods, (label, name) each."""
    return gr.Dropdown(choices, value=value, label=say("react.method"), elem_id=elem_id, min_width=0, filterable=False)


def address_field(key: str, elem_id: str, **more: Any) -> gr.Textbox:
    """A text to be copied."""
    return gr.Textbox(label=say(key), interactive=False, buttons=["copy"], elem_id=elem_id, **more)


def looked_up(table: Mapping[str, Sequence[Any]]) -> str:
    """JavaScript that answers with the updates of a table by the value, or values joined by "/", of its inputs.

    The browser answers at once, so that no late update takes back what was set meanwhile.
    """
    return f"(...keys) => ({json.dumps(table)})[keys.map((key) => key ?? '').join('/')]"


class FittedSlider(gr.Slider):
    """A slider whose bounds follow a motion: a value still on its way when they change is moved into them."""

    is_template = True

    def preprocess(self, payload: float) -> float:
        """The value within the bounds of now."""
        return super().preprocess(min(max(payload, self.minimum), self.maximum))
