"""People who shake hands reach with the arm, and not with the back."""

from __future__ import annotations

import numpy as np

from motion import SMPL22
from motion.cleaning import solve_two_bones
from motion.touch.upright import backs_straight
from motion.transforms import heading_matrix

J = SMPL22.index
FRAMES = 90
SHAKES = slice(40, 50)


def _pair(bend: float = 0.4) -> np.ndarray:
    """Two people 0.7 m apart whose right hands meet for a while, with upper backs bent forward: (2, 90, 22, 3)."""
    rest = SMPL22.rest_positions()
    rest = rest - rest[:, 1].min() * np.array([0.0, 1.0, 0.0])
    for side, sign in (("left", 1.0), ("right", -1.0)):
        for joint, length in (("elbow", 0.26), ("wrist", 0.51)):
            rest[J(f"{side}_{joint}")] = rest[J(f"{side}_shoulder")] + [0.05 * sign, -length, 0.0]
    share = np.clip((25 - np.abs(np.arange(FRAMES) - 45)) / 12, 0.0, 1.0)
    one = np.tile(rest, (FRAMES, 1, 1))
    above = [j for j in range(22) if rest[j, 1] > rest[J("spine3"), 1] or "elbow" in SMPL22.joint_names[j]]
    above += [J("left_wrist"), J("right_wrist")]
    for t, angle in enumerate(bend * share):
        turn = np.array([[1, 0, 0], [0, np.cos(angle), -np.sin(angle)], [0, np.sin(angle), np.cos(angle)]])
        spine = one[t, J("spine3")]
        one[t, above] = spine + (one[t, above] - spine) @ turn.T
    arm = [J(f"right_{joint}") for joint in ("shoulder", "elbow", "wrist")]
    meets = np.array([0.0, rest[0, 1] + 0.14, 0.32])
    goal = one[:, arm[2]] + share[:, None] * (meets - one[:, arm[2]])
    one[:, arm[1]], one[:, arm[2]] = solve_two_bones(
        *(one[:, joint] for joint in arm), goal, np.array([0.0, -1.0, -0.5])
    )
    return np.stack([one, one @ heading_matrix(np.pi).T + np.array([0.0, 0.0, 0.7])])


def _bend(person: np.ndarray, ahead: float) -> np.ndarray:
    back = person[:, J("neck")] - person[:, J("spine3")]
    return np.arctan2(ahead * back[:, 2], back[:, 1])


def test_backs_are_straight_and_hands_stay_where_they_met() -> None:
    pair = _pair()
    found = backs_straight(pair, np.ones(FRAMES))
    for person, ahead in ((0, 1.0), (1, -1.0)):
        assert _bend(pair[person], ahead)[SHAKES].min() > 0.2
        assert np.abs(_bend(found[person], ahead)[SHAKES]).max() < 0.12
        hands = found[person, SHAKES, J("right_wrist")] - pair[person, SHAKES, J("right_wrist")]
        assert np.linalg.norm(hands, axis=-1).max() < 0.02
        went = (found - pair)[person, SHAKES][:, [J("left_shoulder"), J("right_shoulder")], 2].mean(axis=1)
        assert np.abs(went).max() < 0.01, "the shoulders are as near as before"
    feet = [J(f"{side}_{joint}") for side in ("left", "right") for joint in ("ankle", "foot")]
    np.testing.assert_allclose(found[:, :, feet], pair[:, :, feet], atol=0.01)
    parents, children = (list(ends) for ends in zip(*SMPL22.bones, strict=True))
    lengths = [np.linalg.norm(x[:, :, children] - x[:, :, parents], axis=-1) for x in (pair, found)]
    np.testing.assert_allclose(lengths[1], lengths[0], atol=0.005)


def test_people_who_do_not_shake_hands_stay_as_they_are() -> None:
    pair = _pair()
    pair[1, :, :, 2] += 0.5
    np.testing.assert_array_equal(backs_straight(pair, np.ones(FRAMES)), pair)
