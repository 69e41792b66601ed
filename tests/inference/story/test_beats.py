"""The lengths of beats follow from their words, and bad beats are named."""

import pytest

from motion import InputError
from webdemo.inference.story import Beat
from webdemo.inference.story.beats import seconds_of


def test_lengths_follow_from_the_words() -> None:
    assert seconds_of("They dance for twelve or so hours.") == seconds_of("They dance.") > seconds_of("They nod.")
    assert seconds_of("They wave for seven seconds.") == 7.0
    assert seconds_of("They wave for 2.5 seconds.") == 2.5
    assert seconds_of("They slowly walk away.") > seconds_of("They walk away.") > seconds_of("They quickly walk away.")
    assert Beat("They nod.", seconds=9.0).length == 9.0


def test_words_of_each_person_become_one_sentence() -> None:
    assert Beat("They meet", a="Waves.", b="she bows").sentence == "They meet. One person waves, while she bows."
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
