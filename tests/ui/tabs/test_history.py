"""The History tab: what the notebook shows, and what is done with what it tells."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import gradio as gr
import numpy as np
import pytest

from motion import SKELETONS, Clip, InputError
from tests.ui.stub_engine import walking
from tests.ui.tab_events import built
from webdemo.inference.run import Result
from webdemo.ui.components.notebook import MOST_SHOWN, STEP, Action, facts, shown
from webdemo.ui.history import Entry, Found, Opened, Search, Usage
from webdemo.ui.tabs.generate import GenerateTab
from webdemo.ui.tabs.history import EMPTY, NOTHING_FOUND, HistoryTab, compared
from webdemo.ui.tabs.history_files import room_html
from webdemo.ui.text.words import day, settings

WHEN = day(0, " %H:%M")


def entry(name: str) -> Entry:
    return Entry(id=name, kind="generate", title=f"They {name}.", state="done", request={"seconds": 5, "seed": 3})


class Book:
    """A history that holds just these runs and writes down what is asked of it."""

    def __init__(self, *entries: Entry) -> None:
        self.entries, self.done = list(entries), []  # type: ignore[var-annotated]

    def search(self, owner: str, wanted: Search) -> Found:
        self.done.append(wanted)
        return Found(self.entries, len(self.entries))

    def entry(self, run: str, owner: str) -> Entry:
        found = next((each for each in self.entries if each.id == run), None)
        if found is None:
            raise InputError("There is no such run in your history: reload the page.")
        return found

    def __getattr__(self, name: str) -> Any:
        def act(*given: Any, **fields: Any) -> Any:
            self.done.append((name, *given[:1], fields))
            room = Usage(runs=3 * 2**20, allowed=500 * 2**20, kept=375 * 2**20)
            answers = {"revoke": len(self.entries), "link": ("key", 0.0), "export": 2, "usage": room}
            return answers.get(name, 1)

        return act


def tab(book: Any, tmp_path: Path | None = None) -> HistoryTab:
    page: Any = SimpleNamespace(history=book, shelf=SimpleNamespace(folder=lambda size: tmp_path))
    return HistoryTab(page, {}, tabs=None)  # type: ignore[arg-type] # no tab is opened here


def press(history: HistoryTab, act: str, *ids: str, removed: tuple[str, ...] = (), **more: Any) -> Any:
    event: Any = SimpleNamespace(_data={"act": act, "ids": list(ids), "search": {}, **more})
    names = ("view", "who", "line", "address", "saved", "removed")
    return SimpleNamespace(**dict(zip(names, history.act(list(removed), event), strict=True)))


def test_a_card_tells_everything_of_a_run() -> None:
    run = replace(
        entry("hug"),
        links=2,
        favourite=True,
        tags=("paper",),
        note="Hands.",
        request={
            "kind": "react",
            "model": "regennet",
            "mode": "online",
            "seed": 12345678,
            "guidance": 4.5,
            "actor": {"name": "walker.bvh"},
            "role": "b",
            "cleanup": True,
        },
    )
    assert facts(run) == f"ReGenNet, online · seed 12345678 · {WHEN} · 2 links"
    assert ["Given", "walker.bvh"] in settings(run.request) and ["The given person", "reacts"] in settings(run.request)
    assert ["Seed", "12345678"] in settings(run.request) and ["Guidance", "4.5"] in settings(run.request)
    (card,) = shown(Found([run], 1), empty="")["entries"]
    assert (card["favourite"], card["tags"], card["note"]) == (True, ("paper",), "Hands.")
    assert facts(replace(run, state="failed", links=0)).endswith("✕ failed")


@pytest.mark.parametrize(
    ("request_", "method"),
    [
        ({"kind": "react", "model": "intergen", "mode": "offline"}, "InterGen, person to person · "),
        ({"kind": "react", "model": "regennet", "mode": "online"}, "ReGenNet, online · "),
        ({"kind": "predict", "model": "motion-mlp"}, "Motion MLP · "),
        ({"kind": "react", "model": "gone", "mode": "offline"}, "gone · "),
        ({"kind": "generate", "model": "intergen"}, ""),
        ({"kind": "generate", "model": "bigraphdiff"}, "BiGraphDiff · "),
    ],
)
def test_what_has_several_methods_says_which(request_: dict[str, Any], method: str) -> None:
    run = replace(entry("wave"), kind=request_["kind"], request=request_ | {"seed": 3})
    assert facts(run).startswith(f"{method}seed 3 · ")


def test_the_list_is_searched_and_says_why_it_is_empty() -> None:
    book = Book()
    empty = tab(book).refresh([])[0]["value"]
    assert empty["empty"] == EMPTY and empty["removed"] == 0
    asked = {"words": "hug", "starred": True, "kind": "", "tag": "a"}
    found = press(tab(book), "search", search=asked).view["value"]
    assert found["empty"] == NOTHING_FOUND
    assert book.done[-2] == Search(words="hug", starred=True, tag="a", limit=STEP)
    press(tab(book), "search", limit=120)
    assert book.done[-2].limit == 120


def test_runs_are_kept_named_removed_and_brought_back() -> None:
    book = Book(entry("hug"), replace(entry("wave"), favourite=True))
    history = tab(book)
    assert "Kept" in press(history, "favour", "hug").line
    assert "No longer kept" in press(history, "favour", "wave").line
    fields = {"title": "Best", "tags": "a b", "note": "n"}
    assert "Saved" in press(history, "describe", "hug", **fields).line
    assert ("describe", "hug", fields) in book.done
    gone = press(history, "remove", "hug")
    assert "Removed one run, links included" in gone.line and gone.removed == ["hug"]
    assert gone.view["value"]["removed"] == 1
    back = press(history, "restore", removed=("hug",))
    assert "Brought one run back" in back.line and back.removed == []
    linked = press(history, "link", "hug")
    assert linked.address["value"] == "?run=key" and linked.address["visible"]
    assert "2 links to it no longer work" in press(history, "revoke", "hug").line


def test_an_export_says_what_is_in_it(tmp_path: Path) -> None:
    book = Book(entry("hug"))
    (tmp_path / "pas-de-deux-results.zip").write_bytes(b"x" * 2**20)
    history = tab(book, tmp_path)
    answer = press(history, "export", "hug")
    assert "2 runs in one file of 1.0 MB." in answer.line and answer.saved["visible"]
    assert (press(history, "search").saved, press(history, "search").address) == (gr.skip(), gr.skip())
    assert not press(history, "favour", "hug").saved["visible"]


@pytest.mark.parametrize(
    "data", [None, [], {"act": "open", "ids": "hug"}, {"act": "open", "ids": ["a"] * (MOST_SHOWN + 1)}]
)
def test_what_a_notebook_never_sends_is_refused(data: Any) -> None:
    with pytest.raises(InputError, match="something unknown"):
        Action.read(data)


def test_an_act_that_the_notebook_does_not_know_is_refused() -> None:
    assert "something unknown" in press(tab(Book(entry("hug"))), "drop", "hug").line


def test_a_history_that_cannot_be_read_is_a_sentence() -> None:
    broken = Book()

    def search(owner: str, wanted: Search) -> Found:
        raise InputError("The server's history cannot be read or written.")

    broken.search = search  # type: ignore[method-assign]
    assert tab(broken).refresh([])[0]["value"]["empty"].endswith("cannot be read or written.")
    assert "cannot be read or written" in press(tab(broken), "search", search={"words": "a"}).view["value"]["empty"]


def test_chosen_runs_are_compared_in_a_grid(tmp_path: Path) -> None:
    result = Result(duets=(walking(1.0),), manifest={"model": "stub"})
    runs = [Opened(entry=entry(name), result=replace(result, run="id")) for name in ("hug", "wave", "wave")]
    names = ["They hug., seed 3", "They wave., seed 3", "They wave., seed 3 #2"]
    job, book = built(GenerateTab, tmp_path), SimpleNamespace(open=lambda run, _: runs[int(run)])
    page: Any = SimpleNamespace(history=book)
    history = HistoryTab(page, {"generate": job}, tabs=gr.Tabs())
    history.line = gr.HTML()
    seen = history.compare(SimpleNamespace(_data={"act": "compare", "ids": ["0", "1", "2"]}))
    cells = seen[job.results.player]["value"]["samples"][0]["cells"]
    assert [cell["caption"] for cell in cells] == names
    assert seen[job.record].result.run == "", "a link would show one of them alone"
    assert seen[job.reading] == gr.update(checked={}), "the verdicts were on another motion"
    with pytest.raises(InputError, match="two to 9 runs"):
        compared(runs[:1])
    fewer = Clip(np.zeros((30, 15, 3)), 30, SKELETONS["sbu15"])
    with pytest.raises(InputError, match="different joints"):
        compared([*runs, Opened(entry=entry("sit"), result=replace(result, duets=(fewer,)))])


def test_room_is_told_once_half_of_it_is_used() -> None:
    assert room_html(Usage(runs=40 * 2**20, allowed=100 * 2**20, kept=75 * 2**20)) == ""
    told = room_html(Usage(runs=60 * 2**20, allowed=100 * 2**20, kept=75 * 2**20))
    assert "60 of 100 MB used: runs 60. When runs and studies reach 75 MB" in told and "<meter" in told


@pytest.mark.parametrize("value", [[1], {"a": None}, 10**400, "x", 1e999])
def test_settings_of_a_file_from_elsewhere_are_shown_whatever_they_are(value: Any) -> None:
    asked = {"kind": value, "model": value, "actor": {"name": value}, "mode": value, "role": value}
    asked |= dict.fromkeys(("guidance", "steps", "seed"), value)
    assert ["Steps", str(value)] in settings(asked) or isinstance(value, float)
