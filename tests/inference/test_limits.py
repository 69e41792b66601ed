"""Limits of requests: what is refused, and the sentence that says so."""

from typing import Any

import pytest

from motion import InputError
from webdemo.inference.requests.sampling import MAX_PROMPT, number, prompt_of, whole


@pytest.mark.parametrize("value", [1, 2.5, 4])
def test_numbers_within_their_limits_are_taken(value: float) -> None:
    found = number("Length", value, 1, 4)
    assert found == value and isinstance(found, float)


@pytest.mark.parametrize("value", [0.999, 4.001, -1e300])
def test_numbers_outside_their_limits_are_refused_with_them(value: float) -> None:
    with pytest.raises(InputError, match=r"Length must be from 1 to 4 seconds, not "):
        number("Length", value, 1, 4, " seconds")


@pytest.mark.parametrize("value", [True, "2", None, float("nan"), float("inf"), 10**400])
def test_what_is_no_number_is_refused(value: Any) -> None:
    with pytest.raises(InputError, match=r"Seed must be a number from 0 to 4,294,967,295"):
        number("Seed", value, 0, 2**32 - 1)


def test_whole_numbers_are_whole() -> None:
    found = whole("Steps", 8.0, 1, 1000)
    assert found == 8 and isinstance(found, int)
    with pytest.raises(InputError, match=r"Steps must be a whole number from 1 to 1000, not 2\.5"):
        whole("Steps", 2.5, 1, 1000)


def test_prompts_have_words_and_an_end() -> None:
    assert prompt_of("x" * MAX_PROMPT, needed=True) == "x" * MAX_PROMPT
    assert prompt_of("", needed=False) == ""
    with pytest.raises(InputError, match="The prompt is empty"):
        prompt_of("  ", needed=True)
    with pytest.raises(InputError, match="501 characters: shorten it to 500"):
        prompt_of("x" * (MAX_PROMPT + 1), needed=False)
