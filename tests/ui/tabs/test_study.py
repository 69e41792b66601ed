"""The study panel: which sets the chosen runs make, and what it says of a study."""

from __future__ import annotations

from collections.abc import Sequence
from html import unescape
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import gradio as gr
import pytest

from motion import InputError
from motion.formats import write
from tests.ui.stub_engine import walking
from tests.ui.tab_events import in_english
from webdemo.inference.requests import Result
from webdemo.study import Comparison, StudyResult, matched_pairs
from webdemo.ui.components.study_sets import MOST_FILES, ONE_SET, candidates, sets_by, uploaded, ways
from webdemo.ui.history import Entry, Opened
from webdemo.ui.studies import NewStudy, StudyEntry
from webdemo.ui.tabs.study import QUESTIONS, StudyPanel
from webdemo.ui.text.votes import result_html

PAIR = walking(0.5)
NO_FILES = (None, "Recorded", None, "Uploaded")


def run(
    name: str, *, tags: tuple[str, ...] = (), samples: int = 1, beside: Sequence[Opened] = (), **asked: Any
) -> Opened:
    request = {
        "kind": "generate",
        "prompt": "They hug.",
        "model": "intergen",
        "seed": 3,
        "guidance": 2.5,
    } | asked
    entry = Entry(
        id=name, kind=str(request["kind"]), title=f"Title of {name}", state="done", tags=tags, request=request
    )
    return Opened(entry=entry, result=Result(duets=(PAIR,) * samples, manifest={}), beside=tuple(beside))


def labels(runs: Sequence[Opened]) -> list[str]:
    return [label for label, _ in ways(candidates(runs))]


def test_settings_that_differ_are_offered_with_the_sets_that_they_make() -> None:
    runs = [run("a"), run("b", guidance=4.0, seed=4), run("c", model="bigraphdiff", samples=2)]
    offered = labels(runs)
    assert offered[0].startswith("Method: ") and "BiGraphDiff (2)" in offered[0]
    assert "Guidance: guidance 2.5 (3) against guidance 4 (1)" in offered
    assert offered[-1] == "One set of all chosen motions (4), against uploaded ones"
    assert not any(label.startswith(("Steps", "Tag")) for label in offered)
    assert next(i for i, label in enumerate(offered) if label.startswith("Seed")) > 1, (
        "seeds are rarely meant"
    )


def test_tags_that_not_all_have_make_sets_and_stand_first() -> None:
    found = candidates(
        [run("a", tags=("paper", "ours")), run("b", tags=("paper", "theirs")), run("c", tags=("paper",))]
    )
    assert ways(found)[0] == ("Tag: ours (1) against theirs (1)", "Tag")
    assert list(sets_by(found, "Tag")) == ["ours", "theirs"]


def test_the_cells_of_a_grid_are_motions_of_their_own_and_count_once() -> None:
    cells = [run("two", guidance=5.0), run("three", guidance=7.0)]
    found = candidates([run("one", beside=cells), cells[0]])
    assert {name: len(each) for name, each in sets_by(found, "Guidance").items()} == {
        "guidance 2.5": 1, "guidance 5": 1, "guidance 7": 1,
    }  # fmt: skip


def test_a_voter_never_gets_the_owners_words() -> None:
    reaction = run("r", kind="react", prompt="", actor={"name": "subject-12.bvh"})
    named = run("n", prompt="They hug.")
    assert [each.stimulus.caption for each in candidates([reaction, named])] == ["", "They hug."]
    assert [each.stimulus.name for each in candidates([reaction, named])] == ["subject-12.bvh", "They hug."]


def test_files_become_a_set_and_a_bad_one_is_named(tmp_path: Path) -> None:
    write(PAIR, tmp_path / "they-hug.npz")
    (stimulus,) = uploaded([str(tmp_path / "they-hug.npz")])
    assert (stimulus.key, stimulus.caption, stimulus.motion.num_frames) == ("they hug", "", PAIR.num_frames)
    (tmp_path / "bad.npz").write_bytes(b"nothing")
    with pytest.raises(InputError, match=r"^bad\.npz: "):
        uploaded([str(tmp_path / "bad.npz")])
    with pytest.raises(InputError, match="51 files are too many"):
        uploaded(["x.npz"] * (MOST_FILES + 1))


class Studies:
    """Studies that write down what is asked of them."""

    def __init__(self) -> None:
        self.made: list[NewStudy] = []

    def create(self, owner: str, study: NewStudy, *, address: str = "") -> StudyEntry:
        self.made.append(study)
        return entry(pairs=2)

    def mine(self, owner: str) -> list[StudyEntry]:
        return [entry(pairs=2)] if self.made else []

    def result(self, study: str, owner: str, person: str = "") -> StudyResult:
        return result()


def entry(**fields: Any) -> StudyEntry:
    known: dict[str, Any] = {
        "id": "id", "key": "key", "title": "Title", "question": "Which?", "sets": ("a", "b"), "pairs": 3, "checks": 1,
        "closed": False, "created": 0.0, "raters": 0, "votes": 0,
    }  # fmt: skip
    return StudyEntry(**(known | fields))


def result(**fields: Any) -> StudyResult:
    known: dict[str, Any] = {
        "comparisons": (Comparison(("<i>a</i>", "b"), 8, 2, 1, 3),), "raters": 4, "excluded": 1, "votes": 11,
        "alpha": 0.4321, "agreement": 0.7,
    }  # fmt: skip
    return StudyResult(**(known | fields))


