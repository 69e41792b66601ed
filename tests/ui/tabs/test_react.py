"""What the handlers of the React tab do, without a browser, and its endpoint."""

from __future__ import annotations

import os
import re
import time
import zipfile
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

os.environ.setdefault("GRADIO_ANALYTICS_ENABLED", "False")

import gradio as gr

from motion import Clip, InputError
from motion.formats import read, write
from motion.layouts import LAYOUTS
from tests.motion.bodies import marching
from tests.motion.formats.characters import glb_character, glb_motion
from tests.motion.formats.rigs import RIGS, bvh_text
from tests.ui.stub_engine import walking
from tests.ui.tab_events import built, changes
from webdemo.inference.live import LiveRequest
from webdemo.inference.methods import variants
from webdemo.inference.requests import ReactRequest
from webdemo.ui.components.actors import read_source, rig_of
from webdemo.ui.components.exports import KINDS
from webdemo.ui.components.live import BATCH, REPEATED
from webdemo.ui.history import Entry, Kept, Opened, Original, clean_name
from webdemo.ui.tabs.react import ReactTab
from webdemo.ui.text.examples import example_clips
from webdemo.view.payload import unpack_positions

BOTH = [("Person A", "a"), ("Person B", "b")]
LOADED = ("source", "given", "line", "player", "trim", "person", "start", "end", "found")
READ = (*LOADED, "up", "unit", "fps", "order")
FIELDS = {"person": "a", "start": 0.0, "end": 10.0, "role": "a", "prompt": "they walk", "seed": 3,
          "samples": 1, "guidance": 2.5, "steps": 5, "damping": 0.7}  # fmt: skip


@pytest.fixture
def tab(tmp_path: Path) -> ReactTab:
    return built(ReactTab, tmp_path / "files")


def upload(tab: ReactTab, path: Path) -> list[dict[str, Any]]:
    return [changes(LOADED, updates) for updates in tab.upload(str(path))]


def run(tab: ReactTab, source: Any, **changed: Any) -> list[dict[str, Any]]:
    fields = {"source": source, **FIELDS, **changed}
    return [changes(tab.outputs, updates) for updates in tab.run("me", fields)]


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


def test_an_animated_character_is_an_actor(tab: ReactTab, tmp_path: Path) -> None:
    positions, rotations = marching(60)
    (tmp_path / "walk.glb").write_bytes(glb_motion(rotations, positions[:, 0], unit=100.0))
    last = upload(tab, tmp_path / "walk.glb")[-1]
    assert "22 joints matched, m, Y up, 30 frames a second" in last["found"]
    answered = run(tab, last["source"], prompt="")[-1]["record"]
    given = answered.result.duets[0].a
    assert np.linalg.norm(given.positions - positions, axis=-1).max() < 0.06, "as they are in the file"


def test_two_people_in_a_file_are_a_choice_and_a_long_file_is_cut(tab: ReactTab, walkers: Path) -> None:
    last = upload(tab, walkers)[-1]
    assert last["person"] == gr.update(choices=BOTH, visible=True, value="a")
    assert last["end"] == gr.update(maximum=12.0, value=10.0)
    assert last["player"]["value"]["samples"][0]["frames"] == 300
    source = last["source"]
    line, player = tab.preview(source, "b", 2.0, 5.0)
    assert "2.0 to 5.0 s of 12.0 s" in line
    assert player["value"]["title"] == "walkers.npz, person B"
    assert player["value"]["samples"][0]["frames"] == 90
    assert "1 s or more" in tab.preview(source, "a", 2.0, 2.5)[0]
    assert "10 s or less" in tab.preview(source, "a", 0.0, 12.0)[0]
    assert 'role="alert"' in tab.preview(source, "a", 5.0, 2.0)[0]
    assert all(update == gr.skip() for update in tab.preview(None, "a", 0, 1))


@pytest.mark.parametrize("role", ["a", "b"])
def test_a_run_keeps_the_trimmed_actor_and_ends_with_both_people(
    tab: ReactTab, walkers: Path, role: str
) -> None:
    source = upload(tab, walkers)[-1]["source"]
    steps = run(tab, source, person="b", start=1.0, end=3.0, role=role)
    assert any("step" in step["line"] for step in steps[1:-1])
    last = steps[-1]
    assert last["player"]["value"]["title"] == "they walk"
    assert len(last["player"]["value"]["samples"][0]["roles"]) == 2
    assert "walkers.npz" in last["readouts"]
    duet = last["record"].result.duets[0]
    given = walking(12.0).b.positions[30:90]
    assert duet.people[0 if role == "a" else 1].positions.tobytes() == given.tobytes()


