"""The reading of a prompt, under it: the sentence with its marks, and its plan as chips on two lanes.

The browser (``static/reading``) asks as somebody types; what is shown is made here, from the plan that
:func:`acts.read` gives. What a user typed travels as data and is set as text.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import gradio as gr
from pydantic import TypeAdapter

from acts import Act, Plan, lexicon, read
from acts.captions import short
from webdemo.ui.text.words import error_line

from .accepts import Sent, Text

READING_FOLDER = Path(__file__).resolve().parents[3] / "static" / "reading"

gr.set_static_paths([READING_FOLDER])

READERS = 2
"""Texts that are read at once; further ones wait."""

_ON_LOAD = """
const config = window.gradio_config || {};
const root = (config.root || new URL(".", document.baseURI).href).replace(/[/]$/, "");
const encode = (path) => path.split("/").map(encodeURIComponent).join("/");
const file = (path) => root + (config.api_prefix || "/gradio_api") + "/file=" + encode(path);
import(file(%s)).then((reading) => reading.mount(element, props, watch, trigger));
"""
_TYPED = """(text) => ({ __type__: "update", props: { text: text ?? "" } })"""
"""JavaScript that tells the component what is typed; it waits for a pause and asks."""


class SentReading(Sent):
    """The value as the browser sends it: the ``text`` that is to be read."""

    text: Text = ""


class Reading(gr.HTML):
    """Shows how a text is understood.

    Props beside the value, which is a :class:`SentReading`: ``text``, what is typed; ``shown``, see :func:`shown`.
    """

    accepts = TypeAdapter(SentReading | None)

    def __init__(
        self, value: dict[str, Any] | None = None, *, elem_id: str | None = None, **kwargs: Any
    ) -> None:
        kwargs = {
            "html_template": (READING_FOLDER / "reading.html").read_text(encoding="utf-8"),
            "css_template": (READING_FOLDER / "reading.css")
            .read_text(encoding="utf-8")
            .replace("\n.", "\n& ."),
            "js_on_load": _ON_LOAD % json.dumps((READING_FOLDER / "main.js").as_posix()),
            "apply_default_css": False,
            "text": "",
            "shown": None,
            **kwargs,
        }
        super().__init__(value, elem_id=elem_id, **kwargs)

    def follow(self, prompt: gr.Textbox, **quiet: Any) -> None:
        """Reads what is typed into a prompt; ``quiet`` are the options of the page's own events."""
        prompt.change(None, inputs=prompt, outputs=self, js=_TYPED, **quiet)
        self.input(
            answer, inputs=self, outputs=self, trigger_mode="always_last",
            concurrency_limit=READERS, concurrency_id="reading", **quiet,
        )  # fmt: skip

    def preprocess(self, payload: Any) -> Any:
        """The value as the browser sent it."""
        return payload

    def postprocess(self, value: Any) -> Any:
        """The value itself."""
        return value

    def api_info(self) -> dict[str, Any]:
        """Describes the component's value for the API page."""
        return {"type": "object", "description": "a text that is to be read, or null"}

    def example_payload(self) -> None:
        """None: the component takes no example."""
        return None

    def example_value(self) -> None:
        """None: the component takes no example."""
        return None

    def get_block_name(self) -> str:
        """Gradio's name of the front end that draws it."""
        return "html"


def answer(sent: Any) -> dict[str, Any]:
    """The update that shows how the text that was sent is understood."""
    text = str(sent.get("text") or "") if isinstance(sent, Mapping) else ""
    try:
        found = shown(text, read(text))
    except Exception as error:
        found = {"text": text, "error": error_line(error)}
    return gr.update(shown=found)


def shown(text: str, plan: Plan) -> dict[str, Any]:
    """A plan as the component draws it.

    Returns:
        ``text``, for which it was asked; ``plan`` as JSON; ``beats``, the ids of its acts, one list for each; ``said``,
        each act in a few words by its id; ``nearest``, the same by the name of each act that is offered for words that
        were not understood.
    """
    entries = lexicon().entries
    nearest = dict.fromkeys(name for part in plan.unread for name in part.nearest)
    return {
        "text": text,
        "plan": plan.model_dump(mode="json"),
        "beats": [[act.id for act in group] for group in plan.beats()],
        "said": {act.id: short(act, entries.get(act.act)) for act in plan.acts},
        "nearest": {name: entry_words(name) for name in nearest},
    }


def entry_words(name: str) -> str:
    """An act of the lexicon in a few words, as one person does it."""
    return short(Act(id="1", act=name, agents=("a",), patient="b"), lexicon().entries.get(name))
