"""Arms of a gesture: where the elbow is, no hand before the face, and when they are up."""

from __future__ import annotations

import numpy as np
import pytest

from acts.shapes import Gesture
from acts.staging.gestures import GESTURES, _lasts, arm
from acts.staging.poses import upright
from motion import SMPL22

LENGTH = 5.0
TIME = np.arange(0, 150, 2) / 30
AHEAD = np.tile([0.0, 0.0, 1.0], (len(TIME), 1))
HEAD = SMPL22.index("head")
LONG = [SMPL22.bone_lengths[SMPL22.index(f"left_{joint}")] for joint in ("elbow", "wrist")]


def course(hand: str, side: str = "right", *, both: bool = False, length: float = LENGTH) -> np.ndarray:
    gesture = Gesture.model_validate({"gesture": hand, "sides": "both" if both else side})
    return arm(gesture, side, TIME, length, AHEAD)


def palms(made: np.ndarray) -> np.ndarray:
    """(N, 3) middles of the hands, as seen from the head."""
    pose = upright(np.zeros(2), 0.0)
    along = made[:, 1] - made[:, 0]
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    return np.asarray(made[:, 1] + 0.1 * along - (pose[HEAD] - pose[0]))


@pytest.mark.parametrize("side", ["left", "right"])
@pytest.mark.parametrize("hand", ["waves", "beckons", "salutes", "up", "high", "points", "offers", "phone"])
def test_no_gesture_puts_a_hand_before_the_face_or_over_the_head(hand: str, side: str) -> None:
    found = palms(course(hand, side))
    beside = np.abs(found[:, 0]) > 0.08
    below = found[:, 1] < -0.1
    ahead = found[:, 2] > 0.3
    assert (beside | below | ahead).all()


@pytest.mark.parametrize("side", ["left", "right"])
def test_the_hand_of_a_wave_is_beside_the_head_over_the_elbow(side: str) -> None:
    out = 1 if side == "left" else -1
    up = course("waves", side)[(TIME > 1.3) & (TIME < 3.7)]
    shoulder = (upright(np.zeros(2), 0.0)[SMPL22.index(f"{side}_shoulder")])[0]
    assert (out * up[:, 1, 0] > out * shoulder).all(), "no nearer to the middle than the shoulder"
    assert (up[:, 0, 1] < up[:, 1, 1] - 0.1).all(), "the elbow is lower than the hand"
    assert np.ptp(up[:, 1, 0]) > 0.15 and np.ptp(up[:, 0], axis=0).max() < 0.15, "the forearm waves"


@pytest.mark.parametrize("side", ["left", "right"])
def test_the_elbow_of_a_salute_is_out_at_the_side(side: str) -> None:
    out = 1 if side == "left" else -1
    elbow, hand = np.moveaxis(course("salutes", side)[(TIME > 1.3) & (TIME < 3.7)], 1, 0)
    assert (out * (elbow - hand)[:, 0] > 0.15).all() and (elbow[:, 1] > 0.3).all()


@pytest.mark.parametrize("hand", sorted(GESTURES))
def test_arms_have_bones_of_their_length(hand: str) -> None:
    for side in ("left", "right"):
        made = course(hand, side)
        pose = upright(np.zeros(2), 0.0)
        shoulder = pose[SMPL22.index(f"{side}_shoulder")] - pose[0]
        np.testing.assert_allclose(np.linalg.norm(made[:, 0] - shoulder, axis=1), LONG[0], atol=1e-6)
        np.testing.assert_allclose(np.linalg.norm(made[:, 1] - made[:, 0], axis=1), LONG[1], atol=1e-6)


def test_hands_sink_again_after_what_passes_and_stay_up_in_what_is_held() -> None:
    for hand in ("waves", "beckons", "salutes", "claps"):
        begins, sinks, _ = _lasts(Gesture.model_validate({"gesture": hand}), LENGTH)
        assert 0.4 < begins < 1.0 and LENGTH - 1.5 < sinks < LENGTH - 0.5
        assert _lasts(Gesture.model_validate({"gesture": hand}), 2.0)[1] == 2.0, "too short to be seen otherwise"
    for hand in ("up", "points", "offers", "hips"):
        assert _lasts(Gesture.model_validate({"gesture": hand}), LENGTH)[1] == LENGTH


@pytest.mark.parametrize("length", [3.0, 5.0, 8.0])
@pytest.mark.parametrize("times", [1, 2, 5])
def test_hands_clap_as_often_as_it_is_said(times: int, length: float) -> None:
    seconds = np.arange(0, length, 1 / 60)
    ahead = np.tile([0.0, 0.0, 1.0], (len(seconds), 1))
    clapping = Gesture(gesture="claps", sides="both", times=times)
    begins, sinks, _ = _lasts(clapping, length)
    up = (seconds >= begins) & (seconds <= sinks)
    left, right = (arm(clapping, side, seconds, length, ahead)[up, 1] for side in ("left", "right"))
    meet = np.linalg.norm(left - right, axis=1) < 0.22
    assert np.count_nonzero(np.diff(meet.astype(int)) == 1) == times
