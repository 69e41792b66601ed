"""What a verdict leaves out of a sentence: words in no act, and qualifiers that nothing measures."""

from __future__ import annotations

import pytest

from acts import read
from acts.accounting import unread_words
from acts.checking import checked
from tests.motion.metrics.test_sentence_shapes import duet, put


@pytest.mark.parametrize(
    ("sentence", "unread"),
    [
        ("A waves at B.", ()),
        ("They shake hands and walk away.", ()),
        ("A bows against the wall.", ("against the wall",)),
        ("He lowers his head in shame.", ("in shame",)),
        ("They circle each other clockwise.", ("clockwise",)),
        ("A hands B a heavy box, and B puts it on the floor.", ("heavy",)),
        ("A waves and zorbles.", ("zorbles",)),
    ],
)
def test_words_that_are_in_no_act_are_reported(sentence: str, unread: tuple[str, ...]) -> None:
    assert unread_words(read(sentence)) == unread


@pytest.mark.parametrize(
    ("sentence", "kinds"),
    [
        ("A raises the right arm.", ()),
        ("A jumps twice.", ()),
        ("A crouches three times.", ("how often",)),
        ("A taps B on the left shoulder.", ("which side",)),
        ("A kicks B in the shin.", ("where on the body",)),
        ("A hugs B for ten seconds.", ("how long",)),
        ("A stamps the foot angrily.", ("in which manner",)),
        ("A points at the door.", ("which thing",)),
    ],
)
def test_qualifiers_that_nothing_measures_are_named(sentence: str, kinds: tuple[str, ...]) -> None:
    (found,) = checked(read(sentence), duet())
    assert found.unchecked == kinds


def test_what_is_done_is_said_without_what_was_not_measured() -> None:
    up = duet(put("left_wrist", (0.2, 0.9, 0.0)))
    (found,) = checked(read("A raises the left arm angrily."), up)
    assert found.done and found.words == "A raises the left arm" and found.unchecked == ("in which manner",)
    (found,) = checked(read("A raises the left arm angrily."), duet())
    assert not found.done and found.words == "A raises the left arm angrily"
