"""Texts without sense are answered by a plan, as any others."""

import pytest

from acts import read


def test_a_word_as_long_as_a_text_may_be_is_quoted_in_part():
    (unread,) = read(("ing" * 700)[:2000]).unread
    assert unread.why == f"No act is known for “{('ing' * 14)[:40]}” in this form."


@pytest.mark.parametrize("text", ["He leans by kneeling.", "He leans for let go.", "He leans in stretched and waves."])
def test_a_verb_behind_any_preposition_is_read(text: str) -> None:
    plan = read(text)
    assert plan.acts or plan.unread
