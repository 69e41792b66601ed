"""Blind studies on the History tab: make one of chosen runs, invite people by a link, see what they say."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import gradio as gr

from motion import InputError
from webdemo.study import Stimulus
from webdemo.study.pairs import MOST_CHECKS, MOST_PAIRS
from webdemo.ui.components.notebook import Action
from webdemo.ui.components.study_sets import (
    MOST_RUNS,
    ONE_SET,
    Candidate,
    candidates,
    sets_by,
    uploaded_sets,
    ways,
)
from webdemo.ui.components.upload import FILE_TYPES
from webdemo.ui.context import PageContext
from webdemo.ui.history import HistoryLike
from webdemo.ui.studies import NewStudy, StudiesLike, StudyEntry
from webdemo.ui.text.panels import status
from webdemo.ui.text.texts import SAY, say
from webdemo.ui.text.votes import count, result_html
from webdemo.ui.text.words import error_line
from webdemo.ui.visitor import visitor

from .job import QUIET, Updates

QUESTIONS = (
    "Which does what the sentence says?",
    "Which looks more real?",
    "In which do the two people respond to each other better?",
)
_INTRO = say("study.intro")
_FILES_ALONE = "Upload two sets of motions. Files of the same name in both stand beside each other."
_DELETE = f"(study) => {{ {SAY} return confirm(say('study.delete_sure')) ? study : ''; }}"


def _upload(label: str, name: str, elem_id: str) -> tuple[gr.File, gr.Textbox]:
    """A field for the files of a set, and one for its name."""
    with gr.Column(min_width=0):
        files = gr.File(
            label=label, file_types=FILE_TYPES, height=112, file_count="multiple", elem_id=elem_id,
            elem_classes="pd-file",
        )  # fmt: skip
        return files, gr.Textbox(name, label=say("study.name"), elem_id=f"{elem_id}-name")


class StudyPanel:
    """The part of the History tab where studies are made and read.

    Args:
        page: what the tabs share; its history and its studies are there.
    """

    def __init__(self, page: PageContext) -> None:
        if page.history is None or page.studies is None:
            raise ValueError("The page keeps no studies.")
        self.page = page
        self.history: HistoryLike = page.history
        self.studies: StudiesLike = page.studies

    # ---- layout ----------------------------------------------------------------------------------

    def build(self) -> None:
        """Lays out the panel, folded until runs are chosen for it."""
        with gr.Accordion(say("study.fold"), open=False, elem_id="study") as self.fold:
            gr.HTML(f'<p class="pd-method">{_INTRO}</p>')
            self.begin = gr.Button(say("study.begin"), size="sm", elem_id="study-begin")
            self.line = gr.HTML(status(), elem_id="study-status", elem_classes="pd-line")
            with gr.Column(visible=False, min_width=0) as self.making:
                self._making()
            with gr.Column(visible=False, min_width=0, elem_classes="pd-study") as self.reading:
                self._reading()
        self.chosen = gr.State([])

    def _making(self) -> None:
        with gr.Row(elem_classes="pd-pair"):
            self.way = gr.Dropdown([], label=say("study.way"), elem_id="study-way", min_width=0)
            self.question = gr.Dropdown(
                list(QUESTIONS), value=QUESTIONS[0], allow_custom_value=True, label=say("study.question"),
                info=say("study.question_info"), elem_id="study-question", min_width=0,
            )  # fmt: skip
        with gr.Row(elem_classes="pd-pair"):
            self.uploads = [
                _upload(say("study.recorded"), "Recorded", "study-files"),
                _upload(say("study.more"), "Uploaded", "study-more-files"),
            ]
        self.title = gr.Textbox(label=say("study.title"), elem_id="study-title")
        with gr.Row(elem_classes="pd-pair"):
            self.each = gr.Slider(
                0, MOST_PAIRS, value=0, step=1, label=say("study.each"), info=say("study.each_info"),
                elem_id="study-each",
            )  # fmt: skip
            self.checks = gr.Slider(
                0, MOST_CHECKS, value=2, step=1, label=say("study.checks"),
                info=say("study.checks_info"),
                elem_id="study-checks",
            )  # fmt: skip
        with gr.Row(elem_classes="pd-pair"):
            self.sentence = gr.Checkbox(True, label=say("study.sentence"), elem_id="study-sentence")
            self.reveal = gr.Checkbox(False, label=say("study.reveal"), elem_id="study-reveal")
        self.make = gr.Button(say("study.make"), variant="primary", size="sm", elem_id="study-make")

    def _reading(self) -> None:
        self.which = gr.Dropdown([], label=say("study.which"), elem_id="study-which")
        self.link = gr.Textbox(
            label=say("study.link"), interactive=False, buttons=["copy"], elem_id="study-link"
        )
        self.result = gr.HTML(elem_id="study-result")
        with gr.Row(elem_classes="pd-downloads"):
            self.refresh = gr.Button(say("study.refresh"), size="sm", min_width=0, elem_id="study-refresh")
            self.table = gr.DownloadButton(
                say("files.votes"), size="sm", min_width=0, interactive=False, elem_id="study-csv"
            )
            self.closing = gr.Button(say("study.close"), size="sm", min_width=0, elem_id="study-close")
            self.delete = gr.Button(say("study.delete"), size="sm", min_width=0, elem_id="study-delete")

    def wire(self, tab: gr.Tab, choose: Any) -> None:
        """Wires the panel's events.

        Args:
            tab: in which it is; the studies are read when that is chosen.
            choose: the event with which the notebook says which runs are chosen.
        """
        quick: dict[str, Any] = {"concurrency_limit": 4, "concurrency_id": "studies", **QUIET}
        shown = [self.reading, self.which, self.link, self.result, self.table, self.closing]
        begun = [self.fold, self.line, self.making, self.way, self.chosen]
        choose(self.choose, outputs=begun, **quick)
        self.begin.click(self.files_alone, outputs=begun, **quick)
        uploads = [part for upload in self.uploads for part in upload]
        fields = [
            self.chosen, self.way, self.question, self.title, self.each, self.checks, self.sentence, self.reveal,
            *uploads,
        ]  # fmt: skip
        self.make.click(
            self.create, inputs=fields, outputs=[self.line, self.making, *uploads[::2], *shown],
            trigger_mode="once", **quick,
        )  # fmt: skip
        tab.select(self.show, inputs=self.which, outputs=shown, **quick)
        gr.on([self.which.input, self.refresh.click], self.show, inputs=self.which, outputs=shown, **quick)
        self.closing.click(self.close, inputs=self.which, outputs=[self.line, *shown], **quick)
        self.delete.click(self.remove, inputs=self.which, outputs=[self.line, *shown], js=_DELETE, **quick)

    # ---- events ----------------------------------------------------------------------------------

    def choose(self, event: gr.EventData) -> Updates:
        """Offers what tells the runs that are chosen in the notebook apart."""
        try:
            ids = Action(event._data).ids
            offered = ways(self._candidates(ids))
        except Exception as error:
            return gr.update(open=True), status(error_line(error), tone="error"), *((gr.skip(),) * 3)
        line = f"{len(ids)} of your runs are chosen: say what is compared, and what people decide."
        return (
            gr.update(open=True),
            status(line),
            gr.update(visible=True),
            gr.update(choices=offered, value=offered[0][1], visible=True),
            ids,
        )

    @staticmethod
    def files_alone() -> Updates:
        """Offers a study of two uploaded sets, without any run."""
        return (
            gr.update(open=True),
            status(_FILES_ALONE),
            gr.update(visible=True),
            gr.update(visible=False),
            [],
        )

    def _candidates(self, ids: Sequence[str]) -> list[Candidate]:
        if not ids:
            raise InputError("Choose the runs of the study in the list first.")
        if len(ids) > MOST_RUNS:
            raise InputError(f"{len(ids)} runs are too many for a study: choose {MOST_RUNS} at most.")
        owner = visitor().owner
        return candidates([self.history.open(run, owner) for run in ids])

    def create(
        self, ids: list[str], way: str, question: str, title: str, each: float, checks: float, sentence: bool,
        reveal: bool, *uploads: Any,
    ) -> Updates:  # fmt: skip
        """Makes the study, empties the fields for files and shows its link.

        ``uploads`` are files and name of each uploaded set in turn.
        """
        try:
            sets: dict[str, Sequence[Stimulus]] = {}
            if ids:
                sets |= sets_by(self._candidates(ids), way or ONE_SET)
            sets |= uploaded_sets(list(zip(uploads[::2], uploads[1::2], strict=True)), sets)
            if len(sets) < 2:
                raise InputError(
                    "A study compares two sets, but these are the only motions: upload files for another set, or "
                    "choose runs that differ in the list."
                    if sets
                    else "There are no motions to compare: upload files for both sets, or choose runs in the list."
                )
            study = self.studies.create(
                visitor().owner,
                NewStudy(
                    question=question or "", title=title or "", sets=sets, checks=int(checks), pairs_each=int(each),
                    shows_sentence=bool(sentence), shows_result=bool(reveal),
                ),
                address=visitor().address,
            )  # fmt: skip
        except Exception as error:
            return status(error_line(error), tone="error"), *((gr.skip(),) * (7 + len(uploads) // 2))
        line = f"The study has {count(study.pairs, 'pair')}. Send the link to the people who are to vote."
        emptied = (None for _ in uploads[::2])  # or the next study would be made of them, too
        return status(line, tone="done"), gr.update(visible=False), *emptied, *self.show(study.id)

    def show(self, study: str | None) -> Updates:
        """A study's link and result; the newest where none is named."""
        who = visitor()
        try:
            mine = {each.id: each for each in self.studies.mine(who.owner)}
        except InputError as error:
            said = status(error_line(error), tone="error")
            return gr.update(visible=True), gr.skip(), gr.skip(), said, gr.skip(), gr.skip()
        if not mine:
            return gr.update(visible=False), gr.update(choices=[], value=None), *((gr.skip(),) * 4)
        found = mine.get(study or "") or next(iter(mine.values()))
        choices = [
            (f"{each.title} ({', '.join(each.sets)[:60]}; {count(each.votes, 'vote')})", each.id)
            for each in mine.values()
        ]
        html, file = self._result(found)
        return (
            gr.update(visible=True),
            gr.update(choices=choices, value=found.id),
            f"{who.base}study/{found.key}",
            html,
            gr.update(value=file, interactive=file is not None),
            gr.update(value=say("study.open") if found.closed else say("study.close")),
        )

    def _result(self, study: StudyEntry) -> tuple[str, str | None]:
        """The result as HTML, and all votes in a file; a sentence and no file while there is nothing to see."""
        who = visitor()
        try:
            result = self.studies.result(study.id, who.owner, who.person)
            if not study.votes:
                return result_html(study, result), None
            file = self.page.shelf.folder() / f"votes-{study.id[:8]}.csv"
            self.studies.export(study.id, who.owner, file, who.person)
        except Exception as error:
            return status(error_line(error), tone="warning"), None
        return result_html(study, result), str(file)

    def close(self, study: str | None) -> Updates:
        """Ends the voting, or opens it again."""
        try:
            owner = visitor().owner
            found = next((each for each in self.studies.mine(owner) if each.id == study), None)
            if found is None:
                raise InputError("Choose a study first.")
            self.studies.close(found.id, owner, closed=not found.closed)
        except Exception as error:
            return status(error_line(error), tone="error"), *((gr.skip(),) * 6)
        line = (
            "People can vote again."
            if found.closed
            else "The voting has ended: its link takes no more votes."
        )
        return status(line, tone="done"), *self.show(found.id)

    def remove(self, study: str | None) -> Updates:
        """Deletes a study; nothing where that was not confirmed."""
        if not study:
            return (gr.skip(),) * 7
        try:
            self.studies.delete(study, visitor().owner)
        except Exception as error:
            return status(error_line(error), tone="error"), *((gr.skip(),) * 6)
        return status("Deleted the study and its votes.", tone="done"), *self.show(None)
