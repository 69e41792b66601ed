"""What the handlers of the tab Generate do, without a browser."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from motion import InputError
from tests.ui.stub_engine import StubEngine
from tests.ui.stub_page import stub_context
from tests.ui.tab_events import built, changes
from tests.ui.tabs.generating import FIELDS, result_of, run
from webdemo.inference.requests import GenerateRequest
from webdemo.server.http.health import Health
from webdemo.ui.history import Entry, Kept, Opened
from webdemo.ui.page import build_page, watch_loading
from webdemo.ui.tabs.generate import GenerateTab
from webdemo.ui.tabs.sampling import FAITHFUL, FAST


@pytest.fixture
def tab(tmp_path: Path) -> GenerateTab:
    return built(GenerateTab, tmp_path)


def test_a_run_ends_with_a_motion_readouts_and_a_record(tab: GenerateTab) -> None:
    steps = run(tab)
    assert steps[0]["go"]["interactive"] is False
    assert steps[0]["stop"]["interactive"] is True
    assert [button["interactive"] for button in tab.rest(None, [])[:3]] == [True, True, False]
    last = steps[-1]
    assert last["player"]["value"]["title"] == "two people walk"
    assert last["player"]["busy"] == ""
    assert "Foot skate" in last["readouts"]
    assert last["record"].result.manifest["request"]["seed"] == 3


def test_a_class_is_asked_for_in_place_of_a_sentence(tab: GenerateTab) -> None:
    last = run(tab, model="bigraphdiff", class_name="shake hands")[-1]
    assert last["player"]["value"]["title"] == "shake hands"
    assert last["record"].result.manifest["request"]["model"] == "bigraphdiff"
    unchosen = run(tab, model="bigraphdiff", class_name=None)[-1]
    assert "No class is chosen" in unchosen["line"] and "record" not in unchosen
    for way, sentence in (("intergen", True), ("bigraphdiff", False)):
        words, labels, guidance, steps, *settings = tab.asked_by(way)
        assert steps["value"] == (FAST if sentence else FAITHFUL)
        assert ("pd-off" in words["elem_classes"], labels["visible"]) == (not sentence, not sentence)
        assert [update["visible"] for update in settings] == [sentence] * 3, "a class has no plan, nor acts to try for"
        assert guidance["value"] == GenerateRequest(prompt="x").guidance if sentence else guidance["value"] < 4


def test_cancel_ends_within_one_step_and_touches_no_result(tab: GenerateTab) -> None:
    engine = tab.page.engine
    engine.pause = 0.15
    updates = tab.run("me", {**FIELDS, "steps": 50})
    seen = [changes(tab.outputs, next(updates)) for _ in range(5)]
    assert tab.page.runs.cancel("me")
    rest = [changes(tab.outputs, update) for update in updates]
    done = engine.steps_done
    assert done < 10
    assert "Cancelled at step" in rest[-1]["line"]
    assert "of 50" in rest[-1]["line"]
    assert "record" not in rest[-1]
    assert "readouts" not in rest[-1]
    assert "step" in seen[-1]["line"]
    assert not tab.page.runs.cancel("me"), "nothing is left to cancel"


def test_a_run_is_cancelled_before_its_request_was_read(tab: GenerateTab) -> None:
    steps = tab.run("me", FIELDS)
    next(steps)
    tab.cancel(SimpleNamespace(session_hash="me"))
    assert "Cancelled before the first step." in changes(tab.outputs, list(steps)[-1])["line"]
    assert tab.page.engine.steps_done == 0
    assert "record" in run(tab)[-1], "the next run goes on"


@pytest.mark.parametrize(
    ("changed", "sentence"),
    [
        ({"prompt": "   "}, "The prompt is empty"),
        ({"seconds": 100.0}, "Length must be from 1 to 10 seconds"),
        ({"guidance": float("nan")}, "Guidance scale must be a number"),
        ({"samples": 99}, "Samples must be from 1 to 8"),
        ({"prompt": "impossible"}, "The stub cannot do this"),
        ({"prompt": "crash"}, "Something went wrong inside the program (RuntimeError)"),
    ],
)
def test_errors_are_one_sentence_and_the_next_run_works(
    tab: GenerateTab, changed: dict[str, Any], sentence: str
) -> None:
    last = run(tab, **changed)[-1]
    assert sentence in last["line"]
    assert 'role="alert"' in last["line"]
    assert last["player"]["busy"] == ""
    assert "record" not in last
    assert "record" in run(tab)[-1]


def test_an_empty_seed_is_drawn_and_shown(tab: GenerateTab) -> None:
    class Visit:
        session_hash = "me"

    seeds = set()
    for _ in range(2):
        fields = {**FIELDS, "seed": None, "class_name": None, "acts": None}
        steps = tab.start({part: fields.get(name, part.value) for name, part in tab.controls.items()}, Visit())
        last = [changes(tab.outputs, step) for step in steps][-1]
        seed = last["record"].result.manifest["request"]["seed"]
        assert f"<dd>{seed}</dd>" in last["readouts"]
        seeds.add(seed)
    assert len(seeds) == 2


def test_loading_is_shown_until_it_is_done_or_failed() -> None:
    engine = StubEngine(load=0.2)
    marks = list(watch_loading(engine, Health(engine), interval=0.02))
    assert "Loading model" in marks[0]
    assert "Model ready" in marks[-1]

    class Broken(StubEngine):
        def warm_up(self) -> None:
            raise InputError("The weights file is missing: run the download again.")

    engine = Broken(load=1)
    marks = list(watch_loading(engine, Health(engine), interval=0.02))
    assert "The weights file is missing" in marks[-1]


def test_build_page_offers_an_endpoint_a_job(tmp_path: Path) -> None:
    demo = build_page(stub_context(StubEngine(), tmp_path))
    demo.config = demo.get_config_file()  # as it is mounted
    offered = "/predict /generate /generate_class /react /render /scene /read"
    assert list(demo.get_api_info()["named_endpoints"]) == offered.split()


def test_words_become_paths_unless_that_is_switched_off(tab: GenerateTab) -> None:
    for planned in (True, False):
        last = run(tab, planned=planned)[-1]
        assert last["record"].result.manifest["request"]["planned"] is planned
        assert f"Plan from the words</dt><dd>{'on' if planned else 'off'}<" in last["readouts"]
        assert ("fixes 60 %" if planned else "The network makes all") in last["laid"]


@pytest.mark.parametrize(
    ("changed", "planned"),
    [
        ({}, True),
        ({"planned": False}, False),
        ({"planned": None}, False),
        ({"planned": None, "model": "bigraphdiff"}, True),
    ],
)
def test_a_kept_run_opens_with_paths_from_words_as_it_was_made(
    tab: GenerateTab, changed: dict[str, Any], planned: bool
) -> None:
    result = result_of(tab).result
    asked = {**result.manifest["request"], **changed}
    asked = {name: value for name, value in asked.items() if value is not None}
    entry = Entry(id="x", kind="generate", title="t", state="done", request=asked)
    found = tab.opened(Opened(entry=entry, result=result, kept=Kept(controls={"planned": not planned})))
    assert found[tab.planned]["value"] is planned
    of_sentences = (tab.planned, tab.sampling.strictness, tab.sampling.tries)
    assert {found[part]["visible"] for part in of_sentences} == {"model" not in changed}


def test_an_edited_plan_is_made_in_place_of_its_sentence(tab: GenerateTab) -> None:
    plan = json.dumps({"acts": [{"id": "1", "act": "hug", "agents": ["a", "b"]}]})
    fields = {"prompt": "They bow.", "model": "intergen", "class_name": None}
    sent = {"text": "They bow.", "plan": plan}
    request = tab.request({**fields, "acts": sent})
    assert request.acts is not None and [act.act for act in request.acts.acts] == ["hug"]
    assert tab.request({**fields, "acts": {**sent, "text": "They wave."}}).acts is None, "the plan of another sentence"
    assert tab.request({**fields, "acts": None}).acts is None
    with pytest.raises(InputError, match="not followed"):
        tab.request({**fields, "planned": False, "acts": sent})
    with pytest.raises(InputError, match="no act"):
        tab.request({**fields, "acts": {**sent, "plan": plan.replace("hug", "levitate")}})


def test_a_kept_run_opens_with_its_own_plan(tab: GenerateTab) -> None:
    acts = {"acts": [{"id": "7", "act": "hug", "agents": ["a", "b"]}]}
    by_hand = {**acts, "reader": "hand"}
    for asked, said, edited in (
        ({"acts": by_hand}, {"7": "hug each other"}, True),
        ({"acts": acts}, {"7": "hug each other"}, False),  # as earlier versions kept them
        ({}, {"1": "wave"}, False),
    ):
        result = result_of(tab).result
        request = {**result.manifest["request"], "prompt": "They wave.", **asked}
        entry = Entry(id="x", kind="generate", title="t", state="done", request=request)
        result = replace(result, manifest={**result.manifest, "request": request})
        found = tab.opened(Opened(entry=entry, result=result, kept=Kept(controls={})))
        shown = found[tab.reading]["shown"]
        assert (shown["said"], shown["edited"], shown["number"]) == (said, edited, None)
