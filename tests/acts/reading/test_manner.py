"""How something is done: adverbs, alone and joined, and phrases that stand for them."""

from __future__ import annotations

import pytest

from acts import read
from acts.reading.syntax import is_adverb


@pytest.mark.parametrize(
    ("text", "act", "agents", "manner"),
    [
        ("B waves tiredly.", "wave", ("b",), ["tiredly"]),
        ("A sadly walks away from B.", "walk-away", ("a",), ["sadly"]),
        ("A slowly and sadly walks away.", "walk-away", ("a",), ["slowly", "sadly"]),
        ("The man walks up to her happily and proudly.", "walk-up", ("a",), ["happily", "proudly"]),
        ("A runs wildly around B.", "walk-around", ("a",), ["wildly"]),
        ("A walks like a child up to B.", "walk-up", ("a",), ["playfully"]),
        ("A limps like an old man up to B.", "walk-up", ("a",), ["limps", "stiffly"]),
        ("A girl skips up to her friend.", "walk-up", ("a",), ["skips"]),
        ("A baby crawls away from his mother.", "walk-away", ("a",), ["crawls"]),
        ("A man limps around the woman.", "walk-around", ("a",), ["limps"]),
        ("They skip forward together.", "walk-together", ("a", "b"), ["skips"]),
        ("He limps.", "limp-along", ("a",), []),
        ("A and B dance like robots.", "dance", ("a", "b"), ["stiffly"]),
        ("A greets B in a friendly way.", "greet", ("a",), ["friendly"]),
        ("A waves in a happy manner.", "wave", ("a",), ["happily"]),
    ],
)
def test_the_manner_is_read_and_nothing_is_left(
    text: str, act: str, agents: tuple[str, ...], manner: list[str]
) -> None:
    plan = read(text)
    (found,) = plan.acts
    assert (found.act, found.agents, list(found.manner)) == (act, agents, manner)
    assert not plan.unread


def test_a_letter_before_a_noun_in_ly_is_an_article() -> None:
    plan = read("A bully pushes a child.")
    assert plan.acts[0].agents == ("a",)
    assert plan.people[0].words == ("bully",)


@pytest.mark.parametrize(("word", "is_one"), [("tiredly", True), ("happily", True), ("family", False), ("fly", False)])
def test_adverbs_are_told_by_their_adjective(word: str, is_one: bool) -> None:
    assert is_adverb(word) is is_one


def test_what_somebody_is_like_is_nobody_else() -> None:
    walks = read("A walks like a ghost.")
    assert [(act.act, act.patient, act.manner) for act in walks.acts] == [("walk-ahead", None, ("softly",))]
    looks = read("A looks like a ghost while B dances.")
    assert [(act.act, act.agents) for act in looks.acts] == [("dance", ("b",))]
    assert [person.words for person in (*walks.people, *looks.people)] == [("person",), (), ("person",), ("person",)]


@pytest.mark.parametrize(
    ("text", "acts"),
    [
        ("A looks tired.", ["yawn"]),
        ("A looks scared and hides behind B.", ["startle", "come-behind"]),
        ("B looks as if asleep.", ["lie-down"]),
        ("A appears confident and waves.", ["wave"]),
        ("A appears behind B.", ["come-behind"]),
        ("A appears.", ["enter"]),
        ("A looks left.", ["look-around"]),
        ("A looks around as if lost.", ["look-around"]),
        ("A looks at B like a child.", ["face-other"]),
    ],
)
def test_how_somebody_looks_is_how_they_are(text: str, acts: list[str]) -> None:
    assert [act.act for act in read(text).acts] == acts


def test_a_likeness_that_no_body_shows_is_said_to_be_unread() -> None:
    plan = read("A looks like a ghost.")
    assert not plan.acts and len(plan.unread) == 1
