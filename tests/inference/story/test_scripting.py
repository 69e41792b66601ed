"""The beats of plans: what goes on at once shares one, what follows something else has one of its own."""

from __future__ import annotations

import pytest

from acts import read
from webdemo.inference.story.scripting import beats_of
from webdemo.inference.story.staging import staged

BEATS = [
    ("walks away and waves back over the shoulder", ["walk-away wave"]),
    ("A points at B and laughs.", ["point laugh"]),
    ("One person is dancing and the other is clapping along.", ["dance clap"]),
    ("They hug before they walk away", ["hug", "walk-away"]),
    ("After a quick high five they run off.", ["high-five", "run-away"]),
    ("The two hug goodbye, and he leaves while she stays.", ["hug", "walk-away stand-still"]),
    ("A stands up and leaves, B stays.", ["stand-up", "walk-away stand-still"]),
    ("Person one raises both hands and person two copies it.", ["raise-arm", "raise-arm"]),
    ("Tom is sitting. Anna walks up to him and sits down.", ["sit-down walk-up", "sit-down"]),
    ("They walk up to each other, shake hands and part again.", ["walk-up shake-hands", "part"]),
    ("He picks her up and spins her around. They bow.", ["lift-up twirl", "bow"]),
    ("A sits on the chair until B taps A, then A gets up.", ["sit-down pat", "stand-up"]),
]


@pytest.mark.parametrize(("sentence", "beats"), BEATS)
def test_acts_share_a_beat_as_they_are_told(sentence: str, beats: list[str]) -> None:
    assert [" ".join(act.act for act in beat.acts) for beat in beats_of(read(sentence))] == beats


def test_speech_and_remarks_are_no_acts() -> None:
    plan = read('"Follow me!" She bows (he likes that).')
    assert [act.act for act in plan.acts] == ["bow"]


def test_who_gives_what_somebody_gets_does_it() -> None:
    (act,) = read("He gets a shoulder massage from her.").acts
    assert (act.act, act.agents, act.patient) == ("massage", ("b",), "a")


def test_people_sit_side_by_side_where_they_are_said_to() -> None:
    told = staged(read("Two strangers sit next to each other on a park bench.").acts)
    assert told.keeps_place and told.placed is not None and set(told.changes) == {"a", "b"}


def test_who_sits_in_a_chair_sits_from_the_start() -> None:
    told = staged(read("Dad reads the paper in his armchair while the baby crawls about.").acts)
    assert told.changes["a"][0].already


def test_a_lifted_person_is_turned_round_with_the_carrier() -> None:
    lifted = staged(read("He picks her up and spins her around.").acts).lift
    assert lifted is not None and lifted.spins


def test_who_kneels_to_tie_a_shoe_kneels() -> None:
    told = staged(read("A kneels down to tie his shoe while B waits.").acts)
    assert set(told.changes) == {"a"} and not told.limbs
