"""People who wait are alive: they sway, breathe and look, over feet that stay, and only where nothing else goes on."""

from __future__ import annotations

import numpy as np
import pytest

from motion import SMPL22
from motion.idling import alive
from motion.metrics.quality import jerk_percentile, slow_arms
from motion.transforms import heading_matrix

J = SMPL22.index
FPS, FRAMES = 30.0, 240
FEET = [J(f"{side}_{joint}") for side in ("left", "right") for joint in ("ankle", "foot")]


def _standing() -> np.ndarray:
    """(22, 3) a person who stands facing +Z with hanging arms, knees a little bent."""
    pose = SMPL22.rest_positions().copy()
    pose -= pose[:, 1].min() * np.array([0.0, 1.0, 0.0])
    for side, sign in (("left", 1.0), ("right", -1.0)):
        shoulder = pose[J(f"{side}_shoulder")]
        for joint, reach in (("elbow", 0.26), ("wrist", 0.51)):
            pose[J(f"{side}_{joint}")] = shoulder + reach * np.array([0.17 * sign, -0.985, 0.03])
        pose[J(f"{side}_knee"), 2] += 0.03
    return pose


def _pair(gap: float = 1.5) -> np.ndarray:
    """Two statues face to face, ``gap`` metres apart: (2, T, 22, 3)."""
    one = np.tile(_standing(), (FRAMES, 1, 1))
    return np.stack([one, one @ heading_matrix(np.pi).T + np.array([0.0, 0.0, gap])])


def _bones(pair: np.ndarray) -> np.ndarray:
    parents, children = (list(ends) for ends in zip(*SMPL22.bones, strict=True))
    return np.linalg.norm(pair[..., children, :] - pair[..., parents, :], axis=-1)


def test_a_statue_sways_as_recorded_people_do_over_feet_that_stay() -> None:
    pair = _pair()
    found = alive(pair, FPS, seed=3)
    np.testing.assert_allclose(found[:, :, FEET], pair[:, :, FEET], atol=1e-3)
    np.testing.assert_allclose(_bones(found), _bones(pair), atol=1e-3)
    for person in found:
        assert 0.01 < np.ptp(person[:, 0, 0]) < 0.11, "weight goes from side to side"
        assert np.ptp(person[:, J("left_wrist")], axis=0).max() < 0.3
        assert slow_arms(person, FPS) > 0.5
        assert jerk_percentile(person, FPS) < 15


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_head_follows_somebody_who_walks_round(sign: float) -> None:
    pair = _pair()
    angle = sign * np.linspace(0, np.pi / 2, FRAMES)
    place = 2 * np.stack([np.sin(angle), np.zeros(FRAMES), np.cos(angle)], axis=-1)
    pair[1] = _standing() + place[:, None]
    found = alive(pair, FPS, seed=1)[0]
    face = found[:, J("head")] - found[:, J("neck")]
    assert sign * (face[-20:, 0].mean() - face[:20, 0].mean()) > 0.02


def test_people_who_walk_touch_or_may_not_be_changed_stay_as_they_are() -> None:
    pair = _pair()
    walks = pair.copy()
    walks[0, :, :, 0] += np.linspace(0, 8, FRAMES)[:, None]
    np.testing.assert_allclose(alive(walks, FPS)[0], walks[0], atol=1e-6)
    touches = pair.copy()
    touches[0, :, J("left_wrist")] = touches[1, :, J("head")] + [0.0, 0.0, -0.1]
    np.testing.assert_allclose(alive(touches, FPS), touches, atol=1e-6)
    np.testing.assert_array_equal(alive(pair, FPS, free=np.zeros((2, FRAMES))), pair)


def test_hands_of_somebody_who_sits_stay_where_they_lie() -> None:
    pair = _pair()
    pair[0, :, :, 1] -= 0.4
    hands = [J("left_wrist"), J("right_wrist")]
    found = alive(pair, FPS, seed=5)
    np.testing.assert_allclose(found[0][:, hands], pair[0][:, hands], atol=0.01)
    assert np.ptp(found[0, :, J("left_shoulder")], axis=0).max() > 0.005, "the chest breathes and turns"


def test_arms_that_have_nothing_to_do_lie_still_on_a_body_that_rests() -> None:
    pair = _pair()
    time = np.arange(FRAMES) / FPS
    for joint, far in (("elbow", 0.03), ("wrist", 0.1)):
        pair[0, :, J(f"left_{joint}"), 2] += far * np.sin(2 * np.pi * 1.3 * time)
    loose = np.ones(pair.shape[:2])
    speeds = []
    for laid in (None, loose):
        hand = alive(pair, FPS, 1, loose=laid)[0, 40:-40, J("left_wrist")]
        speeds.append(np.linalg.norm(np.diff(hand, axis=0), axis=-1).mean() * FPS)
    assert speeds[1] < 0.25 * speeds[0]
    hand = alive(pair, FPS, 1, loose=loose)[0, :, J("left_wrist")]
    assert np.linalg.norm(np.diff(hand[-8:], axis=0), axis=-1).max() * FPS < 0.15, "it comes to rest"
    walks = pair.copy()
    walks[0, :, :, 0] += np.linspace(0, 8, FRAMES)[:, None]
    np.testing.assert_allclose(alive(walks, FPS, loose=loose)[0], walks[0], atol=1e-6)
