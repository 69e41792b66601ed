"""Hands that are held stay together, on elbows that are each on their own side."""

from __future__ import annotations

import numpy as np

from motion import SMPL22
from motion.kinematics import bone_lengths
from motion.limbs import solve_two_bones
from motion.metrics.quality import DEEP, limb_depth
from motion.touch.hands import APART, GRIP, PALM, PALMS_APART, backs_straight, hands_clasped, palms_met
from motion.transforms import heading_matrix

J = SMPL22.index
FRAMES = 80
MINE, THEIRS = J("left_wrist"), J("right_wrist")


def _walkers(gap: float = 0.6) -> np.ndarray:
    """Two who stand side by side, the second to the left, whose inner arms swing apart: (2, T, 22, 3)."""
    rest = SMPL22.standing()
    pair = np.stack([np.tile(one, (FRAMES, 1, 1)) for one in (rest, rest + np.array([gap, 0.0, 0.0]))])
    angle = 0.35 * np.sin(np.arange(FRAMES) / 5)
    for person, swings in ((0, angle), (1, -angle)):
        way = np.stack([np.zeros(FRAMES), -np.cos(swings), np.sin(swings)], axis=-1)
        for side in ("left", "right"):
            for joint, reach in ((f"{side}_elbow", 0.25), (f"{side}_wrist", 0.48)):
                pair[person, :, J(joint)] = pair[person, :, J(f"{side}_shoulder")] + reach * way
    return pair


def test_held_hands_stay_together_and_arms_out_of_each_other() -> None:
    pair = _walkers()
    found = hands_clasped(pair, np.ones(FRAMES))
    gap = np.linalg.norm(found[0, :, MINE] - found[1, :, THEIRS], axis=-1)
    assert np.linalg.norm(pair[0, :, MINE] - pair[1, :, THEIRS], axis=-1).max() > 0.3
    np.testing.assert_allclose(gap, APART, atol=0.01)
    assert max(limb_depth(found[i], found[1 - i]).max() for i in (0, 1)) < DEEP
    assert (found[0, :, J("left_elbow"), 0] < found[1, :, J("right_elbow"), 0] - 0.2).all()


PALM_FRAMES = 60
MEETS = slice(27, 34)


def _pair(height: float = 0.2) -> np.ndarray:
    """Two people face to face who bring their right wrists together, ``height`` metres over the shoulder."""
    rest = SMPL22.standing()
    share = np.clip((16 - np.abs(np.arange(PALM_FRAMES) - 30)) / 12, 0.0, 1.0)[:, None]
    one = np.tile(rest, (PALM_FRAMES, 1, 1))
    shoulder = rest[J("right_shoulder")]
    for joint, down, up in (
        ("right_elbow", [0.0, -0.26, 0.0], [-0.05, -0.05, 0.25]),
        ("right_wrist", [0.0, -0.52, 0.0], [0.17, height, 0.3]),
    ):
        one[:, J(joint)] = shoulder + (1 - share) * down + share * up
    other = one @ heading_matrix(np.pi).T + np.array([0.0, 0.0, 2 * (shoulder[2] + 0.3)])
    return np.stack([one, other])


def _palms(pair: np.ndarray, palm: float = PALM) -> np.ndarray:
    bone = pair[:, :, J("right_wrist")] - pair[:, :, J("right_elbow")]
    return pair[:, :, J("right_wrist")] + palm * bone / np.linalg.norm(bone, axis=-1, keepdims=True)


def test_palms_meet_where_wrists_did_and_bones_stay() -> None:
    pair = _pair()
    found = palms_met(pair)
    before, after = (np.linalg.norm(np.subtract(*_palms(x)), axis=-1)[MEETS] for x in (pair, found))
    assert before.min() > 0.06
    np.testing.assert_allclose(after, PALMS_APART, atol=0.015)
    ahead = (_palms(found)[1] - _palms(found)[0])[MEETS, 2]
    assert (ahead > 0).all(), "neither hand is past the other"
    for ends in (("right_shoulder", "right_elbow"), ("right_elbow", "right_wrist")):
        lengths = [np.linalg.norm(x[:, :, J(ends[1])] - x[:, :, J(ends[0])], axis=-1) for x in (pair, found)]
        np.testing.assert_allclose(lengths[1], lengths[0], atol=1e-6)


