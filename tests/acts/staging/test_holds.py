"""Holds of two people, and where their hands are in them."""

from __future__ import annotations

import numpy as np
import pytest

from acts.staging.holds import HOLDS, TWIRL, joined, raised
from acts.staging.poses import upright
from motion import SMPL22

from .staged_words import score

FACING = np.array([[[0.0, 0.0]], [[0.0, 0.5]]])
"""Person a at the origin, facing +Z; person b before them."""
LEFT, RIGHT = 0, 1


@pytest.mark.parametrize(
    ("sentence", "hold", "twirls"),
    [
        ("A couple dances the tango.", "closed", ""),
        ("They take each other by both hands and spin round and round.", "ring", ""),
        ("They push palm against palm.", "palms", ""),
        ("They dance.", "couple", ""),
        ("A walks up to B and hugs B.", "embrace", ""),
        ("Person A dances a tango while person B watches.", "", ""),
        ("He twirls her.", "", "a"),
        ("She spins under his arm.", "", "b"),
        ("They twirl around.", "", ""),
        ("He does not twirl her.", "", ""),
    ],
)
def test_holds_and_twirls_are_read(sentence: str, hold: str, twirls: str) -> None:
    found = score(sentence)
    assert (found.hold, found.twirls) == (hold, twirls)


def test_a_leads_with_the_left_hand_and_has_the_right_on_the_partners_back() -> None:
    hands = joined("closed", FACING)[:, :, 0]
    assert np.linalg.norm(hands[0, LEFT] - hands[1, RIGHT]) < 0.1
    assert hands[0, LEFT][0] > 0.3, "out to a's left side, which is +X"
    assert abs(hands[0, RIGHT][2] - 0.5) < 0.1 and hands[0, RIGHT][1] > 1.0
    assert hands[1, LEFT][1] - hands[0, RIGHT][1] > 0.3, "b's arm lies over a's, and not in it"
    assert abs(hands[1, LEFT][2]) < 0.15 and hands[1, LEFT][0] < -0.1, "on a's right shoulder"


def test_in_an_embrace_all_hands_are_on_the_others_back_one_over_the_other() -> None:
    places = np.array([[[0.0, 0.0]], [[0.0, HOLDS["embrace"].apart]]])
    hands = joined("embrace", places)[:, :, 0]
    for person, side in ((0, 1.0), (1, -1.0)):
        behind = side * (hands[person, :, 2] - places[1 - person, 0, 1])
        assert (behind > 0.1).all() and hands[person, LEFT][1] > hands[person, RIGHT][1] + 0.1
    assert all(move.near == HOLDS["embrace"].apart for move in score("They run up to each other and hug.").moves)


def test_both_hands_are_joined_in_a_ring_wherever_it_has_turned_to() -> None:
    for angle in np.linspace(0, 6, 7):
        ahead = np.array([np.sin(angle), np.cos(angle)])
        places = np.stack([-0.4 * ahead, 0.4 * ahead])[:, None]
        hands = joined("ring", places)[:, :, 0]
        assert np.linalg.norm(hands[0, LEFT] - hands[1, RIGHT]) < 0.1
        assert np.linalg.norm(hands[0, RIGHT] - hands[1, LEFT]) < 0.1
        assert np.linalg.norm(hands[0, LEFT] - hands[0, RIGHT]) > 0.4


def test_the_hands_over_a_twirl_are_above_both_heads_and_in_reach_of_both() -> None:
    places = np.array([[[0.0, 0.0]], [[0.0, TWIRL]]])
    (hand,) = raised(places)
    for person, angle in ((0, 0.0), (1, np.pi)):
        pose = upright(places[person, 0], angle)
        assert hand[1] > pose[SMPL22.index("head"), 1] + 0.1
        assert np.linalg.norm(hand - pose[SMPL22.index("right_shoulder")]) < 0.56


def test_palms_are_against_palms_before_the_shoulders_of_two_who_lean_in_and_do_not_turn() -> None:
    hands = joined("palms", np.array([[[0.0, 0.0]], [[0.0, HOLDS["palms"].apart]]]))[:, :, 0]
    for own, theirs in ((LEFT, RIGHT), (RIGHT, LEFT)):
        assert np.linalg.norm(hands[0, own] - hands[1, theirs]) < 0.15 and hands[0, own][1] > 1.2
    assert HOLDS["palms"].turns == 0 and HOLDS["palms"].lean > 0.2 and HOLDS["ring"].lean == 0
