"""Sentences that run into each other, and orders before a sentence."""

from __future__ import annotations

import pytest

from acts import read
from acts.reading.parses import breaks
from acts.reading.syntax import parse
from tests.acts.reading.reading import told


@pytest.mark.parametrize(
    ("text", "acts"),
    [
        ("two guys run, one goes backwards they wave", ["walk-together", "step-back", "wave"]),
        ("the man kneels the woman strokes his hair", ["kneel", "touch"]),
        ("he throws me the ball i catch it", ["throw-ball", "catch-thing"]),
        ("she throws the ball he jumps and catches it", ["throw-ball", "jump", "catch-thing"]),
        ("cowboy bows the other guy nods and goes down", ["bow", "nod", "fall-down"]),
        # a noun before a person is an object, or says more of the person
        ("waiter brings a tray guest nods", ["bring-thing", "nod"]),
        ("A police officer waves a tennis player walks away", ["wave", "walk-away"]),
    ],
)
def test_a_missing_stop_is_supplied(text: str, acts: list[str]) -> None:
    assert [name for name, _, _ in told(text)] == acts


def test_the_new_sentence_has_a_subject_of_its_own() -> None:
    for text in ("he bows the other guy claps", "guy bows woman claps"):
        assert [who for _, who, _ in told(text)] == ["a", "b"], text


@pytest.mark.parametrize(
    "text",
    [
        "The man sees she waves.",
        "The ball he throws hits her.",
        "When he waves she bows.",
        "He hugs her and then she waves.",
    ],
)
def test_a_clause_that_a_word_takes_is_no_sentence(text: str) -> None:
    assert not list(breaks(parse(text), {}))


def test_an_order_before_a_sentence_is_given_to_both() -> None:
    assert told("shake on it then one of them waves")[0] == ("shake-hands", "ab", None)


def test_hands_before_a_colon_are_those_of_both() -> None:
    acts = {
        act.act: act.agents
        for act in read(
            "En garde, left hands behind the back: the first attacks with a lunge, the second parries."
        ).acts
    }
    assert acts["hands-behind-back"] == ("a", "b")
    assert acts["lunge"] == ("a",)
    assert acts["sword-fight"] == ("b",)


def test_hands_behind_a_person_without_a_verb_are_no_verb() -> None:
    acts = [("tie-up", "a", "b"), ("hands-behind-back", "b", None)]
    assert told("police guy cuffs the thief hands behind his back") == acts


def test_a_verb_beside_a_clause_has_the_subject_of_that_clause() -> None:
    assert told("One steps back as the other points at her chest and comes closer.")[-1][:2] == ("walk-up", "b")
    assert told("One steps back as the other points at her, and bows.")[-1][:2] == ("bow", "a")


@pytest.mark.parametrize(
    ("text", "acts"),
    [
        ("A holds the ladder and B climbs it.", [("hold-thing", "a"), ("climb", "b")]),
        (
            "The thief grabs the bag and the woman who was holding it screams and chases him.",
            [("take-from", "a"), ("touch", "b"), ("startle", "b"), ("chase", "b")],
        ),
        ("He drops the cup and the woman behind him laughs.", [("let-go", "a"), ("laugh", "b")]),
    ],
)
def test_a_person_behind_a_thing_and_and_begins_a_clause(text: str, acts: list[tuple[str, str]]) -> None:
    assert [(name, who) for name, who, _ in told(text)] == acts


def test_bread_and_butter_are_no_clause() -> None:
    assert not list(breaks(parse("They eat bread and butter."), {}))
