"""Counting votes."""

from __future__ import annotations

import csv
from pathlib import Path

import pytest

from webdemo.study import Pair, Vote, tally
from webdemo.study.results import write_votes
from webdemo.study.statistics import wilson_interval

SETS = ("InterGen", "=SUM(A1)")
PAIRS = [
    Pair((0, 1), (0, 2), "They hug."),
    Pair((0, 1), (1, 3), "They bow."),
    Pair((0, 0), (0, 4), "", "first"),
]


def votes(rater: int, *answers: str, swapped: bool = False) -> list[Vote]:
    return [Vote(rater, pair, answer, swapped, 2.0, 100.0) for pair, answer in enumerate(answers)]


def test_votes_are_counted_without_checks_and_without_the_inattentive() -> None:
    cast = [
        *votes(1, "first", "first", "first"),
        *votes(2, "first", "tie", "first"),
        *votes(3, "second", "skip", "first"),
        *votes(4, "second", "second", "second"),  # prefers the shuffled copy
    ]
    result = tally(SETS, PAIRS, cast)
    (each,) = result.comparisons
    assert each.sets == SETS
    assert (each.wins, each.losses, each.ties, each.skips) == (3, 1, 1, 1)
    assert each.share == 0.75 and each.interval == wilson_interval(3, 4)
    assert each.p_value == pytest.approx(0.625)
    assert (result.raters, result.excluded, result.votes) == (3, 1, 5)
    assert result.agreement == pytest.approx(1 / 4)  # hug: 1 of 3 pairs of votes, bow: 0 of 1
    assert result.alpha is not None and result.alpha < 0


def test_a_study_without_votes_says_nothing() -> None:
    result = tally(SETS, PAIRS, [])
    (each,) = result.comparisons
    assert each.share is None and each.interval == (0.0, 1.0)
    assert (result.raters, result.votes, result.alpha, result.agreement) == (0, 0, None, None)
    assert result.to_dict()["comparisons"][0]["share"] is None


def test_a_table_holds_every_vote_with_its_side_and_nothing_that_a_spreadsheet_computes(
    tmp_path: Path,
) -> None:
    cast = [*votes(1, "first", "tie", "second"), *votes(2, "second", "first", "first", swapped=True)]
    write_votes(SETS, PAIRS, cast, tmp_path / "votes.csv")
    rows = list(csv.DictReader((tmp_path / "votes.csv").open()))
    assert [(row["left"], row["pressed"], row["chosen"]) for row in rows] == [
        ("InterGen", "left", "InterGen"),
        ("InterGen", "tie", "tie"),
        ("InterGen", "right", "InterGen, shuffled"),
        ("'=SUM(A1)", "left", "'=SUM(A1)"),
        ("'=SUM(A1)", "right", "InterGen"),
        ("InterGen, shuffled", "right", "InterGen"),
    ]
    assert [row["attention_check"] for row in rows[:3]] == ["no", "no", "yes"]
    assert [row["rater_counts"] for row in rows] == ["no"] * 3 + ["yes"] * 3
    assert rows[2]["check_passed"] == "no" and rows[5]["check_passed"] == "yes"
