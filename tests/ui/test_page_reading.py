"""What the page shows of how a prompt is understood."""

from __future__ import annotations

from typing import Any

from acts import Act, Plan, Span, Unread
from webdemo.ui.components.reading import answer, shown


def of(text: Any) -> dict[str, Any]:
    """What is shown for a text that the browser sent."""
    return answer({"text": text})["shown"]


def test_a_sentence_becomes_chips_in_the_order_of_the_beats() -> None:
    found = of("He pats her on the back twice, then she leaves.")
    assert [[found["said"][act] for act in beat] for beat in found["beats"]] == [
        ["pats back ×2"],
        ["walks away"],
    ]
    assert found["text"] == found["plan"]["sentence"]
    first, second = found["plan"]["acts"]
    assert (first["agents"], first["patient"], second["agents"]) == (["a"], "b", ["b"])
    assert found["text"][first["words"]["start"] : first["words"]["stop"]].startswith("He pats her")


def test_what_is_near_to_words_that_were_not_read_is_said_in_few_words() -> None:
    plan = Plan(
        sentence="He flumps.", acts=(Act(id="1", act="bow", agents=("a",)),),
        unread=(Unread(words=Span(start=0, stop=9), why="No act is known.", nearest=("walk-up", "gone-act")),),
    )  # fmt: skip
    found = shown("He flumps.", plan)
    assert found["nearest"] == {"walk-up": "walks up", "gone-act": "gone act"}


def test_a_text_that_cannot_be_read_is_answered_by_a_sentence() -> None:
    found = of("They wave. " * 300)
    assert "shorten it" in found["error"] and "plan" not in found
    assert of("They wave. " * 300)["text"].startswith("They wave."), (
        "the browser knows by it which text it is for"
    )


def test_whatever_else_is_sent_is_read_as_nothing() -> None:
    for sent in (None, {}, {"text": None}, "They wave."):
        assert answer(sent)["shown"]["plan"]["acts"] == []
