"""The inputs of a motion file: the field, chips for other sources, and the choice among a file's animations."""

from __future__ import annotations

from typing import Any

import gradio as gr

from motion.formats import READABLE, RIGS
from motion.formats.recording import Animations
from webdemo.ui.text.texts import say


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