def test_words_may_be_left_out_and_name_nothing_then(tab: ReactTab, walker: Path) -> None:
    record = run(tab, upload(tab, walker)[-1]["source"], prompt="  ")[-1]["record"]
    assert record.prompt == "Reaction to walker_a.bvh"
    _, *buttons = tab.export(record)
    assert any(button["interactive"] for button in buttons)


def test_an_empty_seed_is_drawn(tab: ReactTab, walker: Path) -> None:
    source = upload(tab, walker)[-1]["source"]
    seeds = {run(tab, source, seed=None)[-1]["record"].result.manifest["request"]["seed"] for _ in range(2)}
    assert len(seeds) == 2


@pytest.mark.parametrize("person", ["a", "b"])
def test_a_person_of_the_last_result_is_taken(tab: ReactTab, walker: Path, person: str) -> None:
    record = run(tab, upload(tab, walker)[-1]["source"])[-1]["record"]
    last = [changes(LOADED, updates) for updates in tab.take_result(person, record)][-1]
    assert last["person"] == gr.update(choices=BOTH, visible=True, value=person)
    again = run(tab, last["source"], person=person)[-1]["record"].result.duets[0]
    given = record.result.duets[0].people["ab".index(person)]
    assert again.a.positions.tobytes() == given.positions.tobytes()


def test_without_a_result_there_is_none_to_take(tab: ReactTab) -> None:
    last = [changes(LOADED, updates) for updates in tab.take_result("a", None)][-1]
    assert "There is no result yet" in last["line"]
    assert set(last) == {"line", "player"}


def test_a_cancelled_upload_changes_nothing_and_a_cleared_file_leaves_no_actor(tab: ReactTab) -> None:
    assert list(tab.upload(None)) == []
    left = changes(LOADED, tab.forget())
    assert left["source"] is None
    assert left["player"]["value"] is None
    assert not left["trim"]["visible"]


def test_a_result_of_a_result_keeps_the_name_of_the_file(tab: ReactTab, walker: Path) -> None:
    record = run(tab, upload(tab, walker)[-1]["source"], prompt="")[-1]["record"]
    source = list(tab.take_result("b", record))[-1][0]
    assert run(tab, source, prompt="")[-1]["record"].prompt == "Reaction to walker_a.bvh"


