"""Runs of the past: open one with all its controls, keep it, link to it, run it again, remove it."""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import gradio as gr

from motion import InputError
from webdemo.inference.methods import label_of, methods, variants
from webdemo.inference.requests import Cancelled, Progress, Result
from webdemo.ui.again import actor_source, request_of, request_of_unfinished, verdict
from webdemo.ui.components.exports import KINDS, Record
from webdemo.ui.components.settings import taken
from webdemo.ui.context import PageContext
from webdemo.ui.history import Entry, HistoryLike, Opened
from webdemo.ui.text.panels import status
from webdemo.ui.text.words import cancelled_line, error_line, progress_line, shown_errors, text
from webdemo.ui.visitor import Visitor, visitor

from .job import QUIET, JobTab, Updates
from .react import ReactTab

LABEL = "History"
_EMPTY = (
    "Nothing yet. What you make in the other tabs is kept here. Open it again with all its settings, "
    "share it by a link, or check that it comes out the same."
)
_CONTROLS = ("prompt", "seconds", "seed", "samples", "guidance", "steps", "damping", "role", "model", "mode")
"""Fields of a request that a tab may have a control of the same name for."""
_LAST = "last"
_NAMED = f"""() => new URLSearchParams(window.location.search).get('run')
    || (sessionStorage.getItem('pas-de-deux-made') ? '{_LAST}' : '')"""
"""The run that the page's address names, or the last one where this browser tab has made any."""
_KEEP, _UNKEEP = "Keep", "Stop keeping"
_ABLE = ("open", "favour", "link", "revoke", "again", "remove")
"""Buttons that are as the chosen run lets them be."""
_MARKS = {"running": "⏳", "failed": "✕", "cancelled": "✕", "interrupted": "✕"}


