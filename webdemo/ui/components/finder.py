"""The search over acts and runs that Ctrl K opens. What it lists travels as data and is set as text."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Any, ClassVar

import gradio as gr

from acts import Act, lexicon
from acts.captions import short
from webdemo.ui.history import Search
from webdemo.ui.visitor import visitor

from .part import Part

if TYPE_CHECKING:
    from webdemo.ui.context import Notebook

_RUNS = 200
"""The newest runs, which are searched by their titles; *History* searches all of them."""


class Finder(Part):
    """A button and a dialog; its prop ``known`` is what :func:`known` gives, and its value is always None.

    Args:
        elem_id: id of the element in the page.
    """

    folder = "finder"
    styled = True
    declared: ClassVar = {"known": None}

    def wire(self, history: Notebook, **quiet: Any) -> None:
        """Answers the browser, which asks whenever the dialog opens; ``quiet`` are the options of the page's events."""
        self.input(lambda: gr.update(known=known(history)), outputs=self, concurrency_limit=4, **quiet)


def known(history: Notebook) -> dict[str, Any]:
    """What the search finds.

    Returns:
        ``acts``, each act that bodies show in a few words and a sentence that has it; ``runs``, the id, the title and
        the kind of the visitor's newest runs that can be opened.
    """
    runs = history.search(visitor().owner, Search(limit=_RUNS)).entries
    done = [[run.id, run.title, run.kind] for run in runs if run.state == "done"]
    return {"acts": _acts(), "runs": done}


@cache
def _acts() -> list[list[str]]:
    rows = [
        [short(Act(id="1", act=name, agents=("a",), patient="b"), entry), entry.reads[0]]
        for name, entry in lexicon().entries.items()
        if entry.shown and entry.reads
    ]
    return sorted(rows)