@pytest.mark.parametrize(
    ("name", "content", "sentence"),
    [
        ("broken.bvh", b"HIERARCHY\nROOT hips\n{", "broken.bvh"),
        ("empty.npz", b"", "empty.npz is empty"),
        ("words.npz", b"PK\x03\x04 nothing", "not a whole .npz"),
        ("robot.glb", glb_character(), "robot.glb has no animation"),
        ("movie.mov", b"123", "cannot be read: use .npz, .bvh, .npy, .skeleton, .txt or .glb"),
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
    assert last["source"] is None and not last["trim"]["visible"]


@pytest.mark.parametrize(
    ("changed", "sentence"),
    [
        ({"source": None}, "There is no actor yet"),
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
    source = upload(tab, walker)[-1]["source"]
    last = run(tab, **{"source": source, **changed})[-1]
    assert sentence in last["line"]
    assert 'role="alert"' in last["line"]
    assert "record" not in last
    assert "record" in run(tab, source)[-1]


def test_cancel_ends_within_one_step(tab: ReactTab, walker: Path) -> None:
    source = upload(tab, walker)[-1]["source"]
    tab.page.engine.pause = 0.1
    updates = tab.run("me", {"source": source, **FIELDS, "steps": 50})
    for _ in range(5):
        next(updates)
    assert tab.page.runs.cancel("me")
    last = [changes(tab.outputs, update) for update in updates][-1]
    assert "Cancelled at step" in last["line"]
    assert tab.page.engine.steps_done < 10


def test_examples_are_the_files_of_a_folder(tab: ReactTab, tmp_path: Path) -> None:
    assert example_clips(tmp_path / "none") == []
    (path,) = write(walking(3.0), tmp_path / "reach-out.npz")
    examples = example_clips(tmp_path)
    assert examples == [("Reach out", path)]
    page = ReactTab(tab.page, examples)
    with gr.Blocks() as demo:
        page.build(demo)
    assert [chip.value for chip in page.chips] == ["Reach out"]
    click = next(fn for fn in demo.fns.values() if (page.chips[0]._id, "click") in fn.targets)
    last = changes(LOADED, list(click.fn())[-1])
    assert last["source"].name == "Reach out"


@pytest.mark.parametrize(
    ("method", "model", "mode", "steps"),
    [
        ("intergen", "intergen", "offline", 50),
        ("regennet", "regennet", "offline", 5),
        ("regennet-online", "regennet", "online", 5),
    ],
)
def test_a_method_is_a_model_and_a_mode(
    tab: ReactTab, walker: Path, method: str, model: str, mode: str, steps: int
) -> None:
    source = upload(tab, walker)[-1]["source"]
    run(tab, source, method=method)
    asked = tab.page.engine.requests[-1]
    assert (asked.model, asked.mode) == (model, mode)
    role, steps_slider, _, damping, *_ = tab.fit_method(method)
    assert steps_slider["value"] == steps
    assert role["interactive"] is (model == "intergen")
    assert damping["interactive"] is (mode == "offline")


def test_the_steps_of_every_method_can_be_set(tab: ReactTab) -> None:
    """A value outside of the slider's range is refused by the page before the job begins."""
    for method in variants("react"):
        steps = tab.fit_method(method)[1]
        assert tab.steps.minimum <= steps["value"] <= tab.steps.maximum, method


def test_the_second_person_can_begin_as_the_files_other_stands(
    tab: ReactTab, walkers: Path, walker: Path
) -> None:
    source = upload(tab, walkers)[-1]["source"]
    run(tab, source, method="regennet", person="b", start=1.0, end=3.0, keep=True)
    asked = tab.page.engine.requests[-1]
    assert np.allclose(asked.first_pose, walking(12.0).a.positions[30], atol=2e-3)
    for changed in ({"keep": False}, {"keep": True, "method": "intergen"}):
        run(tab, source, **{"method": "regennet", "person": "b", "start": 1.0, "end": 3.0, **changed})
        assert tab.page.engine.requests[-1].first_pose is None
    alone = upload(tab, walker)[-1]["source"]
    assert "does not hold two people" in run(tab, alone, method="regennet", keep=True)[-1]["line"]


def test_how_a_file_was_read_is_shown_and_can_be_changed(tab: ReactTab, walker: Path) -> None:
    last = upload(tab, walker)[-1]
    assert "22 joints matched, m, Y up, 30 frames a second" in last["found"]
    assert "left_wrist" in last["found"]
    *_, again = [changes(READ, u) for u in tab.read_again(last["source"], "auto", "auto", 60)]
    assert "60 frames a second" in again["found"]
    assert again["source"].seconds == pytest.approx(2.0, abs=0.1)
    *_, wrong = [changes(READ, u) for u in tab.read_again(again["source"], "auto", "auto", 5000)]
    assert "not possible" in wrong["line"] and "source" not in wrong
    assert (wrong["up"], wrong["fps"]) == ("auto", 60), "the choices are again those that it was read with"


def test_a_method_says_what_it_cannot_do(tab: ReactTab, walker: Path) -> None:
    source = upload(tab, walker)[-1]["source"]
    *_, last = run(tab, source, method="regennet", role="b")
    assert "choose role a" in last["line"]


def test_two_methods_stand_side_by_side(tab: ReactTab, walker: Path) -> None:
    source = upload(tab, walker)[-1]["source"]
    steps = run(tab, source, method="intergen", other="regennet-online", steps=20, samples=2, prompt="")
    assert any("ReGenNet, online. Generating: frame" in step.get("line", "") for step in steps)
    first, second = tab.page.engine.requests[-2:]
    assert (first.model, first.steps, second.model, second.mode, second.steps) == (
        "intergen", 20, "regennet", "online", 5,
    )  # fmt: skip
    assert first.seed == second.seed
    assert first.actor.positions.tobytes() == second.actor.positions.tobytes()
    last = steps[-1]
    samples = last["player"]["value"]["samples"]
    assert [(s["caption"], s["beside"]["caption"]) for s in samples] == [
        ("InterGen, person to person", "ReGenNet, online")
    ] * 2
    assert [curve["label"] for curve in samples[0]["curves"]] == ["Apart, left", "Apart, right"]
    for head in ("InterGen, person to person, 2", "ReGenNet, online, 1"):
        assert head in last["readouts"]
    _, *buttons = tab.export(last["record"])
    with zipfile.ZipFile(buttons[0]["value"]) as archive:
        assert [re.sub("-[0-9a-f]{4}-", "-", name) for name in sorted(archive.namelist())] == [
            f"{method}-reaction-to-walker-a-bvh-seed3-{i}.npz"
            for method in ("intergen", "regennet-online")
            for i in (1, 2)
        ]


def test_a_method_is_not_compared_with_itself_and_roles_fit_both(tab: ReactTab, walker: Path) -> None:
    source = upload(tab, walker)[-1]["source"]
    last = run(tab, source, method="intergen", other="intergen")[-1]
    assert "choose another one" in last["line"]
    assert tab.fit_method("intergen", "regennet")[0]["interactive"] is False
    assert tab.fit_method("intergen", "")[0]["interactive"] is True


def test_streamed_frames_come_in_small_messages_and_end_in_a_result(tab: ReactTab, walker: Path) -> None:
    source = upload(tab, walker)[-1]["source"]
    began = time.monotonic()
    steps = run(tab, source, stream=True, end=2.0, samples=4, prompt="")
    assert time.monotonic() - began > 1.9, "the actor plays in real time"
    opening = next(step["player"]["value"] for step in steps if "value" in step.get("player", {}))
    assert opening["live"]
    assert opening["samples"][0]["positions"]["shape"] == [1, 60, 22, 3]
    messages = [step["player"]["live"] for step in steps if step.get("player", {}).get("live")]
    assert len(messages) == 10
    streaming = [step["player"] for step in steps if "live" in step.get("player", {})]
    assert all(player["value"] is opening for player in streaming), "the first of several may be lost"
    seen = np.full((60, 22, 3), np.nan)
    for message in messages:
        assert message["id"] == opening["id"]
        part = unpack_positions(message["frames"])[0]
        assert len(part) <= BATCH + REPEATED
        seen[message["start"] : message["start"] + len(part)] = part
    result = steps[-1]["record"].result
    np.testing.assert_allclose(seen, result.duets[0].b.positions, atol=1e-3)
    assert steps[-1]["player"]["value"]["continues"] == opening["id"]
    assert "longest" in steps[-1]["line"]
    asked = tab.page.engine.requests[-1]
    assert (asked.model, asked.mode, asked.samples, asked.steps) == ("regennet", "online", 1, 5)


def test_a_streamed_reaction_that_is_cancelled_tells_the_player(tab: ReactTab, walker: Path) -> None:
    source = upload(tab, walker)[-1]["source"]
    fields = {"source": source, **FIELDS, "stream": True}
    seen: list[dict[str, Any]] = []
    for updates in tab.run("me", fields):
        seen.append(changes(tab.outputs, updates))
        if len(seen) == 5:
            tab.page.runs.cancel("me")
    assert seen[-2]["player"]["live"]["stop"]
    assert "Cancelled at frame" in seen[-1]["line"]
    assert "record" not in seen[-1]


def test_a_live_request_is_online() -> None:
    actor = walking(2.0).a
    with pytest.raises(InputError, match="online"):
        LiveRequest(actor=actor, model="regennet", mode="offline")
    live = LiveRequest(actor=actor, model="regennet", steps=5)
    plain = ReactRequest(actor=actor, model="regennet", steps=5, mode="online")
    assert live.to_dict() == plain.to_dict(), "its manifest reproduces the same motion"


def test_one_of_more_than_two_people_is_chosen(tab: ReactTab, tmp_path: Path) -> None:
    path = tmp_path / "three.npz"
    people = np.concatenate([walking(3.0).positions, walking(3.0, 5).positions[:1]])
    np.savez(path, positions=people, fps=30)
    last = upload(tab, path)[-1]
    assert [letter for _, letter in last["person"]["choices"]] == ["a", "b", "c"]
    assert "3 people" in last["found"]
    result = run(tab, last["source"], person="c")[-1]["record"].result
    assert result.duets[0].a.positions.tobytes() == people[2].tobytes()


def test_the_order_of_fifteen_joints_is_found_and_can_be_set(tab: ReactTab, tmp_path: Path) -> None:
    joints = [max(joint, 0) for joint in LAYOUTS["k3hi15"].joints]
    path = tmp_path / "fifteen.npy"
    np.save(path, walking(3.0).a.positions[:, joints])
    last = upload(tab, path)[-1]
    assert "in the order of K3HI" in last["found"]
    *_, again = [changes(READ, u) for u in tab.read_again(last["source"], "auto", "auto", None, "sbu15")]
    assert "in the order of SBU" in again["found"]


def test_an_opened_run_brings_back_its_file_its_person_and_its_part(tab: ReactTab) -> None:
    pair = walking(3.0)
    request = ReactRequest(actor=replace(pair.b.cut(15, 75), name="sub/ject 1.bvh"), steps=1)
    *_, result = tab.page.engine.run(request)
    entry = Entry(id="x", kind="react", title="t", state="done", request=request.to_dict())
    kept = Kept(controls={"person": "b", "start": 0.5, "end": 2.5}, people=pair.people)
    found = tab.opened(Opened(entry=entry, result=result, kept=kept))
    assert found[tab.person] == gr.update(choices=BOTH, visible=True, value="b")
    assert (found[tab.begin]["value"], found[tab.end]["value"]) == (0.5, 2.5)
    assert Path(found[tab.file]).name == "ject-1.npz"
    restored = read(found[tab.file])
    np.testing.assert_allclose(restored.positions, pair.positions, atol=1e-6)
    by_link = tab.opened(Opened(entry=entry, result=result, kept=Kept(controls={"person": "x"})))
    assert by_link[tab.file] is None and by_link[tab.begin]["value"] == 0.0
    wrong = tab.opened(Opened(entry=entry, result=result, kept=replace(kept, controls={"person": ["b"]})))
    assert wrong[tab.person]["value"] == "a", "a workspace made by hand"


def test_an_opened_run_brings_back_the_very_file_that_was_uploaded(tab: ReactTab, walker: Path) -> None:
    source = upload(tab, walker)[-1]["source"]
    *_, last = run(tab, source)
    result = last["record"].result
    entry = Entry(id="x", kind="react", title="t", state="done", request=result.manifest["request"])
    original = Original(walker, "my walk.bvh")
    kept = Kept(controls={"up": "y", "unit": "cm", "fps": 60.0}, people=source.people, original=original)
    found = tab.opened(Opened(entry=entry, result=result, kept=kept))
    assert Path(found[tab.file]).name == "my walk.bvh"
    assert Path(found[tab.file]).read_bytes() == walker.read_bytes()
    assert [found[part] for part in (tab.up, tab.unit, tab.fps, tab.order)] == ["y", "cm", 60.0, "auto"]
    assert "not kept" not in found[tab.line] and "read the file anew" in found[tab.found]
    *_, again = [changes(READ, u) for u in tab.read_again(found[tab.source], "auto", "m", None)]
    assert again["source"].people[0].num_frames == source.people[0].num_frames
    for gone in (None, Original(walker.with_name("gone.bvh"), "my walk.bvh")):
        found = tab.opened(Opened(entry=entry, result=result, kept=replace(kept, original=gone)))
        assert Path(found[tab.file]).suffix == ".npz"
        assert "was not kept with this run" in found[tab.line] and walker.name in found[tab.line]


def test_an_upload_is_kept_with_its_run_and_an_example_is_not(
    tab: ReactTab, walker: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    told: list[Kept] = []
    history: Any = SimpleNamespace(keep=lambda run, owner, kept: told.append(kept))
    monkeypatch.setattr(tab, "page", replace(tab.page, history=history))
    source = upload(tab, walker)[-1]["source"]
    *_, last = run(tab, replace(source, read_with=("y", "auto", None, "auto")))
    record = last["record"]
    tab._keep(replace(record, result=replace(record.result, run="x")), {"source": source})
    assert told[-1].original == Original(walker, walker.name)
    assert told[-1].controls["up"] == "auto"
    name, path = example_clips()[0]
    *_, shown = [changes(LOADED, u) for u in tab.load(lambda: read_source(path, name))]
    tab._keep(replace(record, result=replace(record.result, run="x")), {"source": shown["source"]})
    assert clean_name(told[-1].original.name if told[-1].original else "") == ""


def test_a_partner_is_taken_on_the_rig_of_an_uploaded_bvh(tab: ReactTab, tmp_path: Path) -> None:
    rig = tmp_path / "my rig.bvh"
    positions, rotations = marching(90)
    rig.write_text(bvh_text(rotations, positions[:, 0], RIGS["mixamo"]), encoding="utf-8")
    source = upload(tab, rig)[-1]["source"]
    *_, last = run(tab, source, end=2.0, samples=2)
    assert last["record"].rig == rig
    _, *updates = tab.export(last["record"])
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
    _, *updates = tab.export(last["record"])
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
    assert rig_of(None) is None and rig_of(replace(source, read_with=("z", "auto", None, "auto"))) is None
    assert rig_of(upload(tab, walkers)[-1]["source"]) is None
    *_, last = run(tab, replace(source, path=None), end=2.0)
    _, *updates = tab.export(last["record"])
    update = updates[[kind.key for kind in KINDS].index("rig")]
    assert not update["visible"] and update["value"] is None


def test_a_rig_that_cannot_be_moved_is_a_sentence_and_the_other_files_are_there(
    tab: ReactTab, walker: Path
) -> None:
    *_, last = run(tab, upload(tab, walker)[-1]["source"], end=2.0)
    last["record"].rig = walker.with_name("gone.bvh")
    line, *updates = tab.export(last["record"])
    assert "not on the rig of your file. gone.bvh cannot be read" in line
    assert updates[0]["interactive"]
