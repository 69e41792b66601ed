"""Directions as directors and trainers write them: orders to somebody by name, headings, turns, exchanged roles."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

from acts import read

Told = list[tuple[str, str, str | None]]


def told(text: str) -> Told:
    """The acts that are done, as (act, agents, patient)."""
    return [(act.act, "".join(act.agents), act.patient) for act in read(text).acts if act.happens]


@pytest.mark.parametrize(
    ("text", "acts"),
    [
        ("A: walks to B. B: steps back.", [("walk-up", "a", "b"), ("step-back", "b", None)]),
        ("Lunge left, then step back.", [("lunge", "ab", None), ("step-back", "ab", None)]),
        ("They take turns bowing.", [("bow", "a", None), ("bow", "b", None)]),
        ("B is on all fours.", [("all-fours", "b", None)]),
        ("They are both seated.", [("sit-down", "ab", None)]),
        ("They stretch before a run.", [("stretch", "ab", None), ("run-together", "ab", None)]),
        ("A shows B how to bow.", [("bow", "a", None)]),
        ("B says hit me.", [("tell", "b", "a")]),
        ("A bows, refusing what B is holding out.", [("bow", "a", None), ("offer-thing", "b", "a")]),
        ("A lifts both arms while leaning left.", [("raise-arm", "a", None), ("lean", "a", None)]),
        ("B holds the ball with the right hand, then both hands.", [("hold-thing", "b", None)]),
    ],
)
def test_a_direction_is_read(text: str, acts: Told) -> None:
    assert told(text) == acts


@pytest.mark.parametrize(
    ("text", "act", "denied"),
    [
        ("Too proud to cry, Theo stares at him.", "cry", True),
        ("The lovers embrace, reluctant to part.", "part", True),
        ("She is ready to fight.", "fight", False),
    ],
)
def test_an_adjective_says_that_something_is_not_done(text: str, act: str, denied: bool) -> None:
    (found,) = [each for each in read(text).acts if each.act == act]
    assert not found.happens
    assert (found.polarity == "not") is denied


def test_a_text_is_read_alike_in_every_process() -> None:
    text = "Both of them take a seat, cross their legs, and start chatting with lively hand gestures."
    code = f"from acts import read; print([act.act for act in read({text!r}).acts])"
    found = {
        subprocess.run(
            [sys.executable, "-c", code],
            env={**os.environ, "PYTHONHASHSEED": seed},
            capture_output=True,
            text=True,
            check=True,
            timeout=120,
        ).stdout
        for seed in ("1", "2")
    }
    assert len(found) == 1 and "talk" in found.pop()


def test_who_mirrors_both_arms_raises_both() -> None:
    first, then = read("A raises both arms and B mirrors it.").acts
    assert (first.side, then.side, then.agents) == ("both", "both", ("b",))
    then = read("He steps to the left and she mirrors him.").acts[-1]
    assert (then.side, then.direction) == ("right", "right"), "a mirror goes to the same side of the room"


@pytest.mark.parametrize(
    ("text", "acts"),
    [
        ("A slaps B and B runs away.", ["a slap b", "b run-away a"]),
        ("The man hits the woman and the woman cries.", ["a punch b", "b cry"]),
        ("A catches B as she faints.", ["a catch-person b", "b fall-down"]),
    ],
)
def test_what_follows_on_a_touch(text: str, acts: list[str]) -> None:
    found = read(text).acts
    assert [" ".join(filter(None, ("".join(a.agents), a.act, a.patient))) for a in found] == acts
    assert [relation.kind for relation in found[1].order] == ["while" if " as " in text else "after"]
    assert not found[1].already


@pytest.mark.parametrize(
    "words", ["in the right direction", "in right direction", "to the right side", "towards the right"]
)
def test_the_right_direction_is_a_way(words: str) -> None:
    (act,) = read(f"a person walks {words}").acts
    assert act.direction == "right" or act.act == "step-aside"
    assert act.side == "right"
