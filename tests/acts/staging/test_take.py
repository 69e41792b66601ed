"""Takes: seeds differ in what words leave open, and in nothing that they say."""

from __future__ import annotations

import numpy as np
import pytest

from acts import lexicon, read
from acts.staging.beginnings import APART, OPEN, PACES, Take, beginning
from acts.staging.score import Score
from acts.staging.stage import score_of

TAKES = [Take.of(seed) for seed in range(40)]


def scores(words: str) -> list[Score]:
    acts = read(words).acts
    return [score_of(take.of_acts(acts, lexicon())) for take in TAKES]


def test_an_open_hand_is_the_left_one_in_some_takes_and_a_told_one_in_none() -> None:
    assert {score.gestures["a"].sides for score in scores("A salutes.")} == {"left", "right"}
    assert {score.gestures["a"].sides for score in scores("A salutes with the right hand.")} == {"right"}
    for words in ("A raises both arms.", "A plays the drums."):
        assert {score.gestures["a"].sides for score in scores(words)} == {"both"}
    assert {score.limbs["a"][0].mirrored for score in scores("A lifts the left knee.")} == {True}
    assert {score.limbs["a"][0].mirrored for score in scores("A lifts a knee.")} == {True, False}


def test_they_go_round_either_way_unless_it_is_told() -> None:
    assert {score.moves[0].rightwards for score in scores("A walks around B.")} == {True, False}
    assert {score.moves[0].rightwards for score in scores("A walks around B clockwise.")} == {True}


def test_those_who_circle_each_other_are_as_far_apart_as_it_is_told() -> None:
    score = score_of(read("They circle each other, two metres apart.").acts)
    usual = beginning([score], [5.0])
    assert {round(take.of_places(usual, score).gap(), 6) for take in TAKES} == {2.0}


def test_walks_are_faster_and_slower_unless_it_is_told() -> None:
    usual = score_of(read("A walks up to B.").acts).moves[0].speed
    speeds = np.array([score.moves[0].speed for score in scores("A walks up to B.")]) / usual
    assert len(set(speeds)) == len(TAKES) and PACES[0] <= speeds.min() < 0.95 and 1.05 < speeds.max() <= PACES[1]
    assert len({score.moves[0].speed for score in scores("A walks up to B slowly.")}) == 1


def test_who_does_not_touch_begins_nearer_and_farther_and_turned_aside() -> None:
    score = score_of(read("A waves at B.").acts)
    usual = beginning([score], [5.0])
    stands = [take.of_places(usual, score) for take in TAKES]
    gaps = np.array([stand.gap() for stand in stands]) / usual.gap()
    assert APART[0] <= gaps.min() < 1.0 and 1.1 < gaps.max() <= APART[1]
    for person in (0, 1):
        facing = [stand.headings[person] - np.arctan2(*stand.towards(person)) for stand in stands]
        aside = np.abs((np.array(facing) + np.pi) % (2 * np.pi) - np.pi)
        assert aside.max() <= OPEN + 1e-9 and aside.max() > OPEN / 2


@pytest.mark.parametrize(
    "words", ["A pats B on the shoulder.", "They dance a waltz.", "A stands behind B.", "They box."]
)
def test_places_that_depend_on_each_other_stay(words: str) -> None:
    score = score_of(read(words).acts)
    usual = beginning([score], [5.0])
    for take in TAKES:
        np.testing.assert_array_equal(take.of_places(usual, score).places, usual.places)
