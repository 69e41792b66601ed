"""The files of the tab React: those that runs are opened with, and partners on uploaded rigs."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path

import pytest

os.environ.setdefault("GRADIO_ANALYTICS_ENABLED", "False")

import gradio as gr

from tests.ui.stub_engine import walking
from tests.ui.tab_events import built
from webdemo.inference.requests import ReactRequest
from webdemo.ui.history import Entry, Kept, Opened
from webdemo.ui.tabs.react import ReactTab

BOTH = [("Person A", "a"), ("Person B", "b")]


@pytest.fixture
def tab(tmp_path: Path) -> ReactTab:
    return built(ReactTab, tmp_path / "files")


def test_an_opened_run_brings_back_its_file_its_person_and_its_part(tab: ReactTab) -> None:
    pair = walking(3.0)
    request = ReactRequest(actor=replace(pair.b.cut(15, 75), name="sub/ject 1.bvh"), steps=1)
    *_, result = tab.page.engine.run(request)
    entry = Entry(id="x", kind="react", title="t", state="done", request=request.to_dict())
    kept = Kept(controls={"person": "b", "start": 0.5, "end": 2.5}, people=pair.people)
    found = tab.opened(Opened(entry=entry, result=result, kept=kept))
    assert found[tab.actor.person] == gr.update(choices=BOTH, visible=True, value="b")
    assert (found[tab.actor.begin]["value"], found[tab.actor.end]["value"]) == (0.5, 2.5)
    assert found[tab.actor.file] is None and found[tab.actor.state].people == pair.people
    by_link = tab.opened(Opened(entry=entry, result=result, kept=Kept(controls={"person": "x"})))
    assert by_link[tab.actor.file] is None and by_link[tab.actor.begin]["value"] == 0.0
    wrong = tab.opened(Opened(entry=entry, result=result, kept=replace(kept, controls={"person": ["b"]})))
    assert wrong[tab.actor.person]["value"] == "a", "a workspace made by hand"
