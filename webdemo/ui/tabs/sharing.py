"""Public pages on the History tab: make one of a run, copy its address or its frame, end it."""

from __future__ import annotations

import time
from typing import Any

import gradio as gr

from motion import InputError
from webdemo.ui.components.notebook import Action
from webdemo.ui.history import PublicPage, SharingLike
from webdemo.ui.public_html import frame_code
from webdemo.ui.text.panels import status
from webdemo.ui.text.texts import say
from webdemo.ui.text.words import error_line
from webdemo.ui.visitor import visitor

from .results import QUIET, Updates


class SharingPanel:
    """The part of the History tab where public pages are made and ended.

    Args:
        sharing: keeps the pages.
    """

    def __init__(self, sharing: SharingLike) -> None:
        self.sharing = sharing

    # ---- layout ----------------------------------------------------------------------------------

    def build(self) -> None:
        """Lays out the panel, folded until a run is published."""
        with gr.Accordion(say("sharing.fold"), open=False, elem_id="sharing") as self.fold:
            gr.HTML(f'<p class="pd-method">{say("sharing.intro")}</p>')
            self.line = gr.HTML(status(), elem_id="sharing-status", elem_classes="pd-line")
            with gr.Column(visible=False, min_width=0) as self.reading:
                self.which = gr.Dropdown([], label=say("sharing.which"), elem_id="sharing-which")
                self.link = gr.Textbox(
                    label=say("sharing.address"), interactive=False, buttons=["copy"], elem_id="sharing-link"
                )
                self.frame = gr.Textbox(
                    label=say("sharing.frame"), interactive=False, buttons=["copy"], elem_id="sharing-frame"
                )
                self.end = gr.Button(say("sharing.end"), size="sm", min_width=0, elem_id="sharing-end")

    def wire(self, tab: gr.Tab, publish: Any) -> None:
        """Wires the panel's events.

        Args:
            tab: in which it is; the pages are read when that is chosen.
            publish: the event with which the notebook says which run is published.
        """
        quick: dict[str, Any] = {"concurrency_limit": 4, "concurrency_id": "sharing", **QUIET}
        shown = [self.reading, self.which, self.link, self.frame]
        published = publish(self.publish, outputs=[self.fold, self.line, *shown], trigger_mode="once", **quick)
        # What a fold holds takes no value before it is open.
        published.then(self.show, inputs=self.which, outputs=shown, **quick)
        tab.select(self.show, inputs=self.which, outputs=shown, **quick)
        self.which.input(self.show, inputs=self.which, outputs=shown, **quick)
        self.end.click(self.revoke, inputs=self.which, outputs=[self.line, *shown], **quick)

    # ---- events ----------------------------------------------------------------------------------

    def publish(self, event: gr.EventData) -> Updates:
        """Makes a page of the run that is chosen in the notebook, and shows its address."""
        try:
            page = self.sharing.publish(visitor().owner, Action.read(event._data).one)
        except Exception as error:
            return gr.update(open=True), status(error_line(error), tone="error"), *((gr.skip(),) * 4)
        line = f"Published. Anybody with the address can watch until {_day(page.until)}."
        return gr.update(open=True), status(line, tone="done"), *self.show(page.key)

    def show(self, key: str | None) -> Updates:
        """A page's address and frame; those of the newest where none is named."""
        who = visitor()
        try:
            mine = {page.key: page for page in self.sharing.pages(who.owner)}
        except InputError as error:
            return gr.update(visible=True), gr.skip(), error_line(error), ""
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
        return status("The page has ended: its address shows nothing any more.", tone="done"), *self.show(None)


def _about(page: PublicPage) -> str:
    return f"{page.title[:60]} (until {_day(page.until)})"


def _day(moment: float) -> str:
    return time.strftime("%d %b %Y", time.localtime(moment)).lstrip("0")
