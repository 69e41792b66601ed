"""The study panel: what it makes of two chosen runs, and what it says of a study."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from html import unescape
from types import SimpleNamespace
from typing import Any

import gradio as gr
import pytest

from motion import InputError
from tests.ui.stub_engine import walking
from webdemo.inference.run import Result
from webdemo.study import Pair, StudyEntry
from webdemo.ui.history import Entry, Opened
from webdemo.ui.tabs.study import QUESTION, StudyPanel, names, result_html

PAIR = walking(0.5)
ENTRY = StudyEntry("id", "key", "Which?", ("<i>a</i>", "b"), 2)


def run(
    name: str, *, samples: int = 1, beside: Sequence[Opened] = (), title: str = "They hug.", **asked: Any
) -> Opened:
    request = {"kind": "generate", "prompt": "They hug.", "model": "intergen", "seed": 3, "guidance": 2.5} | asked
    entry = Entry(id=name, kind="generate", title=title, state="done", request=request)
    return Opened(entry=entry, result=Result(duets=(PAIR,) * samples, manifest={}), beside=tuple(beside))


class Studies:
    """Studies that write down what is asked of them."""

    def __init__(self) -> None:
        self.made: list[tuple[str, tuple[str, str], Sequence[Pair]]] = []

    def create(
        self, owner: str, question: str, runs: tuple[str, str], pairs: Sequence[Pair], *, address: str = ""
    ) -> StudyEntry:
        self.made.append((question, runs, pairs))
        return ENTRY

    def mine(self, owner: str) -> list[StudyEntry]:
        return [ENTRY] if self.made else []


@pytest.fixture
def panel() -> StudyPanel:
    runs = {
        each.entry.id: each
        for each in (run("a", samples=2), run("b", guidance=4.0, beside=[run("c", prompt="They bow.")]))
    }

    def opened(key: str, owner: str) -> Opened:
        if key not in runs:
            raise InputError("There is no such run.")
        return runs[key]

    page: Any = SimpleNamespace(history=SimpleNamespace(open=opened), studies=Studies(), shelf=None)
    with gr.Blocks():
        made = StudyPanel(page, gr.HTML())
        made.build()
    return made


def chosen(*ids: str) -> Any:
    return SimpleNamespace(_data={"act": "study", "ids": list(ids), "search": {}})


def test_a_study_is_made_of_two_chosen_runs_and_its_link_is_shown(panel: StudyPanel) -> None:
    said = panel.choose(chosen("a", "b"))
    assert "“Guidance 2.5” against “Guidance 4”" in said[panel.line] and said[panel.fold] == gr.update(open=True)
    said = panel.create(said[panel.chosen], QUESTION)
    assert "The study has 2 pairs" in said[panel.line] and said[panel.link] == "study/key"
    assert said[panel.which]["choices"] == [("“<i>a</i>” against “b”: Which?", "id")]
    assert "Nobody has voted yet" in said[panel.result] and said[panel.table]["interactive"] is False
    ((question, runs, pairs),) = panel.studies.made  # type: ignore[attr-defined]
    assert (question, runs) == (QUESTION, ("Guidance 2.5", "Guidance 4"))
    assert [pair.caption for pair in pairs] == ["They hug.", ""], "the cells of a grid are motions of their run"


def test_a_study_whose_deletion_is_not_confirmed_stays(panel: StudyPanel) -> None:
    assert list(panel.remove("")) == [panel.line], "for Gradio no update at all is an error"


@pytest.mark.parametrize(("ids", "says"), [((), "not 0"), (("a",), "not 1"), (("a", "gone"), "There is no such run")])
def test_what_cannot_be_studied_is_a_sentence(panel: StudyPanel, ids: tuple[str, ...], says: str) -> None:
    for said in (panel.choose(chosen(*ids)), panel.create(list(ids), QUESTION)):
        assert list(said) == [panel.line] and says in said[panel.line] and "pd-error" in said[panel.line]


def test_runs_of_different_titles_are_named_by_them() -> None:
    assert names([run("a", title="They hug."), run("b", title="They bow.")]) == ("They hug.", "They bow.")
    assert names([run("a"), run("b")]) == ("First run", "Second run")


def test_a_result_says_votes_shares_and_intervals() -> None:
    html = result_html(replace(ENTRY, wins=(8, 2), ties=1, voters=4))
    for part in ("<i>a</i>", "80 % (8/10; 49–94 %)", "20 % (2/10; 6–51 %)", "11 votes of 4 voters"):
        assert part in unescape(html), part
    assert "<i>a</i>" not in html
    assert "–</td>" in result_html(replace(ENTRY, ties=1, voters=1))
