"""Runs of the past as a notebook: find one, open it with all its controls, name it, link to it, take it along."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import gradio as gr

from motion import InputError
from webdemo.inference.run import Result
from webdemo.ui.components.fields import address_field
from webdemo.ui.components.notebook import UNKNOWN, Action, NotebookView, shown
from webdemo.ui.components.sweep import MOST, loose
from webdemo.ui.context import PageContext
from webdemo.ui.history import Found, Opened, Search
from webdemo.ui.text.panels import status
from webdemo.ui.text.texts import say
from webdemo.ui.text.words import counted, error_line, link_line, text
from webdemo.ui.visitor import Visitor, visitor

from .history_files import FilesPanel, room_html
from .job import JobTab
from .results import QUIET, Parts, Updates, said
from .sharing import SharingPanel
from .study import StudyPanel

LABEL = "History"
EMPTY, NOTHING_FOUND = "notebook.empty", "notebook.nothing_found"
"""Keys of what the notebook says where there is no run, or none that fits."""
_EVERYTHING = Search()
_LAST = "last"
_NAMED = f"""() => new URLSearchParams(window.location.search).get('run')
    || (sessionStorage.getItem('pas-de-deux-made') ? '{_LAST}' : '')"""
"""The run that the page's address names, or the last one where this browser tab has made any."""
_HIDDEN = '() => Array(2).fill({ __type__: "update", visible: false })'
"""JavaScript that hides the link and the file that an earlier action left."""


