"""Sentences that name person A and person B, taken apart."""

from __future__ import annotations

import pytest

from webdemo.inference.story.roles import of_each

CASES = {
    "Person A waves while person B claps.": ("One person waves.", "One person claps."),
    "Person B pats person A on the shoulder, and person A turns around.": (
        "One person turns around.",
        "One person pats the other person on the shoulder.",
    ),
    "Person A bows to person B and then walks past person B.": (
        "One person bows to the other person and walks past the other person.",
        "",
    ),
    "Person A sits down; person B walks around person A and stops behind person A.": (
        "One person sits down.",
        "One person walks around the other person and stops behind the other person.",
    ),
    "person a jumps. Person B waits. Person A sits down.": (
        "One person jumps and sits down.",
        "One person waits.",
    ),
    "A man puts his left hand up, then a woman turns away from him.": (
        "One person puts his left hand up.",
        "One person turns away from him.",
    ),
    "Person A is tapped on the back by person B and turns around.": (
        "One person is tapped on the back by the other person and turns around.",
        "One person taps the other person on the back.",
    ),
    "Person B is taken by the hand.": ("", "One person is taken by the hand."),
    "Person B takes person A's hand.": ("", "One person takes the other person's hand."),
}


@pytest.mark.parametrize("sentence", CASES)
def test_what_each_does_is_found(sentence: str) -> None:
    assert of_each(sentence) == CASES[sentence]


@pytest.mark.parametrize(
    "sentence",
    [
        "Two people wave.",
        "",
        "Person A and person B shake hands.",
        "They bump fists, and person A then goes away while person B remains.",
        "Person A and person B hug, and person A leaves.",
        "Person A's left hand is on person B's shoulder.",
    ],
)
def test_where_it_is_not_said_by_name_the_whole_sentence_is_kept(sentence: str) -> None:
    assert of_each(sentence) == ("", "")