def _shaking() -> np.ndarray:
    """Two people face to face whose right wrists meet before their waists."""
    pair = _pair(-0.3)
    held = np.clip((24 - np.abs(np.arange(PALM_FRAMES) - 30)) / 12, 0.0, 1.0)[:, None]
    middle = np.array([0.0, 1.1, 0.5 * pair[1, 0, 0, 2]])
    for person, sign in ((0, 1.0), (1, -1.0)):
        shoulder = pair[person, :, J("right_shoulder")]
        for joint, down, there in (
            ("right_elbow", 0.26, shoulder + np.array([-0.02 * sign, -0.24, 0.09 * sign])),
            ("right_wrist", 0.5, middle - np.array([0.0, 0.0, 0.03 * sign])),
        ):
            hanging = shoulder - np.array([0.0, down, 0.0])
            pair[person, :, J(joint)] = hanging + held * (there - hanging)
    return pair


def test_palms_lie_side_by_side_where_hands_are_shaken() -> None:
    pair = _shaking()
    found = palms_met(pair)
    before, after = (np.linalg.norm(np.subtract(*_palms(x, GRIP)), axis=-1)[MEETS] for x in (pair, found))
    assert before.min() > 0.05
    np.testing.assert_allclose(after, PALMS_APART, atol=0.02)
    wrists = np.linalg.norm(found[0, :, J("right_wrist")] - found[1, :, J("right_wrist")], axis=-1)
    assert wrists[MEETS].min() > 0.1, "each hand ends at the other's wrist"
    aside = (_palms(found, GRIP)[1] - _palms(found, GRIP)[0])[MEETS, 0]
    assert (aside > 0.015).all(), "right palms lie to the left of each other"


BACK_FRAMES = 90
SHAKES = slice(40, 50)


def _bowed(bend: float = 0.4) -> np.ndarray:
    """Two people 0.7 m apart whose right hands meet for a while, with upper backs bent forward: (2, 90, 22, 3)."""
    rest = SMPL22.standing()
    for side, sign in (("left", 1.0), ("right", -1.0)):
        for joint, length in (("elbow", 0.26), ("wrist", 0.51)):
            rest[J(f"{side}_{joint}")] = rest[J(f"{side}_shoulder")] + [0.05 * sign, -length, 0.0]
    share = np.clip((25 - np.abs(np.arange(BACK_FRAMES) - 45)) / 12, 0.0, 1.0)
    one = np.tile(rest, (BACK_FRAMES, 1, 1))
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
    pair = _bowed()
    found = backs_straight(pair, np.ones(BACK_FRAMES))
    for person, ahead in ((0, 1.0), (1, -1.0)):
        assert _bend(pair[person], ahead)[SHAKES].min() > 0.2
        assert np.abs(_bend(found[person], ahead)[SHAKES]).max() < 0.12
        hands = found[person, SHAKES, J("right_wrist")] - pair[person, SHAKES, J("right_wrist")]
        assert np.linalg.norm(hands, axis=-1).max() < 0.02
        went = (found - pair)[person, SHAKES][:, [J("left_shoulder"), J("right_shoulder")], 2].mean(axis=1)
        assert np.abs(went).max() < 0.01, "the shoulders are as near as before"
    feet = [J(f"{side}_{joint}") for side in ("left", "right") for joint in ("ankle", "foot")]
    np.testing.assert_allclose(found[:, :, feet], pair[:, :, feet], atol=0.01)
    np.testing.assert_allclose(bone_lengths(found), bone_lengths(pair), atol=0.005)