class HistoryTab:
    """The list of a person's runs.

    Args:
        page: what the tabs share; its history is there.
        jobs: the tabs that a run can be opened in, by the kind of its request.
        tabs: shows one of them.
    """

    def __init__(self, page: PageContext, jobs: Mapping[str, JobTab], tabs: gr.Tabs) -> None:
        if page.history is None:
            raise ValueError("The page has no history.")
        self.page, self.jobs, self.tabs = page, jobs, tabs
        self.history: HistoryLike = page.history

    # ---- layout ----------------------------------------------------------------------------------

    def build(self, demo: gr.Blocks, tab: gr.Tab, record: gr.State) -> None:
        """Lays out the tab and wires its events.

        Args:
            demo: the page; where its address names a run, that is opened.
            tab: this tab; its list is read anew whenever it is chosen.
            record: keeps the session's last result.
        """
        with gr.Column(elem_classes="pd-panel pd-history", min_width=0):
            self.who = gr.HTML(elem_id="history-who")
            self.list = gr.Radio([], show_label=False, container=False, elem_id="history-list",
                                 elem_classes="pd-runs")  # fmt: skip
            self.empty = gr.HTML(status(_EMPTY), elem_id="history-empty", visible=False)
            with gr.Row(elem_classes="pd-go pd-history-buttons", visible=False) as self.actions:
                self.buttons = {
                    name: gr.Button(label, elem_id=f"history-{name}", size="sm", min_width=0,
                                    interactive=name != "stop",
                                    variant="primary" if name == "open" else "secondary")
                    for name, label in (
                        ("open", "Open"), ("favour", _KEEP), ("link", "Make a link"),
                        ("revoke", "End its links"), ("again", "Run again"), ("stop", "Cancel"),
                        ("remove", "Remove"),
                    )
                }  # fmt: skip
            self.line = gr.HTML(status(), elem_id="history-status", elem_classes="pd-line")
            self.address = gr.Textbox(label="Link", interactive=False, visible=False, buttons=["copy"],
                                      elem_id="history-address")  # fmt: skip
        self._wire(demo, tab, record)

    def _wire(self, demo: gr.Blocks, tab: gr.Tab, record: gr.State) -> None:
        self.record = record
        able = [self.buttons[name] for name in _ABLE]
        seen = [self.list, self.empty, self.who, self.actions, *able]
        told = [self.line, self.address]
        quick: dict[str, Any] = {"concurrency_limit": 8, "concurrency_id": "history", **QUIET}
        tab.select(self.refresh, inputs=self.list, outputs=seen, **quick)
        self.list.input(self.choose, inputs=self.list, outputs=[*told, *able], **quick)
        for name, act in (
            ("favour", self.favour), ("link", self.link), ("revoke", self.revoke), ("remove", self.remove)
        ):  # fmt: skip
            done = self.buttons[name].click(act, inputs=self.list, outputs=told, **quick)
            done.then(self.refresh, inputs=self.list, outputs=seen, **quick)
        again = self.buttons["again"].click(
            self.again, inputs=self.list, outputs=[self.line, self.buttons["again"], self.buttons["stop"]],
            concurrency_limit=None, trigger_mode="once", **QUIET,
        )  # fmt: skip
        again.then(self.refresh, inputs=self.list, outputs=seen, **quick)
        self.buttons["stop"].click(self.cancel, queue=False, **QUIET)
        parts = [self.tabs, record, self.line, *(c for job in self.jobs.values() for c in _parts(job))]
        self.opened = list({part._id: part for part in parts}.values())
        named = gr.Textbox(visible=False)
        chosen = self.buttons["open"].click(self.open, inputs=self.list, outputs=self.opened, **quick)
        address = demo.load(self.open_address, inputs=named, outputs=self.opened, js=_NAMED, **quick)
        for chain in (chosen, address):
            for kind, job in self.jobs.items():
                knobs = job.knobs
                chain = chain.then(
                    None,
                    inputs=[job.asked, *knobs.values()],
                    outputs=job.asked,
                    js=taken(list(knobs)),
                    **QUIET,
                )
                chain = chain.then(
                    self._exporter(kind, job), inputs=record, outputs=[job.line, *job.downloads], **quick
                )

    def _exporter(self, kind: str, job: JobTab) -> Any:
        def export(record: Record | None) -> Updates:
            """Writes the files of an opened run for the tab that shows it."""
            if record is None or record.result.manifest.get("request", {}).get("kind", "generate") != kind:
                return (gr.skip(),) * (1 + len(KINDS))
            return job.export(record)

        return export

    # ---- events ----------------------------------------------------------------------------------

    def refresh(self, chosen: str | None) -> Updates:
        """The list as it is now with the same run chosen, where it is still there, and its buttons."""
        who = visitor()
        with shown_errors():
            entries = self.history.entries(who.owner)
        choices = [(_label(entry), entry.id) for entry in entries]
        kept = next((entry for entry in entries if entry.id == chosen), entries[0] if entries else None)
        return (
            gr.update(choices=choices, value=kept.id if kept else None),
            gr.update(visible=not entries),
            _signed_in(who),
            gr.update(visible=bool(entries)),
            *_able(kept),
        )

    def choose(self, run: str | None) -> Updates:
        """Shows the error of a chosen run, and enables the actions that apply to it."""
        with shown_errors():
            entry = self._entry(run)
        line = status(entry.message, tone="warning") if entry and entry.message else status()
        return line, gr.update(visible=False), *_able(entry)

    def favour(self, run: str | None) -> Updates:
        """Keeps a run from being removed for its age, or lets it go."""

        def act(run: str, owner: str) -> str:
            entry = self._entry(run)
            wanted = entry is None or not entry.favourite
            self.history.favour(run, owner, favourite=wanted)
            return "Kept: it will not be removed because of its age." if wanted else "No longer kept."

        return self._act(run, act)

    def revoke(self, run: str | None) -> Updates:
        """Ends a run's links."""

        def act(run: str, owner: str) -> str:
            ended = self.history.revoke(run, owner)
            return "Its link no longer works." if ended == 1 else f"{ended} links to it no longer work."

        return self._act(run, act)

    def remove(self, run: str | None) -> Updates:
        """Deletes a run."""

        def act(run: str, owner: str) -> str:
            self.history.remove(run, owner)
            return "Removed, with its files and links."

        return self._act(run, act)

    def link(self, run: str | None) -> Updates:
        """Makes a link to a run and shows it."""
        made: list[str] = []

        def act(run: str, owner: str) -> str:
            key, until = self.history.link(run, owner)
            made.append(f"{visitor().base}?run={key}")
            last = time.strftime("%d %B %Y", time.localtime(until))
            signed = " and can sign in here" if visitor().account else ""
            return f"Anyone who has this link{signed} can see the motion until {last}, or until you end its links."

        line, _ = self._act(run, act)
        return line, gr.update(value=made[0] if made else "", visible=bool(made))

    def _act(self, run: str | None, act: Any) -> Updates:
        """Does something with a run and says so; hides the link."""
        try:
            if not run:
                raise InputError("Choose a run first.")
            line = status(act(run, visitor().owner), tone="done")
        except Exception as error:
            line = status(error_line(error), tone="error")
        return line, gr.update(visible=False)

    def _entry(self, run: str | None) -> Entry | None:
        """One of the visitor's own runs."""
        return next((entry for entry in self.history.entries(visitor().owner) if entry.id == run), None)

    def again(self, run: str | None, request: gr.Request) -> Iterator[Updates]:
        """Runs a kept request once more and says whether it came out the same."""
        last: Progress | None = None
        line, busy = "", (gr.update(interactive=False), gr.update(interactive=True))
        try:
            if not run:
                raise InputError("Choose a run first.")
            entry = self._entry(run)
            if entry is not None and entry.state != "done":
                opened, wanted = None, request_of_unfinished(entry)
            else:
                opened = self.history.open(run, visitor().owner)
                wanted = request_of(opened)
            for event in self.page.runs.run(_session(request), wanted, alone=True):
                if isinstance(event, Result):
                    said = (
                        verdict(opened.result, event) if opened else "Run again: its result is in the list."
                    )
                    line = status(said, tone="done")
                    break
                last = event
                yield status(progress_line(event), tone="busy"), *busy
        except Cancelled:
            line = status(cancelled_line(last), tone="warning")
        except Exception as error:
            line = status(error_line(error), tone="error")
        yield line, gr.update(interactive=True), gr.update(interactive=False)

    def cancel(self, request: gr.Request) -> None:
        """Stops what runs again."""
        self.page.runs.cancel(_session(request))

    def open(self, run: str | None) -> Updates:
        """Shows a run in its tab, with all controls as they were."""
        try:
            if not run:
                raise InputError("Choose a run first.")
            return self._shown(self.history.open(run, visitor().owner))
        except Exception as error:
            return self._not_shown(error_line(error))

    def open_address(self, run: str | None) -> Updates:
        """Opens the run that the page's address names, or the last one, so that a reload keeps it."""
        if run == _LAST:
            mine = self.history.entries(visitor().owner)
            run = next((e.id for e in mine if e.state == "done" and e.kind in self.jobs), None)
        if not run:
            return (gr.skip(),) * len(self.opened)
        try:
            return self._shown(self.history.open(run, visitor().owner))
        except Exception as error:
            return self._not_shown(error_line(error), first=True)

    # ---- what an opened run shows ----------------------------------------------------------------

    def _not_shown(self, sentence: str, *, first: bool = False) -> Updates:
        """The sentence under the list, or under the first tab's button where the page began with it."""
        shown = next(iter(self.jobs.values())).line if first else self.line
        changes: dict[int, Any] = {shown._id: status(sentence, tone="error")}
        return tuple(changes.get(part._id, gr.skip()) for part in self.opened)

    def _shown(self, opened: Opened) -> Updates:
        entry = opened.entry
        job = self.jobs.get(entry.kind)
        if job is None:
            raise InputError(f"There is no tab for a run of the kind {entry.kind!r} here.")
        changes: dict[int, Any] = {
            self.tabs._id: gr.update(selected=entry.kind),
            self.line._id: status(),
            **{
                getattr(job, name)._id: gr.update(value=entry.request[name])
                for name in _CONTROLS
                if name in entry.request and hasattr(job, name)
            },
            **{part._id: update for part, update in job.opened(opened).items()},
        }
        if "actor" in entry.request and isinstance(job, ReactTab):
            source = actor_source(opened)
            last = round(source.seconds, 1)
            changes[job.source._id] = source
            changes[job.given._id] = source.key
            changes[job.trim._id] = gr.update(visible=True)
            changes[job.begin._id] = gr.update(maximum=last, value=0)
            changes[job.end._id] = gr.update(maximum=last, value=last)
        return tuple(changes.get(part._id, gr.skip()) for part in self.opened)


