"""Sentences are split into beats that can be read alone, and lengths follow from the words."""

import pytest

from motion import InputError
from webdemo.inference.story import Beat, split_sentence
from webdemo.inference.story.beats import seconds_of


@pytest.mark.parametrize(
    ("sentence", "beats"),
    [
        ("Two people hug.", ["Two people hug."]),
        ("First they shake hands, then they both walk away.", ["They shake hands.", "They both walk away."]),
        (
            "Person A bows and then walks to person B. Finally both wave.",
            ["Person A bows.", "Person A walks to person B.", "Both wave."],
        ),
        (
            "They walk up to each other, shake hands and part again.",
            ["They walk up to each other.", "They shake hands.", "They part again."],
        ),
        ("They bump fists, and person A then goes away.", ["They bump fists.", "Person A goes away."]),
        ("They hug before they walk away", ["They hug.", "They walk away."]),
        # one thing, or things at the same time
        ("Two joggers run next to each other.", ["Two joggers run next to each other."]),
        ("One falls to the ground and the other helps him up.", None),
        ("They hold hands and walk.", None),
        ("First person A bows.", ["First person A bows."]),
    ],
)
def test_a_sentence_is_split_where_one_thing_follows_another(sentence: str, beats: list[str] | None) -> None:
    assert [beat.words for beat in split_sentence(sentence)] == (beats or [sentence])


def test_nothing_gives_no_beats() -> None:
    assert split_sentence("  \n ") == ()


def test_lengths_follow_from_the_words() -> None:
    assert (
        seconds_of("They dance for twelve or so hours.")
        == seconds_of("They dance.")
        > seconds_of("They nod.")
    )
    assert seconds_of("They wave for seven seconds.") == 7.0
    assert seconds_of("They wave for 2.5 seconds.") == 2.5
    assert (
        seconds_of("They slowly walk away.")
        > seconds_of("They walk away.")
        > seconds_of("They quickly walk away.")
    )
    assert Beat("They nod.", seconds=9.0).length == 9.0


def test_words_of_each_person_become_one_sentence() -> None:
    assert (
        Beat("They meet", a="Waves.", b="she bows").sentence == "They meet. One person waves, while she bows."
    )
    assert Beat(b="walks away").sentence == "The other person walks away."
    assert Beat().sentence == ""


@pytest.mark.parametrize(
    ("beat", "says"),
    [
        (Beat("x", seconds=0.4), "0.5 to 30 seconds"),
        (Beat("x", seconds=float("nan")), "0.5 to 30 seconds"),
        (Beat("x" * 600), "601 characters"),
        (Beat("x", seed=-1), "seed"),
        (Beat(3), "must be text"),  # type: ignore[arg-type]
    ],
)
def test_a_bad_beat_is_named(beat: Beat, says: str) -> None:
    with pytest.raises(InputError, match=f"Beat 7.*{says}"):
        beat.check(7)
