"""Wilson intervals and agreement, against published values."""

from __future__ import annotations

import pytest

from webdemo.study.statistics import krippendorff_alpha, pairwise_agreement, sign_test, wilson_interval

# Krippendorff, "Computing Krippendorff's Alpha-Reliability" (2011), section C: four observers, twelve units, values
# missing. A row an observer; "." is missing.
OBSERVERS = (
    "1 2 3 3 2 1 4 1 2 . . .",
    "1 2 3 3 2 2 4 1 2 5 . 3",
    ". 3 3 3 2 3 4 2 2 5 1 .",
    "1 2 3 3 2 4 4 1 2 5 1 .",
)


def units(rows: tuple[str, ...]) -> list[list[str]]:
    return [[value for value in column if value != "."] for column in zip(*map(str.split, rows), strict=True)]


def test_alpha_is_that_of_krippendorffs_example() -> None:
    assert krippendorff_alpha(units(OBSERVERS)) == pytest.approx(0.743, abs=0.0005)


def test_alpha_of_two_observers_is_that_of_krippendorffs_binary_example() -> None:
    # Section A of the same paper: ten units, alpha 0.095.
    rows = ("0 1 0 0 0 0 0 0 1 0", "1 1 1 0 0 1 0 0 0 0")
    assert krippendorff_alpha(units(rows)) == pytest.approx(0.095, abs=0.0005)


def test_alpha_is_one_for_full_agreement_and_undefined_without_variation() -> None:
    assert krippendorff_alpha([["a", "a"], ["b", "b", "b"]]) == 1.0
    assert krippendorff_alpha([["a", "a"], ["a", "a"]]) is None
    assert krippendorff_alpha([["a"], ["b"], []]) is None
    assert krippendorff_alpha([]) is None


def test_pairwise_agreement_counts_pairs_of_raters() -> None:
    assert pairwise_agreement([["a", "a", "b"], ["b", "b"], ["a"]]) == 2 / 4
    assert pairwise_agreement([["a"]]) is None


@pytest.mark.parametrize(
    ("wins", "decided", "low", "high"),
    # Newcombe (1998), table I, method 3.
    [(81, 263, 0.2553, 0.3662), (15, 148, 0.0624, 0.1605), (0, 20, 0.0, 0.1611), (1, 29, 0.0061, 0.1718)],
)
def test_wilson_intervals_are_newcombes(wins: int, decided: int, low: float, high: float) -> None:
    assert wilson_interval(wins, decided) == pytest.approx((low, high), abs=5e-5)


def test_nothing_decided_says_nothing() -> None:
    assert wilson_interval(0, 0) == (0.0, 1.0) and sign_test(0, 0) == 1.0
    assert sign_test(9, 10) == pytest.approx(22 / 1024)
