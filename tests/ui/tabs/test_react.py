"""What the handlers of the React tab do, without a browser, and its endpoint."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import gradio as gr
import numpy as np
import pytest

from motion.skeleton import LAYOUTS
from tests.motion.formats.characters import glb_motion
from tests.ui.stub_engine import walking
from tests.ui.tab_events import built, taken
from webdemo.inference.methods import variants
from webdemo.inference.requests import ReactRequest
from webdemo.ui.components.actors import react_choices
from webdemo.ui.history import Entry, Kept, Opened
from webdemo.ui.tabs.react import ReactTab

from .reacting import run, upload

BOTH = [("Person A", "a"), ("Person B", "b")]


@pytest.fixture
def tab(tmp_path: Path) -> ReactTab:
    return built(ReactTab, tmp_path / "files")


def test_an_upload_is_shown_at_once(tab: ReactTab, walker: Path) -> None:
    first, last = upload(tab, walker)
    assert "Reading" in first["line"]
    assert last["trim"]["visible"]
    assert not last["person"]["visible"], "there is one person only"
    assert last["end"]["maximum"] == last["end"]["value"] == 4.0
    (sample,) = last["player"]["value"]["samples"]
    assert sample["roles"] == ["given"]
    assert sample["frames"] == 120
    assert last["player"]["value"]["title"] == "walker_a.bvh"


def test_two_people_in_a_file_are_a_choice_and_a_long_file_is_cut(tab: ReactTab, walkers: Path) -> None:
    last = upload(tab, walkers)[-1]
    assert last["person"] == gr.update(choices=BOTH, visible=True, value="a")
    assert last["end"] == gr.update(maximum=12.0, value=10.0)
    assert last["player"]["value"]["samples"][0]["frames"] == 300
    source = last["state"]
    found = taken(tab.actor, tab.actor.preview(source, "b", 2.0, 5.0))
    assert "2.0 to 5.0 s of 12.0 s" in found["line"]
    assert found["player"]["value"]["title"] == "walkers.npz, person B"
    assert found["player"]["value"]["samples"][0]["frames"] == 90
    assert not found["under"]["visible"] and found["readouts"] == "", "the stage shows no result"
    for start, end, says in (
        (2.0, 2.5, "1 s or more"),
        (0.0, 12.0, "Choose InterFormer or Nearest recorded reaction, or take 10 s or less"),
        (5.0, 2.0, 'role="alert"'),
    ):
        assert says in tab.actor.preview(source, "a", start, end)[tab.actor.line]
    assert taken(tab.actor, tab.actor.preview(None, "a", 0, 1)) == {}


@pytest.mark.parametrize("role", ["a", "b"])
def test_a_run_keeps_the_trimmed_actor_and_ends_with_both_people(tab: ReactTab, walkers: Path, role: str) -> None:
    source = upload(tab, walkers)[-1]["state"]
    steps = run(tab, source, person="b", start=1.0, end=3.0, role=role)
    assert any("step" in step["line"] for step in steps[1:-1])
    last = steps[-1]
    assert last["player"]["value"]["title"] == "they walk"
    assert len(last["player"]["value"]["samples"][0]["roles"]) == 2
    assert "walkers.npz" in last["readouts"] and "<dd>2.0 s</dd>" in last["readouts"]
    duet = last["record"].result.duets[0]
    given = walking(12.0).b.positions[30:90]
    assert duet.people[0 if role == "a" else 1].positions.tobytes() == given.tobytes()


@pytest.mark.parametrize("person", ["a", "b"])
def test_a_person_of_the_last_result_is_taken(tab: ReactTab, walker: Path, person: str) -> None:
    record = run(tab, upload(tab, walker)[-1]["state"])[-1]["record"]
    assert "file" not in upload(tab, walker)[-1], "it is the one that is used"
    updates = list(tab.actor.take_result(record))
    assert updates[-1][tab.sampling.laid] == "", "what damping did to the result that has left the stage"
    reading, last = [taken(tab.actor, each) for each in updates]
    assert last["file"] is None, "no longer what is used"
    assert (reading["go"]["interactive"], last["go"]["interactive"]) == (False, True), "not before it is read"
    assert last["person"] == gr.update(choices=BOTH, visible=True, value="a")
    again = run(tab, last["state"], person=person)[-1]["record"].result.duets[0]
    given = record.result.duets[0].people["ab".index(person)]
    assert again.a.positions.tobytes() == given.positions.tobytes()


def test_a_cancelled_upload_changes_nothing_and_a_cleared_file_leaves_no_actor(tab: ReactTab) -> None:
    assert list(tab.actor.upload(None)) == []
    left = taken(tab.actor, tab.actor.forget())
    assert left["state"] is None
    assert left["player"]["value"] is None
    assert not left["trim"]["visible"]
    assert left["readouts"] == "" and not left["under"]["visible"], "those of a result that has left the stage"


@pytest.mark.parametrize(
    ("name", "content", "sentence"),
    [
        ("broken.bvh", b"HIERARCHY\nROOT hips\n{", "broken.bvh"),
        ("empty.npz", b"", "empty.npz is empty"),
        ("words.npz", b"PK\x03\x04 nothing", "not a whole .npz"),
        (
            "robot.glb",
            glb_motion(np.tile(np.eye(3), (2, 22, 1, 1)), np.zeros((2, 3)), animations=[]),
            "robot.glb has no animation",
        ),
        ("movie.mov", b"123", "cannot be read: use .npz, .bvh, .npy, .skeleton, .txt, .glb,"),
    ],
)
def test_a_bad_file_is_one_sentence_and_leaves_no_actor(
    tab: ReactTab, tmp_path: Path, name: str, content: bytes, sentence: str
) -> None:
    path = tmp_path / name
    path.write_bytes(content)
    last = upload(tab, path)[-1]
    assert sentence in last["line"]
    assert 'role="alert"' in last["line"]
    assert last["player"]["busy"] == "" and last["player"]["value"] is None
    assert last["state"] is None and not last["trim"]["visible"]


@pytest.mark.parametrize(
    ("changed", "sentence"),
    [
        ({"source": None}, "Nobody is given yet"),
        ({"start": 3.9}, "give 1 s or more"),
        ({"start": 3.0, "end": 1.0}, "start &lt; end"),
        ({"prompt": "x" * 501}, "501 characters"),
        ({"steps": 0}, "DDIM steps"),
        ({"role": "c"}, "Role"),
        ({"prompt": "impossible"}, "The stub cannot do this"),
        ({"prompt": "crash"}, "Something went wrong inside the program (RuntimeError)"),
    ],
)
def test_errors_are_one_sentence_and_the_next_run_works(
    tab: ReactTab, walker: Path, changed: dict[str, Any], sentence: str
) -> None:
    source = upload(tab, walker)[-1]["state"]
    last = run(tab, **{"source": source, **changed})[-1]
    assert sentence in last["line"]
    assert 'role="alert"' in last["line"]
    assert "record" not in last
    assert "record" in run(tab, source)[-1]


def test_how_a_file_was_read_is_shown_and_can_be_changed(tab: ReactTab, walker: Path) -> None:
    last = upload(tab, walker)[-1]
    assert "22 joints found; lengths in m, Y is up, 30 frames a second" in last["found"]
    *_, again = [taken(tab.actor, u) for u in tab.actor.read_again(last["state"], "auto", 60, "auto", None)]
    assert "60 frames a second" in again["found"]
    assert again["state"].seconds == pytest.approx(2.0, abs=0.1)
    *_, wrong = [taken(tab.actor, u) for u in tab.actor.read_again(again["state"], "auto", 5000, "auto", None)]
    assert "not possible" in wrong["line"] and "state" not in wrong
    assert (wrong["up"], wrong["fps"]) == ("auto", 60), "the choices are again those that it was read with"


def test_one_of_more_than_two_people_is_chosen(tab: ReactTab, tmp_path: Path) -> None:
    path = tmp_path / "three.npz"
    people = np.concatenate([walking(3.0).positions, walking(3.0, 5).positions[:1]])
    np.savez(path, positions=people, fps=30)
    last = upload(tab, path)[-1]
    assert [letter for _, letter in last["person"]["choices"]] == ["a", "b", "c"]
    assert "3 people" in last["found"]
    result = run(tab, last["state"], person="c")[-1]["record"].result
    assert result.duets[0].a.positions.tobytes() == people[2].tobytes()


def test_the_order_of_fifteen_joints_is_found_and_can_be_set(tab: ReactTab, tmp_path: Path) -> None:
    joints = [max(joint, 0) for joint in LAYOUTS["k3hi15"].joints]
    path = tmp_path / "fifteen.npy"
    np.save(path, walking(3.0).a.positions[:, joints])
    last = upload(tab, path)[-1]
    assert "in the order of K3HI" in last["found"]
    *_, again = [taken(tab.actor, u) for u in tab.actor.read_again(last["state"], "auto", None, "sbu15", None)]
    assert "in the order of SBU" in again["found"]


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


@pytest.mark.parametrize(
    ("method", "model", "mode", "steps"),
    [
        ("intergen", "intergen", "offline", 8),
        ("regennet", "regennet", "offline", 5),
        ("regennet-online", "regennet", "online", 5),
    ],
)
def test_a_method_is_a_model_and_a_mode(
    tab: ReactTab, walker: Path, method: str, model: str, mode: str, steps: int
) -> None:
    source = upload(tab, walker)[-1]["state"]
    run(tab, source, method=method)
    asked = tab.page.engine.requests[-1]
    assert (asked.model, asked.mode) == (model, mode)
    role, steps_slider, pace, _, damping, *_ = tab.fit_method(method)
    assert steps_slider["value"] == steps and pace["interactive"] == steps_slider["interactive"]
    assert role["interactive"] is (model == "intergen")
    assert damping["interactive"] is (mode == "offline")


def test_a_method_streams_where_it_can_answer_pose_by_pose(tab: ReactTab) -> None:
    streams = {key for _, key in react_choices() if tab.fit_method(key)[-1]["visible"]}
    assert streams == {"automatic", "regennet", "regennet-online", "agent"}


def test_the_steps_of_every_method_can_be_set(tab: ReactTab) -> None:
    """A value outside of the slider's range is refused by the page before the job begins."""
    for method in variants("react"):
        steps = tab.fit_method(method)[1]
        assert tab.sampling.steps.minimum <= steps["value"] <= tab.sampling.steps.maximum, method
