"""Bystanders: who they are, and how they stand."""

import pytest

from tests.acts.staging.staged_words import score


@pytest.mark.parametrize(
    ("sentence", "found"),
    [
        ("Person A sits down.", "b"),
        ("Person B bows.", "a"),
        ("She waves, but he does not wave back.", "b"),
        ("One wants a high five and is left hanging.", "b"),
        ("The first person stands still until the second person has come up to them.", "a"),
        # who is touched, spoken of together, or busy
        ("Person A pats person B on the back.", "b"),
        ("They bow.", ""),
        ("Person A waves and person B waves back.", ""),
        ("Two people hug.", ""),
        ("", ""),
    ],
)
def test_only_bystanders_stand_by(sentence: str, found: str) -> None:
    assert "".join(sorted(score(sentence).idle)) == found


@pytest.mark.parametrize(
    ("sentence", "found"),
    [
        ("They clap.", "ab"),
        ("Person A holds both arms out.", "a"),
        ("They talk.", "ab"),
        # who does something else as well
        ("Person A claps and person A bows.", ""),
        ("Person A walks away with outstretched arms.", ""),
    ],
)
def test_gestures_are_given_to_who_only_stands(sentence: str, found: str) -> None:
    assert "".join(sorted(score(sentence).gesturing)) == found
