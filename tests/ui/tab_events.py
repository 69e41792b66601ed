"""A tab by itself, for the tests of its handlers."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, TypeVar

import gradio as gr

from webdemo.ui.tabs.job import JobTab
from webdemo.ui.tabs.source import SourcePanel

from .stub_engine import StubEngine
from .stub_page import stub_context

Tab = TypeVar("Tab", bound=JobTab)


def built(kind: type[Tab], files: Path) -> Tab:
    """A tab of this kind, laid out on a page of its own, with the stub engine; its files go to a folder."""
    engine = StubEngine()
    tab = kind(stub_context(engine, files))
    with gr.Blocks():
        tab.build(gr.State())
    return tab


def changes(names: Iterable[str], updates: Iterable[Any]) -> dict[str, Any]:
    """Updates by the names of their outputs, without those that change nothing."""
    return {name: update for name, update in zip(names, updates, strict=True) if update != gr.skip()}


def taken(panel: SourcePanel, updates: Mapping[Any, Any]) -> dict[str, Any]:
    """Updates of a panel by the names of its parts, without those that change nothing, or parts of the tab."""
    names = {id(part): name for shown in (panel.results, panel) for name, part in vars(shown).items()}
    return {names[id(part)]: update for part, update in updates.items() if id(part) in names and update != gr.skip()}
