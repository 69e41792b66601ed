"""What happens is told in words, from the plan and the verdicts on its acts."""

from __future__ import annotations

from collections.abc import Collection

import pytest

from acts import read
from acts.checking import Verdict, describe


def tell(sentence: str, missed: Collection[str] = ()) -> str:
    """The words for a sentence whose acts are done, except those named."""
    plan = read(sentence)
    return describe(plan, [Verdict(act.id, act.act, "", act.act not in missed) for act in plan.acts])


@pytest.mark.parametrize(
    ("sentence", "expected"),
    [
        (
            "A walks up to B and taps B's right shoulder; B turns around.",
            "A walks up to B and pats B on the right shoulder; B turns around.",
        ),
        ("Two friends hug.", "A and B hug."),
        ("She waves with the left hand and he bows twice.", "A waves with the left hand; B bows twice."),
        ("They carry a table across the room.", "A and B carry the table."),
        ("One person hands a flower to the other.", "A hands the flower to B."),
        ("One person jumps over the other, who crouches.", "B crouches and A jumps over B; B crouches."),
    ],
)
def test_what_is_done_is_told_in_order_with_sides_and_things(sentence: str, expected: str) -> None:
    assert tell(sentence) == expected


def test_what_is_not_seen_is_never_told_as_done() -> None:
    assert tell("A walks up to B. Then they hug.", missed={"hug"}) == (
        "A walks up to B. Asked for but not seen: A and B hug."
    )
    assert tell("One person does not wave.") == ""
    assert tell("One person does not wave.", missed={"wave"}) == ("Seen although the words rule it out: A waves.")
    assert tell("A wants to hug B.", missed={"hug"}) == ""
