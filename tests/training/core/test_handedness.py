"""Which hand leads, which image a sentence gets, and what a sentence wants to touch."""

import numpy as np
import pytest

from motion import SMPL22
from training.core.handedness import leading_hand, mirrored
from training.trainers.touch import examples, touch_of


def waving(side: str, metres: float = 0.5) -> np.ndarray:
    """(2, 60, 22, 3): person a moves one wrist up and down, b stands."""
    rest = SMPL22.rest_positions() + np.array([0, 0.98, 0])
    people = np.broadcast_to(rest, (2, 60, 22, 3)).copy()
    wave = metres * (0.5 + 0.5 * np.sin(np.arange(60) / 5))
    people[0, :, SMPL22.index(f"{side}_wrist"), 1] += wave
    return people


@pytest.mark.parametrize("side", ["left", "right"])
def test_the_hand_that_moves_leads(side):
    assert leading_hand(waving(side), None) == side
    assert leading_hand(waving(side, 0.1), {}) is None


def test_a_touch_tells_more_than_the_movement():
    touch = {"a": "right_wrist", "b": "left_shoulder", "start": 3, "end": 9}
    assert leading_hand(waving("left"), {"contact": [touch]}) == "right"
    assert leading_hand(waving("left"), {"contact": [touch, touch | {"a": "left_wrist"}]}) is None


def test_a_sentence_without_a_side_gets_the_right_hand():
    for draw in (0.1, 0.9):
        assert mirrored("Two people shake hands.", "left", draw)
        assert not mirrored("Two people shake hands.", "right", draw)
        assert mirrored("They shake left hands.", "left", draw) == (draw < 0.5)
        assert mirrored("Two people walk.", None, draw) == (draw < 0.5)


def test_captions_stand_for_the_touch_that_is_shown():
    row = {
        "captions": ["They shake hands.", "They shake right hands."],
        "hand": "right",
        "events": {"contact": [{"a": "right_wrist", "b": "right_wrist"}]},
    }
    right, left = (("right_wrist", "right_wrist"),), (("left_wrist", "left_wrist"),)
    assert touch_of(row, mirror=True) == left
    assert examples([row]) == [
        ("They shake hands.", right),
        ("They shake left hands.", left),
        ("They shake right hands.", right),
    ]
    assert touch_of({"events": {"contact": [{"a": "right_wrist", "b": "spine3"}]}}, mirror=True) == (
        ("left_wrist", "spine3"),
    )


def test_the_captions_of_a_beat_stand_for_what_touches_in_it():
    beats = [
        {"start": 0, "end": 40, "captions": ["They shake hands."]},
        {"start": 40, "end": 90, "captions": ["They bow."]},
    ]
    touch = {"a": "right_wrist", "b": "right_wrist", "start": 20, "end": 35}
    row = {"captions": ["They shake hands and bow."], "hand": "right", "events": {"contact": [touch]}, "beats": beats}
    right = (("right_wrist", "right_wrist"),)
    assert examples([row]) == [("They bow.", ()), ("They shake hands and bow.", right), ("They shake hands.", right)]
