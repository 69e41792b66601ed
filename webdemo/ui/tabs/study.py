"""Blind studies on the History tab: make one of two runs, invite people by a link, see what they say."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import gradio as gr

from motion import InputError
from motion.metrics.generation import share
from webdemo.study import StudyEntry, paired
from webdemo.ui.components.fields import address_field
from webdemo.ui.components.notebook import Action
from webdemo.ui.context import PageContext
from webdemo.ui.history import Opened
from webdemo.ui.text.panels import status, table
from webdemo.ui.text.texts import say
from webdemo.ui.text.words import counted, settings, text
from webdemo.ui.visitor import visitor

from .results import QUIET, Parts, said

QUESTION = "Which does what the sentence says?"
_DELETE = f"(study) => confirm({json.dumps(say('study.delete_sure'))}) ? study : ''"


class StudyPanel:
    """The part of the History tab where studies are made and read.

    Args:
        page: what the tabs share; its history and its studies are there.
        line: where the tab says what was done.
    """

    def __init__(self, page: PageContext, line: gr.HTML) -> None:
        self.page, self.line, self.history, self.studies = page, line, page.history, page.studies

    def build(self) -> None:
        """Lays out the panel, folded until runs are chosen for it."""
        small: dict[str, Any] = {"size": "sm", "min_width": 0}
        with gr.Accordion(say("study.fold"), open=False, elem_id="study") as self.fold:
            gr.HTML(f'<p class="pd-method">{say("study.intro")}</p>')
            with gr.Column(visible=False, min_width=0) as self.making:
                self.question = gr.Textbox(QUESTION, label=say("study.question"), elem_id="study-question")
                self.make = gr.Button(say("study.make"), variant="primary", elem_id="study-make", **small)
            with gr.Column(visible=False, min_width=0, elem_classes="pd-study") as self.reading:
                self.which = gr.Dropdown([], label=say("study.which"), elem_id="study-which")
                self.link = address_field("study.link", "study-link")
                self.result = gr.HTML(elem_id="study-result")
                with gr.Row(elem_classes="pd-downloads"):
                    self.refresh = gr.Button(say("study.refresh"), elem_id="study-refresh", **small)
                    self.table = gr.DownloadButton(say("files.votes"), elem_id="study-csv", **small)
                    self.delete = gr.Button(say("study.delete"), elem_id="study-delete", **small)
        self.chosen = gr.State([])

    def wire(self, tab: gr.Tab, choose: Any) -> None:
        """Wires the panel's events.

        Args:
            tab: in which it is; the studies are read when that is chosen.
            choose: the event with which the notebook says which runs are chosen.
        """
        shown = [self.line, self.reading, self.which, self.link, self.result, self.table]
        quick: dict[str, Any] = {"concurrency_limit": 4, "concurrency_id": "studies", **QUIET}
        choose(self.choose, outputs=[self.line, self.fold, self.making, self.chosen], **quick)
        asked = [self.chosen, self.question]
        self.make.click(self.create, asked, [*shown, self.making], trigger_mode="once", **quick)
        gr.on([tab.select, self.which.input, self.refresh.click], self.show, self.which, shown, **quick)
        self.delete.click(self.remove, self.which, shown, js=_DELETE, **quick)

    # ---- events ----------------------------------------------------------------------------------

    @said
    def choose(self, event: gr.EventData) -> Parts:
        """Says what the two runs that are chosen in the notebook are called in a study."""
        ids = Action.read(event._data).ids
        said = status("“{}” against “{}”".format(*names(self._runs(ids))))
        return {
            self.line: said,
            self.fold: gr.update(open=True),
            self.making: gr.update(visible=True),
            self.chosen: ids,
        }

    def _runs(self, ids: Sequence[str]) -> list[Opened]:
        if len(ids) != 2:
            raise InputError(f"A study compares two runs, not {len(ids)}: choose two in the list.")
        owner = visitor().owner
        return [self.history.open(run, owner) for run in ids]

    @said
    def create(self, ids: list[str], question: str) -> Parts:
        """Makes a study of the motions of both runs and of the cells of their grids, and shows its link."""
        who, runs = visitor(), self._runs(ids)
        pairs = paired(*map(_motions, runs))
        study = self.studies.create(who.owner, question or "", names(runs), pairs, address=who.address)
        line = f"The study has {counted(study.pairs, 'pair')}. Send the link to the people who are to vote."
        return {self.line: status(line, tone="done"), self.making: gr.update(visible=False)} | self.show(study.id)

    @said
    def show(self, study: str | None) -> Parts:
        """A study's link and result; the newest where none is named."""
        who = visitor()
        mine = {each.id: each for each in self.studies.mine(who.owner)}
        if not mine:
            return {self.reading: gr.update(visible=False), self.which: gr.update(choices=[], value=None)}
        chosen = mine.get(study or "") or next(iter(mine.values()))
        file = None
        if chosen.voters:
            file = str(self.page.shelf.folder() / f"votes-{chosen.id[:8]}.csv")
            self.studies.export(chosen.id, who.owner, Path(file))
        choices = [("“{}” against “{}”: {}".format(*each.runs, each.question), each.id) for each in mine.values()]
        return {
            self.reading: gr.update(visible=True),
            self.which: gr.update(choices=choices, value=chosen.id),
            self.link: f"{who.base}study/{chosen.key}",
            self.result: result_html(chosen),
            self.table: gr.update(value=file, interactive=bool(file)),
        }

    @said
    def remove(self, study: str | None) -> Parts:
        """Deletes a study; nothing where that was not confirmed."""
        if not study:
            return {self.line: status()}
        self.studies.delete(study, visitor().owner)
        return {self.line: status("Deleted the study and its votes.", tone="done")} | self.show(None)


def _motions(run: Opened) -> list[tuple[str, Any]]:
    """Sentences and motions of a run and of the cells of its grid."""
    cells = (run, *run.beside)
    return [(str(each.entry.request.get("prompt") or ""), duet) for each in cells for duet in each.result.duets]


def names(runs: Sequence[Opened]) -> tuple[str, str]:
    """The difference between two runs: their titles, or for equal ones the settings that differ."""
    first, second = (run.entry.title for run in runs)
    if first == second:
        ours, theirs = (dict(settings(run.entry.request)) for run in runs)
        differ = [name for name in ours | theirs if ours.get(name) != theirs.get(name)]
        first, second = (", ".join(f"{name} {told.get(name, 'none')}" for name in differ) for told in (ours, theirs))
    return first or "First run", second or "Second run"


def result_html(study: StudyEntry) -> str:
    """The result: a row a run, with the interval of its share in the votes for either."""
    votes = sum(study.wins) + study.ties
    line = f"“{study.question}” {counted(study.pairs, 'pair').capitalize()}. "
    if not votes:
        return status(f"{line}Nobody has voted yet.")
    rows = [(name, wins, share(wins, sum(study.wins))) for name, wins in zip(study.runs, study.wins, strict=True)]
    body = "".join(
        f'<tr><th scope="row">{text(name)}</th><td><b>{number}</b></td><td>{said}</td></tr>'
        for name, number, said in [*rows, ("No difference", study.ties, "")]
    )
    shown = table("", ["Votes", "Share (95 % interval)"], body)
    voted = status(f"{line}{counted(votes, 'vote').capitalize()} of {counted(study.voters, 'voter')}.")
    return f'{voted}<div class="pd-readouts">{shown}</div>'
