"""The files of the tab React: those that runs are opened with, and partners on uploaded rigs."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

os.environ.setdefault("GRADIO_ANALYTICS_ENABLED", "False")

import gradio as gr

from tests.ui.stub_engine import walking
from tests.ui.tab_events import built, changes
from webdemo.inference.requests import ReactRequest
from webdemo.ui.components.actors import read_source
from webdemo.ui.history import Entry, Kept, Opened, Original, clean_name
from webdemo.ui.tabs.react import ReactTab
from webdemo.ui.text.examples import example_clips

from .reacting import LOADED, READ, run, upload

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


def test_an_opened_run_brings_back_the_very_file_that_was_uploaded(tab: ReactTab, walker: Path) -> None:
    source = upload(tab, walker)[-1]["source"]
    *_, last = run(tab, source)
    result = last["record"].result
    entry = Entry(id="x", kind="react", title="t", state="done", request=result.manifest["request"])
    original = Original(walker, "my walk.bvh")
    kept = Kept(controls={"up": "y", "unit": "cm", "fps": 60.0}, people=source.people, original=original)
    found = tab.opened(Opened(entry=entry, result=result, kept=kept))
    assert Path(found[tab.actor.file]).name == "my walk.bvh"
    assert Path(found[tab.actor.file]).read_bytes() == walker.read_bytes()
    assert [found[part] for part in tab.actor.known] == ["y", "cm", 60.0, "auto"]
    assert "read the file anew" in found[tab.actor.found]
    *_, again = [
        changes(READ, u) for u in tab.actor.read_again(found[tab.actor.state], "auto", "m", None, "auto", None)
    ]
    assert again["source"].people[0].num_frames == source.people[0].num_frames
    for gone in (None, Original(walker.with_name("gone.bvh"), "my walk.bvh")):
        found = tab.opened(Opened(entry=entry, result=result, kept=replace(kept, original=gone)))
        assert found[tab.actor.file] is None and found[tab.actor.state].people == source.people


def test_an_upload_is_kept_with_its_run_and_an_example_is_not(
    tab: ReactTab, walker: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    written: list[Kept] = []
    history: Any = SimpleNamespace(keep=lambda run, owner, kept: written.append(kept))
    monkeypatch.setattr(tab, "page", replace(tab.page, history=history))
    source = upload(tab, walker)[-1]["source"]
    *_, last = run(tab, replace(source, read_with=("y", "auto", None, "auto", None)))
    record = last["record"]
    tab._keep(replace(record, result=replace(record.result, run="x")), {"source": source})
    assert written[-1].original == Original(walker, walker.name)
    assert written[-1].controls["up"] == "auto"
    name, path = example_clips()[0]
    *_, shown = [changes(LOADED, u) for u in tab.actor.load(lambda: read_source(path, name))]
    tab._keep(replace(record, result=replace(record.result, run="x")), {"source": shown["source"]})
    assert clean_name(written[-1].original.name if written[-1].original else "") == ""
