"""The notebook of runs in the browser: its value and its events."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from typing import Annotated, Any, TypeAlias

from pydantic import Field, TypeAdapter, ValidationError

from motion import InputError
from webdemo.inference.methods import label_of
from webdemo.ui.history import Entry, Found, Search
from webdemo.ui.text.words import counted, day, method_label, settings

from .accepts import Finite, Flag, Sent, Text
from .part import Part

STEP = 60
"""Runs that are shown at first, and how many more at a time."""
MOST_SHOWN = 500
UNKNOWN = "The notebook sent something unknown: reload the page."
_MARKS = {"running": "… running", "failed": "✕ failed", "cancelled": "✕ cancelled", "interrupted": "✕ interrupted"}


Word: TypeAlias = Annotated[str, Field(strict=True, max_length=200)]


class SentSearch(Sent):
    """A search as the browser sends it."""

    words: Word = ""
    kind: Word = ""
    model: Word = ""
    tag: Word = ""
    starred: Flag = False


class Action(Sent):
    """A visitor's action in the notebook, as the browser sends it.

    Attributes:
        act: what is done, as ``static/notebook`` calls it.
        ids: of the chosen runs.
        search: what is searched for.
        limit: how many runs are shown at most.
        title, tags, note: of a run that is described.
    """

    act: Text
    ids: list[Text] = Field(max_length=MOST_SHOWN)
    search: SentSearch | None = None
    limit: Finite | None = None
    title: Text | None = None
    tags: Text | None = None
    note: Text | None = None

    @classmethod
    def read(cls, data: Any) -> Action:
        """The action that a browser sent; raises InputError for anything that the notebook does not send."""
        try:
            return cls.model_validate(data)
        except ValidationError:
            raise InputError(UNKNOWN) from None

    @property
    def one(self) -> str:
        """The id of the only chosen run; raises InputError where there is none, or several."""
        if len(self.ids) != 1:
            raise InputError("Choose a run first." if not self.ids else "Choose one run only.")
        return self.ids[0]

    @property
    def wanted(self) -> Search:
        """The search."""
        most = int(self.limit or 0)
        asked = (self.search or SentSearch()).model_dump()
        return Search(**asked, limit=most if STEP <= most <= MOST_SHOWN else STEP)


class NotebookView(Part):
    """The runs of a history as cards; its value is what :func:`shown` gives.

    What a visitor does arrives as the data of its events, an :class:`Action`.

    Args:
        elem_id: id of the element in the page.
    """

    accepts_event = TypeAdapter(Action)
    folder = "notebook"
    module = "notebook.js"


def shown(listed: Found, *, empty: str, removed: int = 0, search: Search | None = None) -> dict[str, Any]:
    """The value of a :class:`NotebookView`.

    Args:
        listed: by a search.
        empty: said where nothing is listed, a sentence or the key of a text.
        removed: runs that can be brought back.
        search: what was searched for; everything by default. The browser drops an answer to another search.
    """
    asked = asdict(search or Search())
    return {
        "entries": [_card(entry) for entry in listed.entries],
        "total": listed.total,
        "tags": list(listed.tags),
        "models": [[name, label_of(name)] for name in listed.models],
        "empty": empty,
        "removed": removed,
        "step": STEP,
        "search": {name: asked[name] for name in asked if name != "limit"},
    }


def _card(entry: Entry) -> dict[str, Any]:
    told = {name: value for name, value in asdict(entry).items() if name not in ("request", "created")}
    return told | {"facts": facts(entry), "settings": settings(entry.request)}


def made_by(label: str, asked: Mapping[str, Any]) -> list[str]:
    """The method of a request, by its label, the length and the seed, as far as they are known."""
    parts = [label] if label else []
    seconds = asked.get("seconds")
    parts += [f"{seconds:g} s"] if isinstance(seconds, (int, float)) and 0 < seconds < 1e6 else []
    return parts + ([f"seed {asked['seed']}"] if isinstance(asked.get("seed"), int) else [])


def facts(entry: Entry) -> str:
    """One line for a run: by which method, how long, its seed, when, and marks."""
    asked = entry.request
    parts = made_by(method_label(asked), asked)
    parts.append(day(entry.created, " %H:%M"))
    parts += [_MARKS[entry.state]] if entry.state in _MARKS else []
    parts += [counted(entry.links, "link")] if entry.links else []
    return " · ".join(parts)
