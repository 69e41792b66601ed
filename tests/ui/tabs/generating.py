"""A tab Generate that is used: runs of short motions by the stub engine."""

from __future__ import annotations

from typing import Any

from tests.ui.tab_events import changes
from webdemo.ui.components.exports import Record
from webdemo.ui.tabs.generate import GenerateTab

FIELDS = {
    "prompt": "two people walk",
    "seconds": 2.0,
    "seed": 3,
    "samples": 1,
    "guidance": 2.5,
    "steps": 5,
    "damping": 0.7,
    "tries": 1,
}


def run(tab: GenerateTab, **changed: Any) -> list[dict[str, Any]]:
    """What each update of a run with :data:`FIELDS`, some of them changed, changes."""
    return [changes(tab.outputs, updates) for updates in tab.run("me", {**FIELDS, **changed})]


def result_of(tab: GenerateTab, **changed: Any) -> Record:
    """The record that such a run ends with."""
    return run(tab, **changed)[-1]["record"]
