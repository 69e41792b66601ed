"""Postures: who goes down, who stays down, and who jumps, as the words say."""

from __future__ import annotations

import numpy as np
import pytest

from acts.staging import score as scores
from acts.staging.places import Standing
from acts.staging.postures import postures

from .staged_words import figures, score


def at_start(story: list[str], beat: int) -> dict[str, str]:
    return scores.at_start([score(sentence) for sentence in story], beat)


SITS, KNEELS, LIES = "sits", "kneels", "lies"
CROUCHES, STANDS = "crouches", "stands"


@pytest.mark.parametrize(
    ("sentence", "found"),
    [
        ("Person A sits down.", {"a": [SITS]}),
        ("A man drops to one knee.", {"a": [KNEELS]}),
        ("One falls to the ground and the other helps him up again.", {"a": [LIES, STANDS]}),
        ("Person B is knocked over by person A.", {"b": [LIES]}),
        ("Person A kneels down, holds out a hand and is pulled to their feet by person B.", {"a": [KNEELS, STANDS]}),
        ("B sits; A pulls up B", {"b": [SITS, STANDS]}),
        ("She walks away and leaves him sitting there.", {"b": [SITS]}),
        # nobody goes down
        ("They walk to the table.", {}),
        ("Person A does not sit down.", {}),
        ("Person A nearly falls over.", {}),
        ("Person A falls into step with person B.", {}),
    ],
)
def test_changes_are_read_in_order(sentence: str, found: dict[str, list[str]]) -> None:
    assert {who: [c.posture for c in listed] for who, listed in score(sentence).changes.items()} == found


@pytest.mark.parametrize(
    ("sentence", "already"),
    [
        ("Person A stays seated and waves.", True),
        ("While person A kneels, person B looks on.", True),
        ("Person A is lying on the floor.", True),
        ("Person A sits down.", False),
    ],
)
def test_who_is_down_already_does_not_go_down(sentence: str, already: bool) -> None:
    assert score(sentence).changes["a"][0].already is already


def test_what_makes_somebody_fall_comes_before_the_fall() -> None:
    assert score("A person is knocked over by the other person.").changes["a"][0].after >= 0.4
    assert score("Person A falls over.").changes["a"][0].after == 0.0


def test_who_ducks_is_up_again() -> None:
    (duck,) = score("Person A punches and person B ducks.").changes["b"]
    assert duck.passing and duck.posture == CROUCHES
    assert at_start(["Person B ducks.", "They bow."], 1)["b"] == STANDS


def test_postures_last_until_the_person_gets_up() -> None:
    story = ["Person A sits down.", "Person B waves.", "Person A gets up.", "They bow."]
    assert [at_start(story, beat)["a"] for beat in range(4)] == [STANDS, SITS, SITS, STANDS]
    assert at_start(["Person A stays seated."], 0) == {"a": SITS, "b": STANDS}
    assert at_start(["He rises from his chair.", "He bows."], 0)["a"] == SITS, "who gets up was down"


@pytest.mark.parametrize("act", ["They dance.", "They walk away.", "Person A jumps."])
def test_who_needs_their_legs_is_on_their_feet_again(act: str) -> None:
    assert at_start(["They sit down.", act, "They talk."], 1)["a"] == STANDS
    assert at_start(["They sit down.", act, "They talk."], 2)["a"] == STANDS
    assert at_start(["They sit down.", "They talk."], 1)["a"] == SITS


def test_who_is_left_sitting_sat_from_the_start() -> None:
    story = ["She gets up from the table.", "Person A leaves him sitting there."]
    assert at_start(story, 0) == {"a": SITS, "b": SITS}
    assert at_start(story, 1)["b"] == SITS and at_start(story, 1)["a"] == STANDS
    assert at_start(["Person B runs in.", "Person B is sitting on a chair."], 0)["b"] == STANDS


@pytest.mark.parametrize(
    ("sentence", "found"),
    [
        ("Person A bows.", {"a": ("bows", 1)}),
        ("Person B bows very deeply.", {"b": ("bows deeply", 1)}),
        ("One of them takes three bows in a row.", {"a": ("bows", 3)}),
        ("Person A does not bow.", {}),
        ("Both jump.", {"a": ("jumps", 1), "b": ("jumps", 1)}),
        ("They jump up and down for joy.", {"a": ("jumps", 3), "b": ("jumps", 3)}),
        ("Person A jumps twice.", {"a": ("jumps", 2)}),
        ("Person A jumps to his feet.", {}),
        ("Person A does not jump.", {}),
    ],
)
def test_bows_and_jumps_on_the_spot_are_counted(sentence: str, found: dict[str, tuple[str, int]]) -> None:
    assert figures(sentence) == found


def test_who_gets_down_to_the_floor_gets_lower_all_the_way_and_who_got_up_stays_up() -> None:
    stand = Standing(np.array([[0.0, 0.0], [0.0, 2.0]]), np.array([0.0, np.pi]))
    down = postures([score("A sits down on the floor.")], 0, 0, 0, 150, stand, None)
    heights = [float(pose[0, 1]) for _, pose in down]
    assert heights == sorted(heights, reverse=True)
    assert max(np.diff([frame for frame, pose in down if pose[0, 1] < 0.8])) <= 8, "nothing in between is left open"
    up = postures([score("A gets up.")], 0, 0, 0, 150, stand, None)
    assert up[-1][0] == 149 and up[-1][1][0, 1] > 0.9
