"""Gestures in a beat's words, and the way of the hand."""

from __future__ import annotations

import numpy as np
import pytest
from pydantic import ValidationError

from acts import shapes
from acts.staging.gestures import GESTURES, hands_of, wrist
from acts.staging.poses import upright
from motion import SMPL22
from motion.skeleton import SIDES

from .staged_words import score

AHEAD = np.tile([0.0, 0.0, 1.0], (60, 1))
TIME = np.arange(60) / 30


@pytest.mark.parametrize(
    ("sentence", "found"),
    [
        ("Person B backs away while waving with the left hand.", {"b": ("waves", 1)}),
        ("She keeps pointing at him with her right arm as she walks around him.", {"a": ("points", 1)}),
        ("He covers his ears.", {"a": ("ears", 2)}),
        ("Two monks pray.", {"a": ("prays", 2), "b": ("prays", 2)}),
        ("Person A offers a hand, but person B does not take it.", {"a": ("offers", 1)}),
        ("Person A does not offer a hand.", {}),
        # no gesture of a hand in the air
        ("Person A lays a hand on person B's head.", {}),
        ("Person A does not wave.", {}),
        ("They shake hands.", {}),
    ],
)
def test_gestures_are_read(sentence: str, found: dict[str, tuple[str, int]]) -> None:
    assert {who: (g.gesture, len(hands_of(g))) for who, g in score(sentence).gestures.items()} == found


def test_a_named_hand_is_that_hand() -> None:
    assert score("Person A waves with the left hand.").gestures["a"].sides == "left"
    assert score("Person A waves.").gestures["a"].sides == "right"


def test_two_hands_drum_in_turn_as_often_as_said() -> None:
    """One is down where the other is up, twice a second."""
    left, right = (wrist("drums", side, TIME, AHEAD)[:, 1] for side in SIDES)
    assert np.corrcoef(left, right)[0, 1] < -0.9
    peaks = (left[1:-1] > left[:-2]) & (left[1:-1] > left[2:])
    assert peaks.sum() == pytest.approx(4, abs=1)


@pytest.mark.parametrize("shape", [shapes.Gesture, shapes.Figure])
def test_what_no_file_has_is_no_gesture_or_figure(shape: type[shapes.Gesture]) -> None:
    (name,) = set(shape.model_fields) & {"gesture", "figure"}
    with pytest.raises(ValidationError, match="Input should be '"):
        shape.model_validate({name: "flies off"})
    assert len(shape.model_json_schema()["properties"][name]["enum"]) > 20, "the schema lists them"


@pytest.mark.parametrize("side", ["left", "right"])
def test_hands_are_where_the_gesture_has_them(side: str) -> None:
    pose = upright(np.zeros(2), 0.0)
    shoulder = pose[SMPL22.index(f"{side}_shoulder")] - pose[0]

    def way(hand: str) -> np.ndarray:
        return wrist(hand, side, TIME, AHEAD)

    arm = sum(SMPL22.bone_lengths[SMPL22.index(f"{side}_{joint}")] for joint in ("elbow", "wrist"))
    for hand in GESTURES:
        assert np.linalg.norm(way(hand) - shoulder, axis=1).max() < arm, "within the arm's reach"
    assert (way("high")[:, 1] > pose[SMPL22.index("head"), 1] - pose[0, 1]).all()
    assert (way("up")[:, 1] > shoulder[1] + 0.2).all()
    assert (way("ahead")[:, 2] > 0.4).all()
    head = pose[SMPL22.index("head")] - pose[0]
    for hand in ("phone", "ears", "eyes"):
        assert np.linalg.norm(way(hand) - head, axis=1).max() < 0.25, "a hand's length from the head"
    assert (way("points")[:, 2] > 0.4).all()
