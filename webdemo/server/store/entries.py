"""Rows of the history as the page takes them."""

from __future__ import annotations

import json
import time
from typing import Any

from webdemo.ui.history import Entry

from .database import Note, Run


def is_removed(run: Run) -> bool:
    """True for a run that its owner has removed, and may still bring back."""
    return run.note is not None and run.note.removed is not None


def fields_of(text: str) -> dict[str, Any]:
    """A column's JSON; empty if it is damaged."""
    try:
        found = json.loads(text or "{}")
    except ValueError:
        return {}
    return found if isinstance(found, dict) else {}


def entry_of(run: Run) -> Entry:
    """A row as the page takes it."""
    now, note = time.time(), run.note or Note(title="", tags="", text="", frame=None, thumbnail="")
    return Entry(
        id=run.id,
        kind=run.kind,
        title=note.title or run.title,
        state=run.state,
        message=run.message,
        created=run.created,
        request=fields_of(run.request),
        favourite=run.favourite,
        links=sum(link.until > now for link in run.links),
        tags=tuple(note.tags.split()),
        note=note.text,
        frame=note.frame,
        thumbnail=note.thumbnail,
    )
