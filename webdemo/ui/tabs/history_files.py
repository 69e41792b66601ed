"""Results that leave a history as one file, and come into it as theirs, on the History tab."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import gradio as gr

from webdemo.ui.context import PageContext
from webdemo.ui.history import Usage
from webdemo.ui.places import READING
from webdemo.ui.text.panels import status
from webdemo.ui.text.texts import say
from webdemo.ui.text.words import counted, text
from webdemo.ui.visitor import visitor

from .results import QUIET, Parts, Updates, said

AT_ONCE = 4
"""Imports and exports of everything at a time; the rest of the tab does not wait for them."""


class FilesPanel:
    """The part of the History tab that exports everything and takes results in.

    Args:
        page: what the tabs share; its history is there.
        refresh: reads the list of runs anew.
    """

    def __init__(self, page: PageContext, refresh: Callable[[list[str]], Updates]) -> None:
        self.page, self.history, self.refresh = page, page.history, refresh

    def build(self) -> None:
        """Lays out the panel, folded."""
        with gr.Accordion(say("history.all"), open=False, elem_id="history-files"):
            self.everything = gr.Button(say("history.export"), size="sm", elem_id="history-export-all")
            self.files = gr.File(
                label=say("history.import"),
                file_types=[".npz"],
                file_count="multiple",
                height=112,
                elem_id="history-import",
                elem_classes="pd-file",
            )

    def wire(self, view: Sequence[Any], line: gr.HTML, saved: gr.DownloadButton, removed: gr.State) -> None:
        """Wires the panel's events.

        Args:
            view: what ``refresh`` changes.
            line: says what happened.
            saved: the button that gives an exported file.
            removed: the runs that were removed last.
        """
        slow: dict[str, Any] = {"concurrency_limit": AT_ONCE, "concurrency_id": "history files", **QUIET}
        self.view, self.line, self.saved = view, line, saved
        self.everything.click(self.export_all, outputs=[line, saved], **slow)
        self.files.upload(self.take_in, inputs=[self.files, removed], outputs=[*view, line, self.files], **slow)

    def export(self, runs: Sequence[str]) -> tuple[str, Any]:
        """Writes runs, or all of them for none given, into one file; returns a line and the button's change."""
        owner = visitor().owner
        file = self.page.shelf.folder(self.history.weight(owner, runs)) / "pas-de-deux-results.zip"
        count = self.history.export(owner, runs, file)
        line = f"{counted(count, 'run').capitalize()} in one file of {file.stat().st_size / 2**20:.1f} MB."
        return status(line, tone="done"), gr.update(value=str(file), visible=True)

    @said
    def export_all(self) -> Parts:
        """Writes every finished run into one file."""
        return dict(zip((self.line, self.saved), self.export(()), strict=True))

    def take_in(self, files: Sequence[str] | None, removed: list[str]) -> Parts:
        """Adds results to the history."""
        taken = self._take_in([Path(file) for file in files or ()])
        return {**dict(zip(self.view, self.refresh(removed), strict=True)), **taken, self.files: None}

    @said
    def _take_in(self, files: Sequence[Path]) -> Parts:
        who = visitor()
        with READING.place():
            count = self.history.take_in(who.owner, files, address=who.address)
        return {self.line: status(f"Imported {counted(count, 'run')}.", tone="done")}


def room_html(usage: Usage) -> str:
    """A bar and a line on the room that a person uses and has; "" while it is less than half."""
    if usage.used < usage.allowed / 2:
        return ""
    parts = [
        f"{name} {_megabytes(size)}"
        for name, size in (
            ("runs", usage.runs),
            ("favourites", usage.favourites),
            ("studies", usage.studies),
            ("uploads and downloads", usage.temporary),
        )
        if size
    ]
    what = f": {', '.join(parts)}" if parts else ""
    full = (
        f" When runs and studies reach {_megabytes(usage.kept)} MB, your oldest runs make way; favourites and studies "
        "stay."
        if usage.used > 0.5 * usage.kept
        else ""
    )
    line = f"{_megabytes(usage.used)} of {_megabytes(usage.allowed)} MB used{what}.{full}"
    return (
        f'<p class="pd-status pd-room"><meter min="0" max="{usage.allowed:.0f}" high="{0.7 * usage.allowed:.0f}" '
        f'value="{usage.used:.0f}" aria-label="Room used"></meter><span>{text(line)}</span></p>'
    )


def _megabytes(size: float) -> str:
    """Megabytes to read: with one decimal below ten."""
    megabytes = size / 2**20
    return f"{megabytes:,.1f}" if 0 < megabytes < 9.95 else f"{megabytes:,.0f}"
