"""Hands that two people raise against each other meet palm to palm."""

from __future__ import annotations

import numpy as np

from motion import SMPL22
from motion.touch.palms import APART, GRIP, PALM, palms_met
from motion.transforms import heading_matrix

J = SMPL22.index
FRAMES = 60
MEETS = slice(27, 34)


def _pair(height: float = 0.2) -> np.ndarray:
    """Two people face to face who bring their right wrists together, ``height`` metres over the shoulder."""
    rest = SMPL22.rest_positions()
    rest = rest - rest[:, 1].min() * np.array([0.0, 1.0, 0.0])
    share = np.clip((16 - np.abs(np.arange(FRAMES) - 30)) / 12, 0.0, 1.0)[:, None]
    one = np.tile(rest, (FRAMES, 1, 1))
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
    np.testing.assert_allclose(after, APART, atol=0.015)
    ahead = (_palms(found)[1] - _palms(found)[0])[MEETS, 2]
    assert (ahead > 0).all(), "neither hand is past the other"
    for ends in (("right_shoulder", "right_elbow"), ("right_elbow", "right_wrist")):
        lengths = [np.linalg.norm(x[:, :, J(ends[1])] - x[:, :, J(ends[0])], axis=-1) for x in (pair, found)]
        np.testing.assert_allclose(lengths[1], lengths[0], atol=1e-6)


def _shaking() -> np.ndarray:
    """Two people face to face whose right wrists meet before their waists."""
    pair = _pair(-0.3)
    held = np.clip((24 - np.abs(np.arange(FRAMES) - 30)) / 12, 0.0, 1.0)[:, None]
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
    np.testing.assert_allclose(after, APART, atol=0.02)
    wrists = np.linalg.norm(found[0, :, J("right_wrist")] - found[1, :, J("right_wrist")], axis=-1)
    assert wrists[MEETS].min() > 0.1, "each hand ends at the other's wrist"
    aside = (_palms(found, GRIP)[1] - _palms(found, GRIP)[0])[MEETS, 0]
    assert (aside > 0.015).all(), "right palms lie to the left of each other"


def test_hands_that_meet_below_the_chest_stay() -> None:
    pair = _pair(-0.3)
    np.testing.assert_array_equal(palms_met(pair), pair)
