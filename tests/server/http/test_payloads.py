"""What the components of the page may send, and whose files."""

from __future__ import annotations

import json
import time
from typing import Any

import gradio as gr
import numpy as np
import pytest
from fastapi.testclient import TestClient
from gradio.blocks import Blocks
from gradio.routes import App
from starlette.routing import Mount

from acts import Act
from tests.ui.stub_engine import walking
from webdemo.inference.story import Beat, FloorPath, FloorPoint, Pose
from webdemo.server.http import payloads
from webdemo.server.http.payloads import Payloads, check_value
from webdemo.server.http.routes import Refused
from webdemo.ui.components.notebook import Action, NotebookView
from webdemo.ui.components.reading import Reading
from webdemo.ui.components.story import StoryLine, story_fields, story_value

FILE = {"path": "/uploads/ada/x.glb", "meta": {"_type": "gradio.FileData"}}
STORY: dict[str, Any] = json.loads(
    json.dumps(
        story_value(
            (
                Beat("They bow.", a="waves", b="nods", seconds=2.0, seed=3),
                Beat("They hug.", acts=(Act(id="1", act="hug", agents=("a", "b")),)),
            ),
            (FloorPath("a", (FloorPoint(0.0, 1.0, 0.0, 90.0), FloorPoint(1.0, 1.0))),),
            (Pose("b", 0.5, np.asarray(walking(1.0).b.positions[0])),),
        )
        | {"span": [0.5, 2], "ahead": True}
    )
)
ACTION = {
    "act": "search",
    "ids": ["r1"],
    "limit": None,
    "search": {"words": "", "kind": "", "model": "", "tag": "", "starred": False},
}
DESCRIBED = ACTION | {"act": "describe", "title": "A bow", "tags": "x, y", "note": ""}
TYPICAL: dict[type, Any] = {
    gr.Textbox: "They bow.",
    gr.Number: 3,
    gr.Slider: 2.5,
    gr.Checkbox: True,
    gr.Radio: 8,
    gr.Dropdown: "intergen",
    gr.State: None,
    gr.File: FILE | {"orig_name": "x.glb", "size": 12, "url": "http://127.0.0.1/x", "is_stream": False},
    StoryLine: STORY,
    Reading: {"text": "They bow.", "plan": "{}", "number": 3},
}
EVENTS: dict[type, tuple[Any, ...]] = {NotebookView: (ACTION, DESCRIBED)}


def deep(value: Any) -> Any:
    """A value inside of ten thousand lists."""
    for _ in range(10_000):
        value = [value]
    return value


FORGED = (
    *({"value": FILE}, [[FILE]], {"beats": [FILE]}, {"beats": [{"words": FILE}]}, STORY | {"more": FILE}, STORY | FILE),
    *(STORY | {"span": [FILE]}, {"poses": [{"person": "a", "seconds": 0, "positions": [[FILE]]}]}),
    *(
        {"meta": FILE["meta"], "path": "/etc/passwd"},
        FILE | {"more": FILE},
        {"path": "/uploads/ada/x.glb", "url": FILE},
    ),
    *(float("nan"), float("inf"), -float("inf"), 10**400, {"span": [float("nan")]}, [float("inf")], {}, [[]]),
    *(deep(1), {"a": deep(1)}, STORY | {"beats": {"0": "They bow."}}, "\x00" * 3),
)


@pytest.fixture
def page(local: TestClient) -> Blocks:
    """The page that the server serves."""
    (mounted,) = [r.app for r in local.app.routes if isinstance(r, Mount) and isinstance(r.app, App)]
    return mounted.get_blocks()


