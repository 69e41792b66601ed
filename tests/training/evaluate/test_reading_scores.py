from __future__ import annotations

from acts import read
from training.evaluate.plans import Act, Reading
from training.evaluate.reading_scores import score


def reading(words: str, *acts: Act, unread: tuple[str, ...] = ()) -> Reading:
    return Reading("x", words, acts, unread)


def test_a_plan_that_is_right_counts() -> None:
    hug = Act("hug", ("a",), "b")
    leave = Act("walk away", ("b",), order=(("after", 0),))
    found = score([reading("He hugs her, then she walks away.", hug, leave)])
    assert (found.found, found.expected, found.extra, found.whole) == (2, 2, 0, 1)
    assert (found.ordered, found.orders) == (1, 1)


def test_each_kind_of_fault_counts() -> None:
    words = "He pats her on the back."
    assert score([reading(words, Act("pat", ("b",), "a"))]).found == 0
    assert score([reading(words, Act("pat", ("a",), "b", polarity="not"))]).found == 0
    assert score([reading(words, Act("pat", ("a",), "b", modality="tried"))]).found == 0
    assert score([reading(words, Act("kick", ("a",), "b"))]).found == 0
    assert score([reading(words)]).extra == 1
    words = "They photograph the moon and bow."
    both = score([reading(words, Act("bow", ("a", "b")), unread=("photograph the moon",))])
    assert both.reported == 1


def test_another_reader_is_scored() -> None:
    backwards = score([reading("He pats her.", Act("pat", ("a",), "b"))], lambda words: read("She bows."))
    assert backwards.found == 0 and backwards.extra == 1
