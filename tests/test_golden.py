"""No change alters a motion unnoticed: see :mod:`tests.golden`."""

import pytest

from tests.golden import CASES, difference, kept, motion_of


@pytest.mark.parametrize("name", CASES)
def test_motion_is_the_golden_one(name: str) -> None:
    words = difference(kept().get(name), motion_of(name))
    assert not words, f"{words}. If that is meant: `python -m tests.golden --write`, and say so in the commit."


def test_golden_motions_are_those_of_the_cases() -> None:
    assert kept().keys() == CASES.keys()
