"""Verbs of motion become moves, and nothing else does."""

import numpy as np
import pytest

from acts.staging.moves import coming, fastest
from acts.staging.places import Standing
from acts.staging.score import Move, goes

from .staged_words import score


def moves_of(sentence: str) -> str:
    return " ".join(f"{move.person}:{move.way.replace(' ', '-')}" for move in score(sentence).moves)


@pytest.mark.parametrize(
    ("sentence", "found"),
    [
        ("They walk up to each other.", "a:to b:to"),
        ("They go their separate ways.", "a:away b:away"),
        ("Person A backs away from person B.", "a:back b:stay"),
        ("They take a step back.", "a:back b:back"),
        ("The first person walks past the second person.", "a:past b:stay"),
        ("She walks all the way around him.", "a:around b:stay"),
        ("They circle each other without losing eye contact.", "a:around b:around"),
        ("They jog side by side.", "a:along b:along"),
        ("Person A chases person B.", "b:away a:after"),
        ("He sneaks up behind her.", "a:behind b:stay"),
        ("They turn their backs.", "a:turn b:turn"),
        ("They turn to face each other.", "a:face b:face"),
        ("They stand back to back.", "a:back-to-back b:back-to-back"),
        ("She steps aside to let him pass.", "a:aside b:stay"),
        ("Person B paces up and down.", "b:to-and-fro a:stay"),
        ("Person A walks to the door.", "a:away b:stay"),
        ("Person A goes back to her chair.", "a:away b:stay"),
        ("Person A goes back to her again.", "a:to b:stay"),
        ("Person A takes three steps forward.", "a:ahead b:stay"),
        ("A mother walks her son across the street.", "a:along b:along"),
        ("Person A limps.", "a:past b:stay"),
        ("Arm in arm, the two old ladies stroll through town.", "a:along b:along"),
        ("She dances around him while he sits there.", "a:around"),
        ("The guide walks backwards while the tourist follows her.", "a:away b:after"),
        ("A couple dances a waltz.", "a:hold b:hold"),
        ("Holding both her hands, he walks backwards and leads her along.", "a:away b:after"),
        ("They pass the ball.", "a:spar b:spar"),
        # moved by touch, by words alone, or not at all
        ("She is stroked on the head by him.", ""),
        ("They shake hands.", ""),
        ("Person A does not walk away.", ""),
        ("She wants to walk away.", ""),
        ("He holds out a hand.", ""),
        ("She keeps blocking his way.", ""),
    ],
)
def test_words_send_people_where_they_say(sentence: str, found: str) -> None:
    assert moves_of(sentence) == found


@pytest.mark.parametrize(
    ("words", "metres"),
    [("takes a step forward", 0.7), ("takes two steps forward", 1.4), ("takes a few steps forward", 2.1)],
)
def test_steps_ahead_are_counted(words: str, metres: float) -> None:
    ahead, _ = score(f"Person A {words}.").moves
    assert ahead.way == "ahead" and ahead.metres == pytest.approx(metres)


def test_who_is_on_the_ground_is_not_held_in_place() -> None:
    assert moves_of("Person A sits on the floor while person B walks past.") == "b:past"


def test_a_halt_is_a_move_but_sends_nobody_away() -> None:
    assert moves_of("Both stop.") == "a:stay b:stay" and not goes(score("Both stop.").moves)


def test_who_walks_and_runs_away_at_once_runs() -> None:
    walk, run, turn = Move("a", "away", 1.1), Move("a", "away", 2.2), Move("a", "turn")
    assert fastest([walk, turn, run, walk]) == [run, turn]
    assert fastest([walk, Move("b", "away", 2.2)]) == [walk, Move("b", "away", 2.2)]


def test_who_is_out_of_reach_steps_up_instead_of_leaning() -> None:
    def come(apart: float) -> list[tuple[str, str, float]]:
        stand = Standing(np.array([[0.0, 0.0], [0.0, apart]]), np.array([0.0, np.pi]))
        return [(move.person, move.way, move.near) for move in coming(score("They shake hands."), stand, ())]

    assert come(1.25) == [("a", "to", 0.75), ("b", "to", 0.75)]
    assert come(0.95) == []