@pytest.fixture(autouse=True)
def uploads(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(payloads, "owns", lambda person, path: path == f"/uploads/{person}/x.glb")


def passes(value: Any, component: Any) -> bool:
    try:
        check_value(value, component, "ada")
    except Refused:
        return False
    return True


def inputs(page: Blocks) -> dict[int, Any]:
    """Every component whose value some function of the server takes."""
    return {block._id: block for fn in page.fns.values() if fn.fn is not None for block in fn.inputs}


def test_every_component_sends_its_own_value_and_a_typical_one(page: Blocks) -> None:
    found = inputs(page)
    assert len(found) > 150 and any(isinstance(each, StoryLine) for each in found.values())
    for component in found.values():
        own = None if isinstance(component, gr.State) else getattr(component, "value", None)
        kind = next((k for k in type(component).__mro__ if k in TYPICAL), None)
        typical = TYPICAL[kind] if kind is not None else "a text"  # the panels of films and streams send texts
        if isinstance(component, gr.File) and component.file_count != "single":
            typical = [typical]
        for value in (own, typical) if kind is gr.Slider else (None, own, typical):
            assert passes(value, component), (component.label, type(component), value)


def test_no_component_takes_what_is_forged(page: Blocks) -> None:
    for component in inputs(page).values():
        for value in FORGED:
            if isinstance(value, str) and isinstance(component, gr.Textbox | gr.HTML | gr.Dropdown | gr.Radio):
                continue  # a text is a text
            if value == {} and isinstance(component, StoryLine | Reading):
                continue  # a story without anything, or no text
            assert not passes(value, component), (component.label, type(component), repr(value)[:100])


def test_no_component_without_files_takes_a_file_even_ones_own(page: Blocks) -> None:
    for component in inputs(page).values():
        files = isinstance(component, gr.File)
        several = files and component.file_count != "single"
        for value in (FILE, [FILE], FILE | {"orig_name": "x.glb"}):
            right = several if isinstance(value, list) else files and not several
            assert passes(value, component) == right, (component.label, type(component))
        assert not passes(FILE | {"path": "/uploads/eve/x.glb"}, component)
        assert not passes([FILE, FILE | {"path": "/etc/passwd"}], component)


def test_the_data_of_events_is_what_the_component_sends(page: Blocks) -> None:
    calls = Payloads(page)
    collecting = {number: fn for number, fn in page.fns.items() if fn.collects_event_data}
    assert collecting
    for number, fn in collecting.items():
        data = [None for _ in fn.inputs]
        for target, _ in fn.targets:
            for typical in EVENTS[type(page.blocks[target])]:
                body = {"fn_index": number, "data": data, "event_data": typical}
                calls.check(body, None, "ada")
                Action.read(typical)
                for forged in (
                    *FORGED[:-1],
                    typical | {"more": 1},
                    typical | {"title": FILE},
                    {**typical, "ids": [FILE]},
                ):
                    with pytest.raises(Refused):
                        calls.check(body | {"event_data": forged}, None, "ada")


def test_a_story_is_taken_by_the_server_again_and_again(local: TestClient, page: Blocks) -> None:
    """Gradio sends a component's last value with the next event, so that the second press held a story."""
    takes_story = [n for n, fn in page.fns.items() if fn.fn and any(isinstance(each, StoryLine) for each in fn.inputs)]
    assert len(takes_story) > 5
    assert story_fields(STORY)["beats"]
    for number in takes_story:
        data = [
            STORY if isinstance(each, StoryLine) else getattr(each, "value", None) for each in page.fns[number].inputs
        ]
        body = {"fn_index": number, "data": data, "session_hash": "an afternoon", "trigger_id": None}
        for _ in range(2):
            answer = local.post("/gradio_api/queue/join", json=body)
            assert answer.status_code == 200, answer.text


def test_a_call_names_the_senders_own_upload_alone() -> None:
    with gr.Blocks() as page:
        part = gr.File()
        part.upload(lambda file: None, inputs=part)
    calls = Payloads(page)
    calls.check({"fn_index": 0, "data": [FILE]}, None, "ada")
    for person, value in (("eve", FILE), ("ada", {"path": "/etc/passwd"}), ("ada", "/uploads/ada/x.glb"), ("ada", {})):
        with pytest.raises(Refused, match="must be uploaded"):
            calls.check({"fn_index": 0, "data": [value]}, None, person)


def test_a_call_with_too_few_values_is_told_how_many_there_are() -> None:
    """It comes from a program that was written for an older server."""
    with gr.Blocks() as page:
        gr.Button().click(lambda *_: None, inputs=[gr.Textbox(), gr.Number(), gr.State()])
    calls = Payloads(page)
    calls.check({"fn_index": 0, "data": ["They bow.", 3]}, None, "ada", brief=True)
    for data in ([], ["They bow."]):
        with pytest.raises(Refused, match=f"has {len(data)} values and takes 2: see /gradio_api/info"):
            calls.check({"fn_index": 0, "data": data}, None, "ada", brief=True)
    with pytest.raises(Refused, match="has 2 values and takes 3"):
        calls.check({"fn_index": 0, "data": ["They bow.", 3]}, None, "ada")


def test_a_long_text_holds_nobody_up() -> None:
    """It is looked through on the event loop, where each letter by itself took a third of a second of everybody's."""
    checked = Payloads(Blocks())
    began = time.thread_time()
    checked.check({"data": None, "session_hash": "é" * 900_000}, None, "ada")
    assert time.thread_time() - began < 0.04
