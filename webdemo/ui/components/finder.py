"""The search over acts, controls, tabs and runs that Ctrl K opens. What it lists travels as data and is set as text."""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path
from typing import Any

import gradio as gr
from pydantic import TypeAdapter

from acts import Act, lexicon
from acts.captions import short
from webdemo.ui.history import HistoryLike, Search
from webdemo.ui.visitor import visitor

FINDER_FOLDER = Path(__file__).resolve().parents[3] / "static" / "finder"
_RUNS = 200
"""The newest runs, which are searched by their titles; *History* searches all of them."""

gr.set_static_paths([FINDER_FOLDER])

_ON_LOAD = """
const config = window.gradio_config || {};
const root = (config.root || new URL(".", document.baseURI).href).replace(/[/]$/, "");
const encode = (path) => path.split("/").map(encodeURIComponent).join("/");
import(root + (config.api_prefix || "/gradio_api") + "/file=" + encode(%s))
  .then((finder) => finder.mount(element, props, watch, trigger));
"""


class Finder(gr.HTML):
    """A button and a dialog; its prop ``known`` is what :func:`known` gives, and its value is always None.

    Args:
        elem_id: id of the element in the page.
    """

    accepts = TypeAdapter(None)

    def __init__(self, value: None = None, *, elem_id: str | None = None, **kwargs: Any) -> None:
        kwargs = {
            "html_template": (FINDER_FOLDER / "finder.html").read_text(encoding="utf-8"),
            "css_template": "\n" + (FINDER_FOLDER / "finder.css").read_text(encoding="utf-8"),
            "js_on_load": _ON_LOAD % json.dumps((FINDER_FOLDER / "main.js").as_posix()),
            "apply_default_css": False,
            "known": None,
            **kwargs,
        }
        kwargs["css_template"] = kwargs["css_template"].replace("\n.", "\n& .")
        super().__init__(value, elem_id=elem_id, **kwargs)

    def wire(self, history: HistoryLike | None, **quiet: Any) -> None:
        """Answers the browser, which asks whenever the dialog opens; ``quiet`` are the options of the page's events."""
        self.input(lambda: gr.update(known=known(history)), outputs=self, concurrency_limit=4, **quiet)

    def preprocess(self, payload: Any) -> None:
        """None: nothing is sent."""
        return None

    def postprocess(self, value: Any) -> Any:
        """The value itself."""
        return value

    def api_info(self) -> dict[str, Any]:
        """The kind of value, for the API page."""
        return {"type": "null", "description": "nothing"}

    def example_payload(self) -> None:
        """None: the component takes no example."""
        return None

    def example_value(self) -> None:
        """None: the component takes no example."""
        return None

    def get_block_name(self) -> str:
        """Gradio's name of the front end that draws it."""
        return "html"


def known(history: HistoryLike | None) -> dict[str, Any]:
    """The part of the list that the browser cannot know.

    Returns:
        ``acts``, each act that bodies show in a few words and a sentence that has it; ``runs``, the id, the title and
        the kind of the visitor's newest runs that can be opened.
    """
    runs = history.search(visitor().owner, Search(limit=_RUNS)).entries if history is not None else ()
    done = [[run.id, run.title, run.kind] for run in runs if run.state == "done"]
    return {"acts": _acts(), "runs": done}


@cache
def _acts() -> list[list[str]]:
    found = [
        [short(Act(id="1", act=name, agents=("a",), patient="b"), entry), entry.reads[0]]
        for name, entry in lexicon().entries.items()
        if entry.shown and entry.reads
    ]
    return sorted(found)
