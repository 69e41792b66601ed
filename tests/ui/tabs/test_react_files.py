"""The files of the tab React: those that runs are opened with, and partners on uploaded rigs."""

from __future__ import annotations

import os
import zipfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

os.environ.setdefault("GRADIO_ANALYTICS_ENABLED", "False")

import gradio as gr

from motion import Clip
from motion.formats import read
from tests.motion.bodies import marching
from tests.motion.formats.characters import glb_motion
from tests.motion.formats.rigs import RIGS, bvh_text
from tests.ui.stub_engine import walking
from tests.ui.tab_events import built
from webdemo.inference.requests import ReactRequest
from webdemo.ui.components.actors import rig_of
from webdemo.ui.components.exports import KINDS
from webdemo.ui.history import Entry, Kept, Opened
from webdemo.ui.tabs.react import ReactTab

from .reacting import run, upload

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


def test_a_partner_is_taken_on_the_rig_of_an_uploaded_bvh(tab: ReactTab, tmp_path: Path) -> None:
    rig = tmp_path / "my rig.bvh"
    positions, rotations = marching(90)
    rig.write_text(bvh_text(rotations, positions[:, 0], RIGS["mixamo"]), encoding="utf-8")
    source = upload(tab, rig)[-1]["source"]
    *_, last = run(tab, source, end=2.0, samples=2)
    assert last["record"].rig == rig
    _, *updates = tab.results.export(last["record"])
    update = updates[[kind.key for kind in KINDS].index("rig")]
    assert update["interactive"] and update["visible"]
    with zipfile.ZipFile(update["value"]) as archive:
        files = {name: archive.read(name) for name in archive.namelist()}
    assert files.pop("my rig.bvh") == rig.read_bytes(), "the original stands beside it, untouched"
    head = rig.read_text().split("MOTION")[0]
    assert len(files) == 2
    for content in files.values():
        assert content.decode().split("MOTION")[0] == head, "units, names and rest pose are those of the rig"
        made = read(content, name="made.bvh")
        assert isinstance(made, Clip) and made.num_frames == 60
    partner = last["record"].result.duets[0].b.positions
    found = min(np.abs(read(c, name="x.bvh").positions - partner).mean() for c in files.values())
    assert found < 0.1, "it is the partner, in the rig's own world"


def test_a_partner_is_taken_on_the_skeleton_of_an_uploaded_glb(tab: ReactTab, tmp_path: Path) -> None:
    rig = tmp_path / "robot.glb"
    positions, rotations = marching(90)
    rig.write_bytes(glb_motion(rotations, positions[:, 0], "unreal", unit=100.0))
    *_, last = run(tab, upload(tab, rig)[-1]["source"], end=2.0)
    _, *updates = tab.results.export(last["record"])
    update = updates[[kind.key for kind in KINDS].index("rig")]
    with zipfile.ZipFile(update["value"]) as archive:
        files = {name: archive.read(name) for name in archive.namelist()}
    assert files.pop("robot.glb") == rig.read_bytes(), "the original stands beside it, untouched"
    ((name, content),) = files.items()
    assert name.endswith("-on-your-rig.glb")
    partner = last["record"].result.duets[0].b.positions
    assert np.abs(read(content, name=name).positions - partner).mean() < 0.1, "it is the partner"


def test_only_a_rig_that_was_read_as_it_is_is_offered(tab: ReactTab, walker: Path, walkers: Path) -> None:
    source = upload(tab, walker)[-1]["source"]
    assert rig_of(source) == walker
    assert rig_of(None) is None and rig_of(replace(source, read_with=("z", "auto", None, "auto", None))) is None
    assert rig_of(upload(tab, walkers)[-1]["source"]) is None
    *_, last = run(tab, replace(source, path=None), end=2.0)
    _, *updates = tab.results.export(last["record"])
    update = updates[[kind.key for kind in KINDS].index("rig")]
    assert not update["visible"] and update["value"] is None


def test_a_rig_that_cannot_be_moved_is_a_sentence_and_the_other_files_are_there(tab: ReactTab, walker: Path) -> None:
    *_, last = run(tab, upload(tab, walker)[-1]["source"], end=2.0)
    last["record"].rig = walker.with_name("gone.bvh")
    line, *updates = tab.results.export(last["record"])
    assert "not on the rig of your file. gone.bvh cannot be read" in line
    assert updates[0]["interactive"]
