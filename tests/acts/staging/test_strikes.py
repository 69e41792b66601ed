"""Blows and throws, as words name them and as arms make them."""

from __future__ import annotations

import numpy as np
import pytest

from acts import read
from acts.staging.score import Strike
from acts.staging.stage import score_of
from acts.staging.strikes import BOUTS, blows, catching, poses, ready
from motion import SMPL22
from webdemo.inference.story.sentences import beats_of

from .staged_words import beginning, score

HERE, THERE = np.zeros(2), np.array([0.0, BOUTS["fists"].apart])
HEAD = SMPL22.index("head")


@pytest.mark.parametrize(
    ("words", "bout", "turns", "goes_on"),
    [
        ("They fight.", "fists", "ab", True),
        ("Two knights fight with swords.", "weapons", "ab", True),
        ("Two people play tennis.", "rackets", "ab", True),
        ("Person A throws a ball to person B, who catches it.", "throws", "a", False),
        ("Person B punches person A.", "fists", "b", False),
        ("He slaps her in the face twice.", "slaps", "aa", False),
    ],
)
def test_blows_are_read(words: str, bout: str, turns: str, goes_on: bool) -> None:
    assert score(words).strike == Strike(bout, turns, goes_on)
    found = score(words).moves
    assert {m.person for m in found} == {"a", "b"} and {m.way for m in found} == {"spar"}
    assert all(move.near == BOUTS[bout].apart for move in found)


def test_blows_are_as_many_as_the_words_say() -> None:
    struck = score("A punches B twice, and B punches A three times.").strike
    assert struck is not None and (struck.turns, struck.goes_on) == ("aabbb", False)


def test_a_blow_that_ends_something_comes_late() -> None:
    late, at_once = score("They argue until A slaps B in the face.").strike, score("A slaps B.").strike
    assert late is not None and late.late and at_once is not None and not at_once.late


@pytest.mark.parametrize(
    "words", ["They do not fight.", "He wants to punch her.", "She throws her arms around him.", "He punches the air."]
)
def test_other_words_are_left_to_the_network(words: str) -> None:
    assert score(words).strike is None


@pytest.mark.parametrize(
    ("words", "turns"),
    [
        ("He punches her and she falls down.", "a"),
        ("Person B throws a punch and person A ducks.", "b"),
        ("Person A throws a punch, person B ducks under it and punches back.", "ab"),
    ],
)
def test_answers_to_a_punch_are_read(words: str, turns: str) -> None:
    assert score(words).strike == Strike("fists", turns, goes_on=False, answered=True)
    placed = beginning(words)
    assert placed is not None and placed.gap() == pytest.approx(BOUTS["fists"].apart)
    assert score(words).moves[0].person == turns[0] and all(move.way != "spar" for move in score(words).moves)


def test_two_who_fight_strike_in_turn_with_either_fist() -> None:
    made = blows(Strike("fists", "ab"), 150, first=0)
    assert [blow.person for blow in made[:4]] == [0, 1, 0, 1]
    assert [blow.side for blow in made[:4]] == ["right", "right", "left", "left"]
    assert np.all(np.diff([blow.frame for blow in made]) > 15) and made[-1].frame < 150


def test_one_blow_is_struck_once_when_the_two_are_near() -> None:
    made = blows(Strike("fists", "b", goes_on=False), 150, first=40)
    assert [blow.person for blow in made] == [1] and made[0].frame > 40
    assert blows(Strike("fists", "b", goes_on=False), 20, first=0) == []


@pytest.mark.parametrize("side", ["left", "right"])
def test_a_fist_shoots_out_to_the_head_and_not_into_it(side: str) -> None:
    frames, found = poses("fists", side, HERE, THERE)
    found = found - found[:, :1]
    wrist = found[:, SMPL22.index(f"{side}_wrist")]
    ahead = ready(HERE, THERE)[HEAD] - ready(HERE, THERE)[0]
    head = np.array([0.0, ahead[1], BOUTS["fists"].apart - ahead[2]])
    away = np.linalg.norm(wrist - head, axis=-1)
    landed = frames.index(-1)
    assert 0.08 < away[landed] < 0.2 < 0.3 < away[0]
    assert np.linalg.norm(wrist[landed] - wrist[0]) / (frames[landed] - frames[0]) * 30 > 2.5  # m/s
    other = "left" if side == "right" else "right"
    assert found[landed, SMPL22.index(f"{side}_shoulder"), 2] > found[landed, SMPL22.index(f"{other}_shoulder"), 2]


def test_a_slap_comes_from_the_side_and_lands_on_the_cheek() -> None:
    there = np.array([0.0, BOUTS["slaps"].apart])
    frames, found = poses("slaps", "right", HERE, there)
    found = found - found[:, :1]
    drawn, landed = (found[i, SMPL22.index("right_wrist")] for i in (0, frames.index(-1)))
    head = ready(HERE, there)[HEAD] - ready(HERE, there)[0]
    beside = landed - [0.0, head[1], BOUTS["slaps"].apart - head[2]]
    assert drawn[0] < -0.35 < -0.2 < beside[0] < -0.06, "on the right of the one who slaps"
    assert np.linalg.norm(beside) < 0.16


@pytest.mark.parametrize("bout", ["weapons", "rackets", "throws"])
def test_an_arm_swings_from_behind_to_before_the_body(bout: str) -> None:
    angle = 1.1
    there = BOUTS[bout].apart * np.array([np.sin(angle), np.cos(angle)])
    ahead = np.array([np.sin(angle), 0.0, np.cos(angle)])
    frames, found = poses(bout, "right", HERE, there)
    reach = found[:, SMPL22.index("right_wrist")] @ ahead
    assert reach[frames.index(-1)] > 0.4 > 0.1 > reach[0]


def test_hands_that_catch_wait_for_what_is_in_the_air() -> None:
    frames, found = catching(HERE, THERE)
    wrists = found[:, [SMPL22.index("left_wrist"), SMPL22.index("right_wrist")]]
    assert min(frames) > 5 and wrists[..., 2].min() > 0.35 and np.ptp(wrists[0, :, 0]) < 0.3


@pytest.mark.parametrize("words", ["He kicks her.", "They kick each other.", "Person A kicks person B."])
def test_who_kicks_begins_within_reach(words: str) -> None:
    placed = beginning(words)
    assert placed is not None and placed.gap() == pytest.approx(1.0)
    ball = beginning("He kicks the ball.")
    assert ball is not None and ball.gap() > 2.0


def test_blows_are_struck_with_the_hands_that_the_words_name() -> None:
    struck = score("He throws two jabs with the left.").strike
    assert struck is not None and struck.hands == ("left", "left")
    assert [(blow.person, blow.side) for blow in blows(struck, 150, first=0)] == [(0, "left"), (0, "left")]


@pytest.mark.parametrize("words", ["A punches B.", "A kicks B."])
def test_who_is_hit_bends_if_no_words_say_what_they_do(words: str) -> None:
    assert [limb.figure for limb in score(words).limbs["b"]] == ["leans"]
    assert "b" not in score(f"{words[:-1]} and B waves.").limbs


@pytest.mark.parametrize("words", ["A punches B and B falls down.", "A kicks B and B falls down."])
def test_who_is_struck_falls_afterwards(words: str) -> None:
    (beat,) = beats_of(read(words))
    ((fall,),) = score_of(beat.acts).changes.values()
    assert 0.3 < fall.after < 0.6
