"""Settings that are fitted to a choice or to a motion."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any

import gradio as gr


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
