"""The input of tabs that begin with a motion: a field for a file, and chips for other sources."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import gradio as gr

from webdemo.ui.text.texts import say, worded

FILE_TYPES = [".bvh", ".glb", ".vrm", ".vrma", ".npz", ".npy", ".c3d", ".trc", ".zip", ".skeleton", ".txt"]


def file_field(key: str, *, elem_id: str) -> gr.File:
    """A field that takes a motion file; ``key`` names its text."""
    named = say(key, types=" ".join(FILE_TYPES[:4]))  # all would lie under the cross that takes it away
    return gr.File(label=named, file_types=FILE_TYPES, height=64, elem_id=elem_id, elem_classes="pd-file")


def chip(label: str, *, elem_id: str | None = None) -> gr.Button:
    """A small round button."""
    return gr.Button(label, size="sm", elem_classes="pd-chip", elem_id=elem_id, min_width=0)


def example_chips(examples: Sequence[tuple[str, Path]]) -> list[gr.Button]:
    """A chip for each (name, file)."""
    return [chip(worded("examples", name)) for name, _ in examples]
