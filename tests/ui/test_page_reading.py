"""What the page shows of how a prompt is understood."""

from __future__ import annotations

import json
import re
from typing import Any

import pytest

from acts import Act, Plan, Span, Unread, read
from motion import InputError
from webdemo.ui.components.reading import checked, edited_plan, reread, shown
from webdemo.ui.text.texts import say


def of(text: Any) -> dict[str, Any]:
    """What is shown for a text that the browser sent."""
    return reread({"text": text})["shown"]


def test_a_sentence_becomes_chips_in_the_order_of_the_beats() -> None:
    found = of("He pats her on the back twice, then she leaves.")
    assert [[found["said"][act] for act in beat] for beat in found["beats"]] == [["pats on back ×2"], ["walks away"]]
    assert found["text"] == found["plan"]["sentence"]
    first, second = found["plan"]["acts"]
    assert (first["agents"], first["patient"], second["agents"]) == (["a"], "b", ["b"])
    assert found["text"][first["words"]["start"] : first["words"]["stop"]].startswith("He pats her")


def test_what_is_near_to_words_that_were_not_read_is_said_in_few_words() -> None:
    plan = Plan(
        sentence="He flumps.",
        acts=(Act(id="1", act="bow", agents=("a",)),),
        unread=(Unread(words=Span(start=0, stop=9), why="No act is known.", nearest=("walk-up", "gone-act")),),
    )
    found = shown(plan)["nearest"]
    assert set(found) == {"walk-up"}, "an act that is gone is not offered"
    assert (found["walk-up"]["said"], found["walk-up"]["patient"]) == ("walks up", True)


def test_the_example_under_what_cannot_be_shown_is_understood() -> None:
    (example,) = re.findall("“(.+)”", say("reading.example"))
    plan = of(example)["plan"]
    assert plan["acts"] and not plan["unread"]


def test_a_text_that_cannot_be_read_is_answered_by_a_sentence() -> None:
    found = of("They wave. " * 300)
    assert "shorten it" in found["error"] and "plan" not in found
    assert of("They wave. " * 300)["text"].startswith("They wave."), "the browser knows by it which text it is for"


def test_whatever_else_is_sent_is_read_as_nothing() -> None:
    for sent in (None, {}, {"text": None}, "They wave."):
        assert reread(sent)["shown"]["plan"]["acts"] == []


def edited(text: str, **changes: Any) -> dict[str, Any]:
    """A text with a plan as the browser sends them after an edit; ``changes`` are of its first act."""
    plan = read(text).model_dump(mode="json")
    plan["acts"][0] |= changes
    return {"text": text, "plan": json.dumps(plan), "number": 3}


def test_an_edited_plan_is_shown_in_place_of_the_words() -> None:
    found = reread(edited("They bow.", act="hug"))["shown"]
    assert (found["said"], found["edited"], found["number"]) == ({"1": "hug each other"}, True, 3)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"act": "levitate"}, "no act “levitate”"),
        ({"agents": []}, "acts.0.agents"),
        ({"more": 1}, "acts.0.more"),
        ({"order": [{"kind": "after", "act": "1"}]}, "ct 1 is ordered beside 1"),
    ],
)
def test_a_plan_that_is_none_is_answered_by_a_sentence(changes: dict[str, Any], said: str) -> None:
    found = reread(edited("They bow.", **changes))["shown"]
    assert said in found["error"] and "plan" not in found
    with pytest.raises(InputError, match=said.split(".")[0]):
        edited_plan(edited("They bow.", **changes), "They bow.")


def test_a_damaged_plan_is_answered_by_a_sentence() -> None:
    for plan in ("{", "[" * 100_000, "3"):
        found = reread({"text": "They bow.", "plan": plan})["shown"]
        assert "plan" not in found and found["error"].count(".") == 1, found


def test_an_edited_plan_counts_for_its_own_text_alone() -> None:
    sent = edited("They bow.", act="hug")
    plan = edited_plan(sent, "They bow.")
    assert plan is not None and plan.acts[0].act == "hug"
    assert edited_plan(sent, "They wave.") is None
    assert edited_plan({**sent, "plan": None}, "They bow.") is None
    assert edited_plan(None, "") is None


def test_marks_are_of_the_acts_that_were_checked() -> None:
    rows = [
        {"act": "wave", "words": "They wave", "done": True, "measure": "", "unchecked": ["how often"]},
        {"act": "hug", "words": "They hug", "done": False, "measure": "0.6 m apart", "unchecked": ["for long"]},
        {"act": "laugh", "words": "B laughs", "done": None, "measure": "no rule", "wrote": "giggles"},
    ]
    assert checked("They wave, then they hug.", {"checked": rows, "unread": ["slowly"]}) == {
        "text": "They wave, then they hug.",
        "acts": [
            {"act": "wave", "done": None, "measure": "how often"},
            {"act": "hug", "done": False, "measure": "0.6 m apart"},
            {"act": "laugh", "done": None, "measure": "read from “giggles”"},
        ],
        "unread": ["slowly"],
    }
    assert checked("They hug.", {}) == {}


def test_a_reading_says_how_long_its_beats_take() -> None:
    assert shown(read("They shake hands and then high five."))["seconds"] == 6.5
    assert shown(read("Nothing of the kind."))["seconds"] == 0.0