class HistoryTab:
    """The notebook of a person's runs.

    Args:
        page: what the tabs share; its history is there.
        jobs: the tabs that a run can be opened in, by the kind of its request.
        tabs: shows one of them.
    """

    def __init__(self, page: PageContext, jobs: Mapping[str, JobTab], tabs: gr.Tabs) -> None:
        self.page, self.jobs, self.tabs = page, jobs, tabs
        self.history = page.history
        self.files = FilesPanel(page, self.refresh)

    # ---- layout ----------------------------------------------------------------------------------

    def build(self, demo: gr.Blocks, tab: gr.Tab, record: gr.State) -> None:
        """Lays out the tab and wires its events.

        Args:
            demo: the page; where its address names a run, that is opened.
            tab: this tab; its list is read anew whenever it is chosen.
            record: keeps the session's last result.
        """
        with gr.Column(elem_classes="pd-panel pd-history", min_width=0):
            self.line = gr.HTML(status(), elem_id="history-status", elem_classes="pd-line")
            self.address = address_field("sharing.address", "history-address", visible=False)
            self.saved = gr.DownloadButton(say("history.save"), visible=False, elem_id="history-saved", size="sm")
            self.view = NotebookView(elem_id="history-notebook")
            self.who = gr.HTML(elem_id="history-who")
            self.study = StudyPanel(self.page, self.line)
            self.study.build()
            self.sharing = SharingPanel(self.page, self.line)
            self.sharing.build()
            self.files.build()
        self.removed = gr.State([])
        self._wire(demo, tab, record)

    def _wire(self, demo: gr.Blocks, tab: gr.Tab, record: gr.State) -> None:
        quick: dict[str, Any] = {"concurrency_limit": 8, "concurrency_id": "history", **QUIET}
        shown = [self.view, self.who, self.line, self.address, self.saved, self.removed]
        tab.select(self.refresh, inputs=self.removed, outputs=shown[:2], **quick)
        self.view.select(self.act, inputs=self.removed, outputs=shown, **quick)
        others = [self.files.everything.click, self.files.files.upload]
        others += [self.view.edit, self.view.apply, self.view.submit, self.view.like]
        gr.on(others, None, outputs=[self.address, self.saved], js=_HIDDEN, **QUIET)
        self.files.wire(shown[:2], self.line, self.saved, self.removed)
        self.study.wire(tab, self.view.edit)
        self.sharing.wire(tab, self.view.apply)
        parts = [self.tabs, record, self.line, *(c for job in self.jobs.values() for c in job.parts())]
        self.opened = list({part._id: part for part in parts}.values())
        named = gr.Textbox(visible=False)
        self.view.submit(self.open, outputs=self.opened, **quick)
        self.view.like(self.compare, outputs=self.opened, **quick)
        demo.load(self.open_address, inputs=named, outputs=self.opened, js=_NAMED, **quick)

    # ---- events ----------------------------------------------------------------------------------

    def refresh(self, removed: list[str], search: Search = _EVERYTHING) -> Updates:
        """The newest runs that a search finds, whose they are, and how much room all of these use."""
        room, listed = "", Found((), 0)
        empty = EMPTY if search == Search(limit=search.limit) else NOTHING_FOUND
        try:
            listed = self.history.search(visitor().owner, search)
            room = room_html(self.history.usage(visitor()))
        except Exception as error:
            empty = error_line(error)
        view = shown(listed, empty=empty, removed=len(removed), search=search)
        return gr.update(value=view), _signed_in(visitor()) + room

    def act(self, removed: list[str], event: gr.EventData) -> Updates:
        """Does what was pressed in the notebook, and shows the list as it is then."""
        line, address, saved = gr.skip(), gr.update(visible=False), gr.update(visible=False)
        search = _EVERYTHING
        try:
            action = Action.read(event._data)
            search, owner = action.wanted, visitor().owner
            if action.act == "link":
                key, until = self.history.link(action.one, owner)
                address = gr.update(value=f"{visitor().base}?run={key}", visible=True)
                line = status(link_line(until), tone="done")
            elif action.act == "export":
                line, saved = self.files.export(action.ids)
            elif action.act == "remove":
                count, removed = self.history.remove(action.ids, owner), action.ids
                line = status(f"Removed {counted(count, 'run')}, links included.", tone="done")
            elif action.act == "restore":
                count, removed = self.history.restore(removed, owner), []
                line = status(f"Brought {counted(count, 'run')} back.", tone="done")
            elif action.act == "search":
                address = saved = gr.skip()
            else:
                line = status(self._one(action, owner), tone="done")
        except Exception as error:
            line = status(error_line(error), tone="error")
        return *self.refresh(removed, search), line, address, saved, removed

    def _one(self, action: Action, owner: str) -> str:
        """Does something with one run and says so in a sentence."""
        run = action.one
        if action.act == "favour":
            wanted = not self.history.entry(run, owner).favourite
            self.history.favour(run, owner, favourite=wanted)
            return "Kept: it will not be removed because of its age." if wanted else "No longer kept."
        if action.act == "revoke":
            ended = self.history.revoke(run, owner)
            return "Its link no longer works." if ended == 1 else f"{ended} links to it no longer work."
        if action.act == "describe":
            self.history.describe(run, owner, title=action.title, tags=action.tags, note=action.note)
            return "Saved."
        raise InputError(UNKNOWN)

    @said
    def open(self, event: gr.EventData) -> Parts:
        """Shows a run in its tab, with all controls as they were."""
        return self._shown(self.history.open(Action.read(event._data).one, visitor().owner))

    @said
    def compare(self, event: gr.EventData) -> Parts:
        """Shows the first sample of several runs as a grid, in the tab of the first."""
        action = Action.read(event._data)
        runs = [self.history.open(run, visitor().owner) for run in action.ids[: MOST + 1]]
        job = self.jobs.get(runs[0].entry.kind) if runs else None
        if job is None:
            raise InputError("Choose two to nine runs first.")
        made = compared(runs)
        shown = job.grids.shown(loose([{}] * len(made), list(made)), made, f"{len(made)} runs compared")
        return {
            self.tabs: gr.update(selected=runs[0].entry.kind),
            self.line: status(),
            job.line: status(f"{len(runs)} runs of the history side by side.", tone="done"),
            **{job.outputs[name]: update for name, update in shown.items()},
        }

    def open_address(self, run: str | None) -> Parts | Updates:
        """Opens the run that the page's address names, or the last one, so that a reload keeps it."""
        try:
            if run == _LAST:
                mine = self.history.search(visitor().owner, Search()).entries
                run = next((e.id for e in mine if e.state == "done" and e.kind in self.jobs), None)
            if not run:
                return (gr.skip(),) * len(self.opened)
            return self._shown(self.history.open(run, visitor().owner))
        except Exception as error:
            return {next(iter(self.jobs.values())).line: status(error_line(error), tone="error")}

    # ---- what an opened run shows ----------------------------------------------------------------

    def _shown(self, opened: Opened) -> Parts:
        entry = opened.entry
        job = self.jobs.get(entry.kind)
        if job is None:
            raise InputError(f"There is no tab for a run of the kind {entry.kind!r} here.")
        return {self.tabs: gr.update(selected=entry.kind), self.line: status(), **job.opened(opened)}


def compared(runs: Sequence[Opened]) -> dict[str, Result]:
    """Runs by the names that they have beside each other.

    Raises:
        InputError: if their joints differ, or for fewer than two or more than nine runs.
    """
    if not 2 <= len(runs) <= MOST:
        raise InputError(f"Choose two to {MOST} runs to compare, not {len(runs)}.")
    joints = {run.result.duets[0].skeleton.joint_names for run in runs}
    if len(joints) > 1:
        raise InputError("These runs have different joints, so they cannot be compared: choose others.")
    made: dict[str, Result] = {}
    for run in runs:
        name = run.entry.title[:60]
        seed = run.entry.request.get("seed")
        name = name if seed is None else f"{name}, seed {seed}"
        number = sum(each.split(" #")[0] == name for each in made)
        made[f"{name} #{number + 1}" if number else name] = replace(run.result, run="")
    return made


def _signed_in(who: Visitor) -> str:
    """The name of the person who is signed in, with a button to sign out; empty without accounts."""
    if not who.account:
        return ""
    return (
        f'<form class="pd-status pd-account" method="post" action="{text(who.base)}logout">'
        f"{text(f'Signed in as {who.account}')} ·\u2002<button>Sign out</button></form>"
    )