def panel(*runs: Opened) -> StudyPanel:
    by_id = {each.entry.id: each for each in runs}

    def opened(key: str, owner: str) -> Opened:
        if key not in by_id:
            raise InputError("There is no such run.")
        return by_id[key]

    history = SimpleNamespace(open=opened)
    page: Any = SimpleNamespace(history=history, studies=Studies(), shelf=None)
    return StudyPanel(page)


def chosen(*ids: str) -> Any:
    return SimpleNamespace(_data={"act": "study", "ids": list(ids), "search": {}})


def test_a_study_is_made_of_chosen_runs_and_its_link_is_shown() -> None:
    study = panel(run("a"), run("b", guidance=4.0))
    fold, line, making, way, ids = study.choose(chosen("a", "b"))
    assert fold == gr.update(open=True) and "2 of your runs" in line and making == gr.update(visible=True)
    assert way["value"] == "Guidance"
    line, _, _, _, reading, which, link, html, table, closing = study.create(
        ids, "Guidance", QUESTIONS[1], "", 0, 2, True, False, *NO_FILES
    )
    assert "The study has 2 pairs" in line and link == "study/key" and reading == gr.update(visible=True)
    (made,) = study.studies.made  # type: ignore[attr-defined]
    assert (made.question, made.checks, list(made.sets)) == (QUESTIONS[1], 2, ["guidance 2.5", "guidance 4"])
    assert which["value"] == "id" and in_english(closing["value"]) == "End the voting"
    assert "Nobody has voted yet" in html and table["interactive"] is False


@pytest.mark.parametrize(
    ("ids", "says"),
    [
        ((), "Choose the runs of the study"),
        (("gone",), "There is no such run"),
        (("a",) * 101, "101 runs are too many"),
    ],
)
def test_what_cannot_be_studied_is_a_sentence(ids: tuple[str, ...], says: str) -> None:
    _, line, *rest = panel(run("a")).choose(chosen(*ids))
    assert says in line and "pd-error" in line and rest == [gr.skip()] * 3


def test_two_uploaded_sets_make_a_study_without_any_run(tmp_path: Path) -> None:
    ours, theirs = [], []
    for folder, files in (("ours", ours), ("theirs", theirs)):
        (tmp_path / folder).mkdir()
        for name in ("hug", "wave"):
            files.append(str(write(PAIR, tmp_path / folder / f"{name}.npz")[0]))
    study = panel()
    fold, line, making, way, ids = study.files_alone()
    assert fold == gr.update(open=True) and "Upload two sets" in line and ids == []
    assert making == gr.update(visible=True) and way == gr.update(visible=False), (
        "there is nothing to choose from"
    )
    line, making, *files, _, _, _, _, _, _ = study.create(
        ids, "", "Which?", "", 0, 1, True, False, ours, " Ours ", theirs, "Theirs"
    )
    assert "The study has" in line and making == gr.update(visible=False)
    assert files == [None, None], "the next study is not made of them"
    (made,) = study.studies.made  # type: ignore[attr-defined]
    assert {name: [each.key for each in given] for name, given in made.sets.items()} == {
        "Ours": ["hug", "wave"], "Theirs": ["hug", "wave"],
    }  # fmt: skip
    assert [pair.motions for pair in matched_pairs(list(made.sets.values()))] == [(0, 2), (1, 3)]


def test_runs_and_two_uploaded_sets_are_three_sets(tmp_path: Path) -> None:
    file = str(write(PAIR, tmp_path / "they-hug.npz")[0])
    study = panel(run("a"))
    study.create(["a"], ONE_SET, "Which?", "", 0, 0, True, False, [file], "Recorded", [file], "Theirs")
    (made,) = study.studies.made  # type: ignore[attr-defined]
    assert list(made.sets) == ["Chosen runs", "Recorded", "Theirs"]


@pytest.mark.parametrize(
    ("ids", "names", "says"),
    [
        ([], (None, None), "no motions to compare: upload files for both sets"),
        ([], ("Mine", None), "the only motions: upload files for another set"),
        (["a"], (None, None), "the only motions: upload files for another set"),
        ([], ("Mine", "Mine"), "There is a set 'Mine' already"),
        (["a"], (None, "Chosen runs"), "There is a set 'Chosen runs' already"),
        ([], ("Mine", "  "), "An uploaded set has no name"),
        (["gone"], ("Mine", None), "There is no such run"),
    ],
)
def test_uploaded_sets_that_make_no_study_are_a_sentence(
    ids: list[str], names: tuple[str | None, str | None], says: str, tmp_path: Path
) -> None:
    file = str(write(PAIR, tmp_path / "x.npz")[0])
    study = panel(run("a"))
    given = [part for name in names for part in ([file] if name else None, name or "Unused")]
    line, *rest = study.create(ids, ONE_SET, "?", "", 0, 0, True, False, *given)
    assert says in unescape(line) and "pd-error" in line and rest == [gr.skip()] * 9
    assert not study.studies.made  # type: ignore[attr-defined]


def test_a_result_says_wins_interval_agreement_and_who_was_left_out() -> None:
    html = result_html(entry(votes=14, closed=True), result())
    for part in (
        "&lt;i&gt;a&lt;/i&gt; against b", "<b>8</b>", "<b>80%</b>", "49% to 94%", "0.109", "α 0.43", "70% of all pairs",
        "11 votes of 4 people count, 1 more left out", "The voting has ended",
    ):  # fmt: skip
        assert part in html, part
    assert "<i>a</i>" not in html
    alike = result_html(entry(votes=4), result(alpha=None, agreement=1.0))
    assert "not defined, since all votes are the same" in alike
    assert "not known" in result_html(entry(votes=1), result(agreement=None))
