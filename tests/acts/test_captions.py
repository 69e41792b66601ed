from __future__ import annotations

import pytest

from acts import lexicon, read
from acts.captions import beats, singular


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (
            "He pats her on the back, then she leaves.",
            ["Person A pats person B on the back.", "Person B walks away."],
        ),
        ("They hug.", ["They hug each other."]),
        ("He tries to hug her.", ["Person A stands still."]),
        ("She bows twice.", ["Person A bows twice."]),
        ("She raises both feet.", ["Person A lifts both feet."]),
        ("Nothing.", []),
    ],
)
def test_a_plan_in_plain_words(text: str, said: list[str]) -> None:
    assert beats(read(text), lexicon()) == said


def test_third_persons_of_verbs() -> None:
    verbs = ["pass", "carry", "play", "be", "have", "go"]
    assert [singular(verb) for verb in verbs] == ["passes", "carries", "plays", "is", "has", "goes"]
