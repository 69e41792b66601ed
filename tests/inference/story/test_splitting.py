"""Sentences and stories as beats, by the order of the acts that they are read as."""

from __future__ import annotations

import pytest

from acts.staging.stage import staged
from motion import InputError
from webdemo.inference.story import split_sentence
from webdemo.inference.story.scripting import MOST_WORDS, _without_then, plan_of_beat

ONE = [
    "Two people hug.",
    "Two joggers run next to each other.",
    "Person A waves as she walks away and person B follows.",
    "Person A runs away, person B hot on their heels.",
    "walks away and waves back over the shoulder",
    "A points at B and laughs.",
    "One person is dancing and the other is clapping along.",
    "Sports day: the two race off.",
]
SEVERAL = [
    ("First they shake hands, then they both walk away.", ["shake-hands", "walk-away"]),
    ("Person A bows and then walks to person B. Finally both wave.", ["bow", "walk-up", "wave"]),
    ("They bump fists, and person A then goes away.", ["fist-bump", "walk-away"]),
    ("They hug before they walk away", ["hug", "walk-away"]),
    ("After a quick high five they run off.", ["high-five", "run-away"]),
    ("The two hug goodbye, and he leaves while she stays.", ["hug", "walk-away stand-still"]),
    ("A stands up and leaves, B stays.", ["stand-up", "walk-away stand-still"]),
    ("Person one raises both hands and person two copies it.", ["raise-arm", "raise-arm"]),
    ("Tom is sitting. Anna walks up to him and sits down.", ["sit-down walk-up", "sit-down"]),
    ("They walk up to each other, shake hands and part again.", ["walk-up shake-hands", "part"]),
    ("They bow, fight and bow again.", ["bow", "fight", "bow"]),
    ("He picks her up and spins her around. They bow.", ["lift-up twirl", "bow"]),
    ("A looks at the window. Then they hug.", ["look-at-thing", "hug"]),
    ("A sits on the chair until B taps A, then A gets up.", ["sit-down pat", "stand-up"]),
]


@pytest.mark.parametrize("sentence", ONE)
def test_what_goes_on_at_once_is_one_beat_in_its_own_words(sentence: str) -> None:
    (beat,) = split_sentence(sentence)
    assert beat.words == sentence and not beat.acts


@pytest.mark.parametrize(("sentence", "beats"), SEVERAL)
def test_what_follows_something_else_is_a_beat_of_its_own(sentence: str, beats: list[str]) -> None:
    found = split_sentence(sentence)
    assert [" ".join(act.act for act in beat.acts) for beat in found] == beats
    assert all(beat.words for beat in found), "the network has words to read"


def test_a_sentence_that_is_not_understood_keeps_its_words_and_its_place() -> None:
    first, second, third = split_sentence("They bow. They flurble gravely. They hug.")
    assert (first.acts[0].act, second.words, third.acts[0].act) == ("bow", "They flurble gravely.", "hug")
    assert not plan_of_beat(second).acts


def test_speech_and_remarks_are_no_acts() -> None:
    (beat,) = split_sentence('"Follow me!" She bows (he likes that).')
    told = staged(plan_of_beat(beat).acts)
    assert told.bows == {"a": (1, False)} and not told.moves


def test_nothing_is_no_beat() -> None:
    assert split_sentence("  \n ") == ()


def test_a_sentence_of_its_own_begins_without_then() -> None:
    assert _without_then("Then, he waves.") == "He waves."
    assert _without_then("He waves then.") == "He waves then."


def test_stories_longer_than_any_scene_are_refused_before_they_are_read() -> None:
    with pytest.raises(InputError, match=r"The story has [\d,]+ characters: shorten it to 30,000"):
        split_sentence("A waves. " * (MOST_WORDS // 9 + 2))
    with pytest.raises(InputError, match="more than 60 beats"):
        split_sentence("A bows. Then A jumps. " * 31)
