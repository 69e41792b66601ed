"""Any text is read in linear time, gives a plan, and is refused where it is too long."""

from __future__ import annotations

import time

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from acts import Plan, read
from acts.reading.read import MOST_CHARACTERS
from motion import InputError


def test_too_long_a_text_is_refused() -> None:
    with pytest.raises(InputError, match="shorten it"):
        read("a" * (MOST_CHARACTERS + 1))


@pytest.mark.parametrize(
    ("text", "english"),
    [
        ("Sie umarmen sich.", False),
        ("Er winkt.", False),
        ("Ils se battent.", False),
        ("Dos personas bailan.", False),
        ("Die beiden tanzen Walzer.", False),
        ("A wvaes.", True),
        ("Yuki and Hiro embrace.", True),
        ("They dance el jarabe tapatio.", True),
    ],
)
def test_what_is_not_english_is_said_in_one_line_and_not_read(text: str, english: bool) -> None:
    plan = read(text)
    assert (not plan.acts and len(plan.notes) == 1 and "English" in plan.notes[0]) is not english


LONG = {
    "one word": "slowly ",
    "commas": ",",
    "letters": "A B ",
    "of": "the hand of ",
    "while": "while he hugs ",
    "unicode": "é ",
}


@pytest.mark.parametrize("kind", sorted(LONG))
def test_reading_grows_with_the_text_and_not_faster(kind: str) -> None:
    """Twice the text takes little more than twice the processor's time."""
    read("They hug.")  # loads the parser
    spent = []
    for length in (MOST_CHARACTERS // 2, MOST_CHARACTERS):
        text = (LONG[kind] * MOST_CHARACTERS)[:length]
        turns = []
        for turn in range(3):
            began = time.process_time()
            read(text[: length - turn])  # what was read before is kept
            turns.append(time.process_time() - began)
        spent.append(min(turns))
    assert spent[1] < 4 * spent[0] + 0.1
    assert spent[1] < 2


_WORDS = (
    "A B he she they hugs pats the a man woman boy and then while before without not hand left back on to his her "
    "each other one two people tries , . ; ' gives kid walks up down"
)


@example("other one gives")
@settings(max_examples=100, deadline=None)
@given(st.lists(st.sampled_from(_WORDS.split()), max_size=40).map(" ".join) | st.text(max_size=200))
def test_any_text_gives_a_plan(text: str) -> None:
    plan = read(text)
    assert Plan.model_validate_json(plan.model_dump_json()) == plan
    for act in plan.acts:
        assert act.words is not None and 0 <= act.words.start < act.words.stop <= len(text)
    for unread in plan.unread:
        assert unread.words.stop <= len(text)
    plan.beats()


def test_a_word_as_long_as_a_text_may_be_is_quoted_in_part():
    (unread,) = read(("ing" * 700)[:2000]).unread
    assert unread.why == f"No act is known for “{('ing' * 14)[:40]}” in this form."


@pytest.mark.parametrize("text", ["He leans by kneeling.", "He leans for let go.", "He leans in stretched and waves."])
def test_a_verb_behind_any_preposition_is_read(text: str) -> None:
    plan = read(text)
    assert plan.acts or plan.unread
