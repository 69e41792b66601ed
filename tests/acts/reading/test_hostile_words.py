"""Texts without sense are answered by a plan, as any others."""

from acts import read


def test_a_word_as_long_as_a_text_may_be_is_quoted_in_part():
    (unread,) = read(("ing" * 700)[:2000]).unread
    assert unread.why == f"No act is known for “{('ing' * 14)[:40]}” in this form."
