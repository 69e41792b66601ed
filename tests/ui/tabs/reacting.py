"""A tab React that is used: a file is uploaded, a run is made."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from tests.ui.tab_events import changes, taken
from webdemo.ui.tabs.react import ReactTab

FIELDS = {
    "person": "a",
    "start": 0.0,
    "end": 10.0,
    "role": "a",
    "prompt": "they walk",
    "seed": 3,
    "samples": 1,
    "guidance": 2.5,
    "steps": 5,
    "damping": 0.7,
}


def upload(tab: ReactTab, path: Path) -> list[dict[str, Any]]:
    """What each update of an upload changes."""
    return [taken(tab.actor, updates) for updates in tab.actor.upload(str(path))]


def run(tab: ReactTab, source: Any, **changed: Any) -> list[dict[str, Any]]:
    """What each update of a run with :data:`FIELDS`, some of them changed, changes."""
    fields = {"source": source, **FIELDS, **changed}
    return [changes(tab.outputs, updates) for updates in tab.run("me", fields)]
