"""Arms beside the other's body instead of in it."""

from __future__ import annotations

import numpy as np

from motion import SMPL22
from motion.metrics.quality import DEEP, jerk_percentile, limb_depth
from motion.touch.arms import arms_apart
from motion.transforms import heading_matrix

J = SMPL22.index
FRAMES = 40


def _pair(gap: float) -> np.ndarray:
    """Two people face to face whose arms are held out straight, ``gap`` metres apart: (2, T, 22, 3)."""
    rest = SMPL22.standing()
    for side in ("left", "right"):
        shoulder = rest[J(f"{side}_shoulder")]
        for joint, reach in ((f"{side}_elbow", 0.26), (f"{side}_wrist", 0.527)):
            rest[J(joint)] = shoulder + np.array([-0.25 * np.sign(shoulder[0]), -0.1, 0.96]) * reach
    other = rest @ heading_matrix(np.pi).T + np.array([0.05, 0.0, gap])
    other[:, 1] -= 0.06  # arms that lie exactly in each other have no way out
    return np.stack([np.tile(one, (FRAMES, 1, 1)) for one in (rest, other)])


def test_arms_leave_the_other_body() -> None:
    pair = _pair(0.5)
    before = max(limb_depth(pair[0], pair[1]).max(), limb_depth(pair[1], pair[0]).max())
    found = arms_apart(pair)
    after = max(limb_depth(found[0], found[1]).max(), limb_depth(found[1], found[0]).max())
    assert before > 2 * DEEP
    assert after < 0.5 * before


def test_hands_that_hold_each_other_stay() -> None:
    pair = _pair(0.95)
    between = pair[0, 0, J("left_wrist")] - pair[1, 0, J("right_wrist")]
    pair[1] += between * [1, 1, 0] + [0.0, 0.03, 0.0]
    found = arms_apart(pair)
    assert np.abs(found[0, :, J("left_wrist")] - pair[0, :, J("left_wrist")]).max() < 0.003
    assert np.abs(found[1, :, J("right_wrist")] - pair[1, :, J("right_wrist")]).max() < 0.003


def _from_behind() -> np.ndarray:
    """Two people who look the same way, the first with arms through the other's trunk, who come to it and leave it."""
    pair = _pair(0.3)
    pair[1] = SMPL22.standing() + np.array([0.02, 0.0, 0.0])
    for side in ("left", "right"):  # at their sides
        for joint, reach in ((f"{side}_elbow", 0.26), (f"{side}_wrist", 0.5)):
            pair[1, :, J(joint)] = pair[1, :, J(f"{side}_shoulder")] - [0.0, reach, 0.0]
    away = 0.5 + 0.2 * np.cos(2 * np.pi * np.arange(FRAMES) / FRAMES)
    pair[1, :, :, 2] += away[:, None]
    return pair


def test_an_arm_that_has_no_way_out_is_not_thrown_about() -> None:
    pair = _from_behind()
    found = arms_apart(pair)
    assert np.abs(found - pair).max() > 0.02
    assert jerk_percentile(found[0], 30) < 45  # 80 where pushes add up while nothing gives way


def test_elbows_of_hands_that_hold_each_other_leave_each_other() -> None:
    """Two side by side hold hands, and the elbow of one is in the other's arm."""
    pair = _pair(3.0)
    pair[1] = pair[0] + np.array([0.47, 0.0, 0.0])
    hand = pair[0, 0, J("left_shoulder")] + np.array([0.04, -0.44, 0.1])
    for person, side, out in ((0, "left", 0.02), (1, "right", -0.02)):
        shoulder = pair[person, :, J(f"{side}_shoulder")]
        pair[person, :, J(f"{side}_elbow")] = shoulder + np.array([out, -0.2, -0.14])
        pair[person, :, J(f"{side}_wrist")] = hand + np.array([0.06 * person, 0.0, 0.0])
    found = arms_apart(pair)
    depth = [max(limb_depth(x[i], x[1 - i]).max() for i in (0, 1)) for x in (pair, found)]
    assert depth[0] > 0.04
    assert depth[1] < 0.6 * depth[0]
    wrists = np.linalg.norm(found[0, :, J("left_wrist")] - found[1, :, J("right_wrist")], axis=-1)
    assert wrists.max() < 0.1
