"""A history as one file: everything written, or the runs of a file added, on the History tab."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import closing
from pathlib import Path
from typing import Any

import gradio as gr

from motion import InputError
from webdemo.inference.cancel import CancelToken
from webdemo.inference.requests import Cancelled
from webdemo.ui.context import PageContext
from webdemo.ui.history import HistoryLike, Usage
from webdemo.ui.text.panels import status
from webdemo.ui.text.said import said
from webdemo.ui.text.texts import say
from webdemo.ui.text.words import error_line, text
from webdemo.ui.visitor import visitor

from .job import QUIET, Updates

LARGEST_IMPORT = 50 * 2**20
"""Bytes of the largest upload."""
AT_ONCE = 4
"""Imports and exports of everything at a time; the rest of the tab does not wait for them."""
_TELL_EVERY = 0.25
"""Seconds between two lines about an import."""


class WorkspacePanel:
    """The part of the History tab that exports everything and imports a workspace.

    Args:
        page: what the tabs share; its history is there.
        history: of the page.
        refresh: reads the list of runs anew.
    """

    def __init__(
        self, page: PageContext, history: HistoryLike, refresh: Callable[[list[str]], Updates]
    ) -> None:
        self.page, self.history, self.refresh = page, history, refresh
        self._imports: dict[str, CancelToken] = {}

    def build(self) -> None:
        """Lays out the panel, folded."""
        with gr.Accordion(say("history.all"), open=False, elem_id="history-workspace"):
            self.everything = gr.Button(say("history.export"), size="sm", elem_id="history-export-all")
            self.file = gr.File(
                label=say("history.import"), file_types=[".zip"], height=112, elem_id="history-import",
                elem_classes="pd-file",
            )  # fmt: skip
            self.stop = gr.Button(
                say("history.stop"), size="sm", visible=False, elem_id="history-import-cancel"
            )

    def wire(
        self, demo: gr.Blocks, view: Sequence[Any], line: gr.HTML, saved: gr.DownloadButton, removed: gr.State
    ) -> None:
        """Wires the panel's events.

        Args:
            demo: the page; whoever leaves it cancels their import.
            view: what ``refresh`` changes.
            line: says what happened.
            saved: the button that gives an exported file.
            removed: the runs that were removed last.
        """
        slow: dict[str, Any] = {"concurrency_limit": AT_ONCE, "concurrency_id": "workspace", **QUIET}
        self.everything.click(self.export_all, outputs=[line, saved], **slow)
        self.file.upload(
            self.take_in, inputs=[self.file, removed], outputs=[*view, line, self.file, self.stop], **slow
        )
        self.stop.click(self.cancel, queue=False, **QUIET)
        demo.unload(self.cancel)

    def export(self, runs: Sequence[str]) -> tuple[str, Any]:
        """Writes runs, or all of them for none given, into one file; returns a line and the button's change."""
        owner = visitor().owner
        folder = self.page.shelf.folder(self.history.weight(owner, runs))
        file = folder / "pas-de-deux-workspace.zip"
        count = self.history.export(owner, runs, file)
        size = file.stat().st_size
        large = (
            "" if size <= LARGEST_IMPORT else ", more than can be imported at once: export fewer runs as well"
        )
        line = f"{runs_line(count).capitalize()} in one file of {size / 2**20:.1f} MB{large}."
        return status(line, tone="done"), gr.update(value=str(file), visible=True)

    def export_all(self) -> Updates:
        """Writes every finished run into one file."""
        try:
            return self.export(())
        except Exception as error:
            return status(error_line(error), tone="error"), gr.update(visible=False)

    def take_in(self, file: str | None, removed: list[str], request: gr.Request) -> Iterator[Updates]:
        """Adds the runs of an exported file, and says how far it is."""
        session, token, who = str(request.session_hash), CancelToken(), visitor()
        self._imports[session] = token
        skipped = (gr.skip(), gr.skip())
        yield *skipped, status("Importing …", tone="busy"), gr.skip(), gr.update(visible=True)
        try:
            if not file:
                raise InputError("There is no workspace: choose a .zip of Export.")
            told, total = time.monotonic(), 0
            with closing(self.history.take_in(who.owner, Path(file), address=who.address)) as steps:
                for done, total in steps:
                    token.raise_if_cancelled()
                    if time.monotonic() - told > _TELL_EVERY:
                        told = time.monotonic()
                        line = status(f"Importing: {done} of {runs_line(total)} …", tone="busy")
                        yield *skipped, line, gr.skip(), gr.skip()
            line = status(f"Imported {runs_line(total)}.", tone="done")
        except Cancelled:
            line = status("The import was cancelled: nothing was added.", tone="warning")
        except Exception as error:
            line = status(error_line(error), tone="error")
        finally:
            self._imports.pop(session, None)
        yield *self.refresh(removed), line, None, gr.update(visible=False)

    def cancel(self, request: gr.Request) -> None:
        """Stops this session's import before its next run."""
        if token := self._imports.get(str(request.session_hash)):
            token.cancel()


def runs_line(count: int) -> str:
    """A number of runs in words."""
    return "one run" if count == 1 else f"{count} runs"


def room_html(usage: Usage) -> str:
    """A bar and a line on the room that a person uses and has."""
    parts = [
        f"{name} {_megabytes(size)}"
        for name, size in (
            ("runs", usage.runs), ("favourites", usage.favourites), ("studies", usage.studies),
            ("uploads and downloads", usage.temporary),
        )
        if size
    ]  # fmt: skip
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
        f'value="{usage.used:.0f}" aria-label="{said("Room used")}"></meter><span>{text(said(line))}</span></p>'
    )


def _megabytes(size: float) -> str:
    """Megabytes to read: with one decimal below ten."""
    megabytes = size / 2**20
    return f"{megabytes:,.1f}" if 0 < megabytes < 9.95 else f"{megabytes:,.0f}"
