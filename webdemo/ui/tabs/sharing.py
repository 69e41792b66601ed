"""Public pages on the History tab: make one of chosen runs, copy its address or its frame, end it, or save pages."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

import gradio as gr

from motion import InputError
from webdemo.ui.components.notebook import Action
from webdemo.ui.context import PageContext
from webdemo.ui.history import HistoryLike
from webdemo.ui.public_html import frame_code
from webdemo.ui.sharing import PublicPage, SharingLike
from webdemo.ui.site import FILES_BYTES, write_site
from webdemo.ui.text.panels import status
from webdemo.ui.text.said import said
from webdemo.ui.text.texts import say
from webdemo.ui.text.words import error_line
from webdemo.ui.visitor import visitor

from .job import QUIET, Updates
from .workspace import runs_line

_INTRO = say("sharing.intro")
_SITE_TITLE = "Motions of two people"


class SharingPanel:
    """The part of the History tab where public pages are made and ended.

    Args:
        page: what the tabs share; its history and its public pages are there.
    """

    def __init__(self, page: PageContext) -> None:
        if page.history is None or page.sharing is None:
            raise ValueError("The page keeps no public pages.")
        self.page = page
        self.history: HistoryLike = page.history
        self.sharing: SharingLike = page.sharing

    # ---- layout ----------------------------------------------------------------------------------

    def build(self) -> None:
        """Lays out the panel, folded until runs are chosen for it."""
        days = self.sharing.days
        with gr.Accordion(say("sharing.fold"), open=False, elem_id="sharing") as self.fold:
            gr.HTML(f'<p class="pd-method">{_INTRO}</p>')
            self.line = gr.HTML(status(), elem_id="sharing-status", elem_classes="pd-line")
            with gr.Column(visible=False, min_width=0) as self.making:
                with gr.Row(elem_classes="pd-pair"):
                    self.title = gr.Textbox(
                        label=say("sharing.title"), info=say("sharing.title_info"),
                        elem_id="sharing-title", min_width=0,
                    )  # fmt: skip
                    self.days = gr.Number(
                        days, label=say("sharing.days"), info=say("sharing.days_info", days=f"{days:g}"), minimum=0.01,
                        maximum=days or None, visible=bool(days), elem_id="sharing-days", min_width=0,
                    )  # fmt: skip
                with gr.Row():
                    self.make = gr.Button(
                        say("sharing.make"), variant="primary", size="sm", min_width=0, visible=bool(days),
                        elem_id="sharing-make",
                    )  # fmt: skip
                    self.folder = gr.Button(
                        say("sharing.folder"), size="sm", min_width=0, elem_id="sharing-folder"
                    )
                    self.saved = gr.DownloadButton(
                        say("files.pages"), size="sm", min_width=0, visible=False, elem_id="sharing-saved"
                    )
            with gr.Column(visible=False, min_width=0) as self.reading:
                self.which = gr.Dropdown([], label=say("sharing.which"), elem_id="sharing-which")
                self.link = gr.Textbox(
                    label=say("sharing.address"), interactive=False, buttons=["copy"], elem_id="sharing-link"
                )
                self.frame = gr.Textbox(
                    label=say("sharing.frame"), interactive=False, buttons=["copy"],
                    elem_id="sharing-frame",
                )  # fmt: skip
                self.end = gr.Button(say("sharing.end"), size="sm", min_width=0, elem_id="sharing-end")
        self.chosen = gr.State([])

    def wire(self, tab: gr.Tab, choose: Any) -> None:
        """Wires the panel's events.

        Args:
            tab: in which it is; the pages are read when that is chosen.
            choose: the event with which the notebook says which runs are chosen.
        """
        quick: dict[str, Any] = {"concurrency_limit": 4, "concurrency_id": "sharing", **QUIET}
        shown = [self.reading, self.which, self.link, self.frame]
        choose(
            self.choose, outputs=[self.fold, self.line, self.making, self.chosen, self.title, self.saved], **quick
        )  # fmt: skip
        self.make.click(
            self.publish, inputs=[self.chosen, self.title, self.days], outputs=[self.line, self.making, *shown],
            trigger_mode="once", **quick,
        )  # fmt: skip
        self.folder.click(
            self.save, inputs=[self.chosen, self.title], outputs=[self.line, self.saved],
            trigger_mode="once", **quick,
        )  # fmt: skip
        tab.select(self.show, inputs=self.which, outputs=shown, **quick)
        self.which.input(self.show, inputs=self.which, outputs=shown, **quick)
        self.end.click(self.revoke, inputs=self.which, outputs=[self.line, *shown], **quick)

    # ---- events ----------------------------------------------------------------------------------

    def choose(self, event: gr.EventData) -> Updates:
        """Asks for the title of a page of the runs that are chosen in the notebook."""
        try:
            ids = Action(event._data).ids
            if not ids:
                raise InputError("Choose runs in the list first.")
            title = self.history.entry(ids[0], visitor().owner).title if len(ids) == 1 else ""
        except Exception as error:
            return gr.update(open=True), status(error_line(error), tone="error"), *((gr.skip(),) * 4)
        line = f"{runs_line(len(ids)).capitalize()} chosen: give the page a title."
        hidden = gr.update(visible=False)
        return gr.update(open=True), status(line), gr.update(visible=True), ids, title, hidden

    def publish(self, ids: list[str], title: str | None, days: float | None) -> Updates:
        """Makes a page and shows its address."""
        try:
            page = self.sharing.publish(visitor().owner, ids, title=title or "", days=days)
        except Exception as error:
            return status(error_line(error), tone="error"), *((gr.skip(),) * 5)
        line = f"Published. Anybody with the address can watch until {_day(page.until)}."
        return status(line, tone="done"), gr.update(visible=False), *self.show(page.key)

    def save(self, ids: list[str], title: str | None) -> Updates:
        """Writes a folder of pages of the chosen runs, which play without a network."""
        try:
            owner = visitor().owner
            results = self.sharing.results(owner, ids)
            size = FILES_BYTES + self.history.weight(owner, ids)
            file: Path = self.page.shelf.folder(size) / "pas-de-deux-pages.zip"
            write_site(results, file, title=title or _SITE_TITLE)
        except Exception as error:
            return status(error_line(error), tone="error"), gr.update(visible=False)
        megabytes = file.stat().st_size / 2**20
        line = f"Pages of {runs_line(len(results))} in one file of {megabytes:.1f} MB: unpack it and open index.html."
        return status(line, tone="done"), gr.update(value=str(file), visible=True)

    def show(self, key: str | None) -> Updates:
        """A page's address and frame; those of the newest where none is named."""
        who = visitor()
        try:
            mine = {page.key: page for page in self.sharing.pages(who.owner)}
        except InputError as error:
            return gr.update(visible=True), gr.skip(), said(error_line(error)), ""
        if not mine:
            return gr.update(visible=False), gr.update(choices=[], value=None), "", ""
        found = mine.get(key or "") or next(iter(mine.values()))
        choices = [(_about(page), page.key) for page in mine.values()]
        return (
            gr.update(visible=True),
            gr.update(choices=choices, value=found.key),
            f"{who.base}share/{found.key}",
            frame_code(f"{who.base}embed/{found.key}", found.title),
        )

    def revoke(self, key: str | None) -> Updates:
        """Ends a page."""
        try:
            self.sharing.revoke(key or "", visitor().owner)
        except Exception as error:
            return status(error_line(error), tone="error"), *((gr.skip(),) * 4)
        return status("The page has ended: its address shows nothing any more.", tone="done"), *self.show(
            None
        )


def _about(page: PublicPage) -> str:
    return f"{page.title[:60]} ({said(f'{runs_line(page.runs)}, until {_day(page.until)}')})"


def _day(moment: float) -> str:
    return time.strftime("%d %b %Y", time.localtime(moment)).lstrip("0")
