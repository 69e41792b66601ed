"""Acts in German: on chips, in the notes of a result and in its description."""

from __future__ import annotations

from typing import Any

import pytest

from acts import Act, read
from acts.captions import short
from motion import Duet
from tests.ui.stub_engine import walking
from webdemo.inference.requests import GenerateRequest, Result
from webdemo.inference.verdicts import judged, note
from webdemo.ui.components.notebook import settings
from webdemo.ui.components.notebook import shown as notebook_shown
from webdemo.ui.components.reading import checked, known_acts, reread
from webdemo.ui.components.show import result_payload
from webdemo.ui.history import Entry, Found
from webdemo.ui.text.panels import notes_lines, readout_panel
from webdemo.ui.text.said_acts import said_act

PROMPT = (
    "They hug. Then the first one pats the other on the right shoulder twice, and the other waves slowly."
)


def _act(name: str, agents: str = "a", **fields: Any) -> Act:
    return Act(id="1", act=name, agents=tuple(agents), **fields)


@pytest.mark.parametrize(
    "act, words",
    [
        (_act("shake-hands", "ab"), "schütteln sich die Hand"),
        (_act("shake-hands", "b"), "schüttelt A die Hand"),
        (_act("pat", part="shoulder", side="right", times=2), "klopft B auf die rechte Schulter ×2"),
        (_act("raise-arm", side="both"), "hebt beide Arme"),
        (_act("throw-ball", thing="apple", manner=("gently",)), "wirft B einen Apfel zu, sanft"),
        (_act("hand-over", thing="zorb"), "gibt B „zorb“"),
        (_act("kiss", part="cheek"), "küsst B, Wange"),
        (_act("wave", side="left"), "winkt, links"),
        (_act("turn-around", side="left", direction="left"), "dreht sich um, nach links"),
        (_act("lean", direction="forward", manner=("then",)), "neigt sich, nach vorn"),
        (_act("wave", polarity="not"), "nicht: winkt"),
        (_act("hug", modality="tried"), "versucht: umarmt B"),
        (_act("walk-up", "ab", direction="up"), "gehen aufeinander zu"),
        (_act("a-lab-s-own"), "a lab s own"),
    ],
)
def test_an_act_is_german(german: None, act: Act, words: str) -> None:
    assert said_act(act) == words


def test_an_act_is_english_where_the_page_is() -> None:
    for act in read(PROMPT).acts:
        assert "hug" in said_act(act) or said_act(act).split()[0] in ("pats", "waves")
    assert said_act(_act("nothing-known")) == short(_act("nothing-known"), None)


def test_the_reading_is_german(german: None) -> None:
    shown = reread({"text": f"{PROMPT} The zorb blorps.", "number": 1})["shown"]
    assert list(shown["said"].values()) == [
        "umarmen sich", "klopft B auf die rechte Schulter ×2", "winkt, langsam",
    ]  # fmt: skip
    assert shown["whys"] and all("nicht" in why or "keine" in why for why in shown["whys"])
    assert "known" in shown["plan"]["unread"][0]["why"], "the plan itself is as programs have it"
    assert "In diesem Text" in reread({"text": "?!", "number": 2})["shown"]["notes"][0]


def test_the_list_of_acts_is_german(german: None) -> None:
    listed = {act["name"]: act["said"] for act in known_acts()}
    assert listed["shake-hands"] == "schüttelt B die Hand"
    assert listed["stand-up"] == "steht auf"


@pytest.fixture
def result() -> Result:
    """Of two people who hug in words alone: some of it is not seen."""
    request = GenerateRequest(prompt=PROMPT, seconds=6.0)
    made = judged(request, Result(duets=(walking(6.0),), manifest={"request": request.to_dict()}))
    assert isinstance(made.result.duets[0], Duet)
    return Result(
        duets=made.result.duets,
        manifest=made.result.manifest,
        notes=(note(made.rows),),
        timings={"total": 1.0},
    )


def test_the_notes_of_a_result_name_its_acts_in_german(german: None, result: Result) -> None:
    line = notes_lines(result)
    assert "Nicht zu sehen: A und B umarmen sich" in line
    assert "A klopft B auf die rechte Schulter ×2" in line
    assert "hug" not in line and "hand" not in line
    assert "pd-warning" in line, "the tone is that of the English note"


def test_the_description_of_a_result_is_german(german: None, result: Result) -> None:
    told = result_payload(result)["samples"][0]["told"]
    assert "Nicht zu sehen:" in told and "umarmen sich" in told
    assert "hug" in result.manifest["told"], "the result itself stays English"


def test_the_marks_of_a_result_are_german(german: None, result: Result) -> None:
    found = checked(PROMPT, read(PROMPT), result.manifest)
    assert found is not None
    measures = [act["measure"] for act in found["acts"]]
    assert any("auseinander" in measure for measure in measures), measures
    assert not any("apart" in measure or "hand " in measure for measure in measures)


def test_read_outs_are_english_without_a_page(result: Result) -> None:
    assert "Done" in result.notes[0] or "Not seen" in notes_lines(result)
    assert "All figures" in readout_panel(result)


def test_a_study_compares_by_the_same_settings_in_every_language(german: None) -> None:
    request = {"kind": "react", "model": "regennet", "seed": 3, "steps": 5}
    entry = Entry(id="1", kind="react", title="Both wave.", state="done", request=request)
    assert dict(settings(entry))["Seed"] == "3"
    shown = notebook_shown(Found(entries=(entry,), total=1), empty="")["entries"][0]
    assert ["Startwert", "3"] in shown["settings"]
    assert "Startwert 3" in shown["facts"]
