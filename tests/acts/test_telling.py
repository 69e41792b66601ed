"""What happens is told in words, from the plan and the verdicts on its acts."""

from __future__ import annotations

import pytest

from acts import read
from acts.checking import Verdict, describe


def tell(sentence: str, *words: str, missed: str = "") -> str:
    """The words for a sentence whose acts are done, but for the one of these words."""
    plan = read(sentence)
    verdicts = [Verdict(act.id, act.act, said, said != missed) for act, said in zip(plan.acts, words, strict=True)]
    return describe(plan, verdicts)


@pytest.mark.parametrize(
    ("sentence", "words", "expected"),
    [
        ("A bows and claps. B waves.", ["A bows", "A claps", "B waves"], "A bows and claps; B waves."),
        ("Two friends hug.", ["they hug each other"], "They hug each other."),
        ("A waves. B claps.", ["A waves", "B claps"], "A waves; B claps."),
    ],
)
def test_what_is_done_is_told_in_order(sentence: str, words: list[str], expected: str) -> None:
    assert tell(sentence, *words) == expected


def test_what_is_not_seen_is_never_told_as_done() -> None:
    assert tell("A walks up to B. Then they hug.", "A walks up to B", "they hug", missed="they hug") == (
        "A walks up to B. Asked for but not seen: they hug."
    )
    assert tell("One person does not wave.", "A does not wave", missed="A does not wave") == (
        "Not so, although the words say it: A does not wave."
    )
    assert tell("A wants to hug B.", "A hugs B", missed="A hugs B") == ""