def _parts(job: JobTab) -> Sequence[gr.components.Component]:
    """Everything of a tab that an opened run may set."""
    names = (*_CONTROLS, "source", "trim", "begin", "end", "marker", *job.restored)
    return [*job.outputs.values(), *(getattr(job, name) for name in names if hasattr(job, name))]


def _signed_in(who: Visitor) -> str:
    """The name of the person who is signed in, with a button to sign out; empty without accounts."""
    if not who.account:
        return ""
    return (
        f'<form class="pd-status pd-account" method="post" action="{text(who.base)}logout">'
        f"Signed in as {text(who.account)} ·\u2002<button>Sign out</button></form>"
    )


def _session(request: gr.Request) -> str:
    """The session of this panel's own runs, which do not cancel those of the other tabs."""
    return f"again-{request.session_hash}"


def _label(entry: Entry) -> str:
    """One line for a run: when, what, by which method, how long, its seed, and marks."""
    when = time.strftime("%d %b %H:%M", time.localtime(entry.created))
    asked = entry.request
    facts = [method] if (method := _method(asked)) else []
    facts += [f"{asked['seconds']:g} s"] if "seconds" in asked else []
    facts += [f"seed {asked['seed']}"] if "seed" in asked else []
    marks = ("★ " if entry.favourite else "") + (f"{_MARKS[entry.state]} " if entry.state in _MARKS else "")
    title = entry.title if len(entry.title) <= 80 else f"{entry.title[:79]}…"
    told = f" · {entry.state}" if entry.state != "done" else ""
    links = f" · {entry.links} link{'s' if entry.links > 1 else ''}" if entry.links else ""
    return f"{marks}{title} · {' · '.join([*facts, when])}{told}{links}"


def _method(asked: Mapping[str, Any]) -> str:
    """The label of the method of a run; "" for the one that sentences go to by default."""
    model, mode = str(asked.get("model", "")), asked.get("mode")
    if asked.get("kind") == "generate" and model in ("", methods("generate")[0].name):
        return ""
    if asked.get("kind") == "react":
        known = (v.label for v in variants("react").values() if (v.method.name, v.mode) == (model, mode))
        return next(known, label_of(model))
    return label_of(model)


def _able(entry: Entry | None) -> Updates:
    """Enables the buttons of :data:`_ABLE` that apply to a run."""
    done = entry is not None and entry.state == "done"
    lets = {
        "open": done,
        "link": done,
        "revoke": entry is not None and entry.links > 0,
        "again": entry is not None and entry.state != "running",
        "favour": entry is not None,
        "remove": entry is not None and entry.state != "running" and not entry.favourite,
    }
    named: dict[str, Any] = {"value": _UNKEEP if entry is not None and entry.favourite else _KEEP}
    return tuple(gr.update(interactive=lets[each], **(named if each == "favour" else {})) for each in _ABLE)
