"""People who hug come close, and their hands lie on the other's back."""

from __future__ import annotations

import numpy as np
import pytest

from motion import SMPL22
from motion.kinematics import bone_lengths
from motion.metrics.quality import DEEP, jerk_percentile, limb_depth
from motion.touch.arms import arms_apart, embraced
from motion.transforms import heading_matrix

J = SMPL22.index
FRAMES = 120
SPINE = J("spine3")
HUGS = slice(55, 65)


def _pair(gap: float = 0.55) -> np.ndarray:
    """Two people face to face, ``gap`` metres apart, who raise their arms past the other for a while: (2, T, 22, 3)."""
    rest = SMPL22.standing()
    share = np.clip((30 - np.abs(np.arange(FRAMES) - 60)) / 12, 0.0, 1.0)
    angle = 0.5 * np.pi * share**2 * (3 - 2 * share)
    one = np.tile(rest, (FRAMES, 1, 1))
    for side in ("left", "right"):
        way = np.stack([np.zeros(FRAMES), -np.cos(angle), np.sin(angle)], axis=-1)
        for joint, reach in ((f"{side}_elbow", 0.26), (f"{side}_wrist", 0.52)):
            one[:, J(joint)] = one[:, J(f"{side}_shoulder")] + reach * way
    other = one @ heading_matrix(np.pi).T + np.array([0.0, 0.0, gap])
    return np.stack([one, other])


def test_hands_lie_on_the_back_and_the_flank_and_elbows_bend() -> None:
    found = embraced(_pair())[:, HUGS]
    for person in (0, 1):
        for side, past, length in (("left", 0.0, 0.51), ("right", 0.0, 0.45)):
            shoulder, elbow, wrist = (found[person, :, J(f"{side}_{j}")] for j in ("shoulder", "elbow", "wrist"))
            hand = wrist - found[1 - person, :, SPINE]
            assert ((1 - 2 * person) * hand[:, 2] > past).all(), "past the spine"
            assert (np.linalg.norm(hand[:, [0, 2]], axis=-1) < 0.22).all()
            assert (np.linalg.norm(wrist - shoulder, axis=-1) < length).all()
            assert (np.abs(elbow[:, 0]) > 0.15).all(), "elbows are outside of both"


def test_feet_and_bones_stay_and_nothing_jolts() -> None:
    pair = _pair()
    found = embraced(pair)
    feet = [J(f"{side}_{joint}") for side in ("left", "right") for joint in ("ankle", "foot")]
    np.testing.assert_allclose(found[:, :, feet], pair[:, :, feet], atol=0.01)
    np.testing.assert_allclose(bone_lengths(found), bone_lengths(pair), atol=0.02)
    assert jerk_percentile(found[0], 30) < jerk_percentile(pair[0], 30) + 40


@pytest.mark.parametrize("gap", [0.45, 0.55, 0.65])
def test_arms_go_round_the_other_on_their_way_there_and_back(gap: float) -> None:
    pair = _pair(gap)
    pair[1, :, :, 0] += 0.04
    found = arms_apart(embraced(pair))
    deep = [limb_depth(found[i], found[1 - i])[20:100] > DEEP for i in (0, 1)]
    assert np.mean(deep) < 0.02


def _lifted() -> np.ndarray:
    pair = _pair()
    pair[1, 62:, :, 1] += 0.14
    return pair


def _turned(gap: float = 0.4) -> np.ndarray:
    pair = _pair(gap)
    pair[1] = (pair[1, :1] - [0.0, 0.0, gap]) @ heading_matrix(np.pi).T + [0.0, 0.0, gap]
    pair[0, :, [J("left_wrist"), J("right_wrist")], 1] -= 0.1
    return pair


def _held_from_before() -> np.ndarray:
    """The other faces the person who holds them, with hanging arms."""
    pair = _pair(0.4)
    pair[0, :, [J("left_wrist"), J("right_wrist")], 1] -= 0.1
    for side in ("left", "right"):
        for joint, down in (("elbow", 0.27), ("wrist", 0.52)):
            pair[1, :, J(f"{side}_{joint}")] = pair[1, :, J(f"{side}_shoulder")] - [0.0, down, 0.0]
    return pair


def _hand_in_hand() -> np.ndarray:
    pair = _pair(0.4)
    for left, right in (("left", "right"), ("right", "left")):
        middle = 0.5 * (pair[0, :, J(f"{left}_elbow")] + pair[1, :, J(f"{right}_elbow")])
        pair[0, :, J(f"{left}_wrist")] = pair[1, :, J(f"{right}_wrist")] = middle
    return pair


@pytest.mark.parametrize(
    "pair",
    [_pair(1.2), _lifted(), _turned(0.7), _held_from_before(), _hand_in_hand()],
    ids=["far", "lifted", "hands on the shoulders from behind", "held from before", "hand in hand"],
)
def test_what_is_no_embrace_stays(pair: np.ndarray) -> None:
    np.testing.assert_array_equal(embraced(pair), pair)


def test_who_holds_from_behind_reaches_around_the_waist_under_the_others_arms() -> None:
    pair = _turned()
    found = embraced(pair)[:, HUGS]
    assert np.median(limb_depth(pair[0, HUGS], pair[1, HUGS])) > 0.05
    assert max(limb_depth(found[i], found[1 - i]).max() for i in (0, 1)) < 0.02
    apart = np.linalg.norm((found[0, :, SPINE] - found[1, :, SPINE])[:, [0, 2]], axis=-1)
    assert (apart < 0.33).all()
    for side in ("left", "right"):
        held, upon = (found[i, :, J(f"{side}_wrist")] for i in (0, 1))
        assert (held[:, 2] > found[1, :, SPINE, 2] + 0.04).all(), "the hands are before the other's trunk"
        assert (np.linalg.norm(held - upon, axis=-1) < 0.2).all(), "the other's hands lie on them"
    feet = [J(f"{side}_foot") for side in ("left", "right")]
    np.testing.assert_allclose(found[:, :, feet], pair[:, HUGS][:, :, feet], atol=0.01)
