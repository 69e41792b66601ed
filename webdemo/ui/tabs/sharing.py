"""Public pages on the History tab: make one of a run, copy its address or its frame, end it."""

from __future__ import annotations

from typing import Any

import gradio as gr

from webdemo.ui.components.fields import address_field
from webdemo.ui.components.notebook import Action
from webdemo.ui.context import PageContext
from webdemo.ui.public_html import frame_code
from webdemo.ui.text.panels import status
from webdemo.ui.text.texts import say
from webdemo.ui.text.words import day
from webdemo.ui.visitor import visitor

from .results import QUIET, Parts, said


class SharingPanel:
    """The part of the History tab where public pages are made and ended.

    Args:
        page: what the tabs share; its history keeps the pages.
        line: where the tab says what was done.
    """

    def __init__(self, page: PageContext, line: gr.HTML) -> None:
        self.history, self.line = page.history, line

    # ---- layout ----------------------------------------------------------------------------------

    def build(self) -> None:
        """Lays out the panel, folded until a run is published."""
        with gr.Accordion(say("sharing.fold"), open=False, elem_id="sharing") as self.fold:
            gr.HTML(f'<p class="pd-method">{say("sharing.intro")}</p>')
            with gr.Column(visible=False, min_width=0) as self.reading:
                self.which = gr.Dropdown([], label=say("sharing.which"), elem_id="sharing-which")
                self.link = address_field("sharing.address", "sharing-link")
                self.frame = address_field("sharing.frame", "sharing-frame")
                self.end = gr.Button(say("sharing.end"), size="sm", min_width=0, elem_id="sharing-end")

    def wire(self, tab: gr.Tab, publish: Any) -> None:
        """Wires the panel's events.

        Args:
            tab: in which it is; the pages are read when that is chosen.
            publish: the event with which the notebook says which run is published.
        """
        quick: dict[str, Any] = {"concurrency_limit": 4, "concurrency_id": "sharing", **QUIET}
        shown = [self.line, self.reading, self.which, self.link, self.frame]
        published = publish(self.publish, outputs=[self.fold, *shown], trigger_mode="once", **quick)
        published.then(self.show, self.which, shown, **quick)  # what a fold holds takes no value before it is open
        gr.on([tab.select, self.which.input], self.show, self.which, shown, **quick)
        self.end.click(self.revoke, self.which, shown, **quick)

    # ---- events ----------------------------------------------------------------------------------

    @said
    def publish(self, event: gr.EventData) -> Parts:
        """Makes a page of the run that is chosen in the notebook, and shows its address."""
        page = self.history.publish(Action.read(event._data).one, visitor().owner)
        line = f"Published. Anybody with the address can watch until {day(page.until)}."
        return {self.fold: gr.update(open=True), self.line: status(line, tone="done")} | self.show(page.key)

    @said
    def show(self, key: str | None) -> Parts:
        """A page's address and frame; those of the newest where none is named."""
        who = visitor()
        mine = {page.key: page for page in self.history.pages(who.owner)}
        if not mine:
            return {self.reading: gr.update(visible=False), self.which: gr.update(choices=[], value=None)}
        link = mine.get(key or "") or next(iter(mine.values()))
        return {
            self.reading: gr.update(visible=True),
            self.which: gr.update(
                choices=[(f"{page.title[:60]} (until {day(page.until)})", page.key) for page in mine.values()],
                value=link.key,
            ),
            self.link: f"{who.base}share/{link.key}",
            self.frame: frame_code(f"{who.base}embed/{link.key}", link.title),
        }

    @said
    def revoke(self, key: str | None) -> Parts:
        """Ends a page."""
        self.history.end_page(key or "", visitor().owner)
        line = status("The page has ended: its address shows nothing any more.", tone="done")
        return {self.line: line} | self.show(None)
