"""Sentences that run into each other, and orders before a sentence."""

from __future__ import annotations

import pytest

from acts.reading.parses import breaks
from acts.reading.syntax import parse
from tests.acts.reading.reading import told


@pytest.mark.parametrize(
    ("text", "acts"),
    [
        ("two guys run, one goes backwards they wave", ["run-together", "step-back", "wave"]),
        ("the man kneels the woman strokes his hair", ["kneel", "touch"]),
        ("he throws me the ball i catch it", ["throw-ball", "catch-thing"]),
        ("she throws the ball he jumps and catches it", ["throw-ball", "jump", "catch-thing"]),
        ("cowboy bows the other guy nods and goes down", ["bow", "nod", "fall-down"]),
        # a noun before a person is an object, or says more of the person
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
