"""The History tab's list: what is there, and what can be done with it."""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import gradio as gr
import pytest

from motion import InputError
from webdemo.inference.requests import Progress, Result
from webdemo.ui.history import Entry
from webdemo.ui.tabs.history import _ABLE, HistoryTab, _signed_in
from webdemo.ui.visitor import Visitor


def tab(*entries: Entry) -> HistoryTab:
    """A tab of a history that holds just these runs."""
    history: Any = SimpleNamespace(
        entries=lambda owner: list(entries), revoke=lambda run, owner: len(entries)
    )
    page: Any = SimpleNamespace(history=history)
    return HistoryTab(page, {}, tabs=None)  # type: ignore[arg-type] # no tab is opened here


def entry(name: str) -> Entry:
    return Entry(
        id=name, kind="generate", title=f"They {name}.", state="done", request={"seconds": 5, "seed": 3}
    )


def test_an_empty_list_says_so_and_has_no_buttons() -> None:
    chosen, empty, _, actions, *_ = tab().refresh(None)
    assert chosen["choices"] == []
    assert empty["visible"] is True
    assert actions["visible"] is False


def test_a_run_that_is_still_there_stays_chosen() -> None:
    chosen, empty, _, actions, *_ = tab(entry("hug"), entry("wave")).refresh("wave")
    when = time.strftime("%d %b %H:%M", time.localtime(0))
    assert chosen["value"] == "wave"
    assert chosen["choices"][0] == (f"They hug. · 5 s · seed 3 · {when}", "hug")
    assert empty["visible"] is False
    assert actions["visible"] is True
    assert tab(entry("hug")).refresh("wave")[0]["value"] == "hug"


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
    run = Entry(
        id="a", kind=request_["kind"], title="One waves.", state="done", request=request_ | {"seed": 3}
    )
    label, _ = tab(run).refresh(None)[0]["choices"][0]
    assert label.startswith(f"One waves. · {method}seed 3 · ")


@pytest.mark.parametrize(("runs", "sentence"), [(1, "Its link no longer works."), (2, "2 links to it")])
def test_ended_links_are_counted(runs: int, sentence: str) -> None:
    assert sentence in tab(*(entry(str(i)) for i in range(runs))).revoke("0")[0]
    line, address = tab().revoke(None)
    assert "Choose a run first" in line and address["visible"] is False


def able(history: HistoryTab, run: str) -> dict[str, bool]:
    """What can be done with a run."""
    return dict(
        zip(_ABLE, (update["interactive"] for update in history.choose(run)[-len(_ABLE) :]), strict=True)
    )


def test_buttons_are_as_the_run_lets_them_be() -> None:
    linked = replace(entry("hug"), links=1, favourite=True)
    lost = replace(entry("lost"), state="interrupted", message="Run it again.")
    history = tab(linked, entry("wave"), lost, replace(entry("now"), state="running"))
    assert [name for name, can in able(history, "hug").items() if not can] == ["remove"]  # it is kept
    assert [name for name, can in able(history, "wave").items() if not can] == ["revoke"]
    assert [name for name, can in able(history, "lost").items() if can] == ["favour", "again", "remove"]
    assert [name for name, can in able(history, "now").items() if can] == ["favour"]
    assert not any(able(history, "gone").values())
    names = [history.choose(run)[2 + _ABLE.index("favour")]["value"] for run in ("hug", "wave")]
    assert names == ["Stop keeping", "Keep"]
    assert "Run it again." in history.choose("lost")[0] and "Run it again." not in history.choose("hug")[0]


def test_a_run_without_a_result_is_run_again() -> None:
    lost = replace(
        entry("lost"), state="interrupted", request={"prompt": "They hug.", "seconds": 2.0, "seed": 9}
    )
    reaction = replace(lost, id="r", kind="react")
    asked: list[Any] = []

    def run(session: str, request: Any, *, alone: bool) -> Iterator[Any]:
        asked.append((request.prompt, request.seconds, request.seed, alone))
        yield Progress(stage="text")
        yield Result(duets=(), manifest={})

    history = tab(lost, reaction)
    history.page.runs = SimpleNamespace(run=run)  # type: ignore[assignment]
    who: Any = SimpleNamespace(session_hash="s")
    *_, (line, again, stop) = history.again("lost", who)
    assert asked == [("They hug.", 2.0, 9, True)] and "its result is in the list" in line
    assert again["interactive"] is True and stop["interactive"] is False
    *_, (line, _, _) = history.again("r", who)
    assert "send the file again" in line and len(asked) == 1


def test_a_history_that_cannot_be_read_is_a_sentence() -> None:
    broken = tab()

    def entries(owner: str) -> list[Entry]:
        raise InputError("The server's history cannot be read or written.")

    broken.history.entries = entries  # type: ignore[method-assign]
    for act in (broken.refresh, broken.choose):
        with pytest.raises(gr.Error, match="cannot be read or written"):
            act("hug")


def test_one_signs_out_by_a_button_that_posts() -> None:
    ada = Visitor(account="ada<", base="https://lab.example/motion/")
    shown = _signed_in(ada)
    assert (
        '<form class="pd-status pd-account" method="post" action="https://lab.example/motion/logout">'
        in shown
    )
    assert "ada&lt;" in shown and "href" not in shown
