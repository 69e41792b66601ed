"""Hands that are held stay together, on elbows that are each on their own side."""

from __future__ import annotations

import numpy as np

from motion import SMPL22
from motion.metrics.naturalness import DEEP, limb_depth
from motion.touch.clasped import APART, hands_clasped

J = SMPL22.index
FRAMES = 80
MINE, THEIRS = J("left_wrist"), J("right_wrist")


def _walkers(gap: float = 0.6) -> np.ndarray:
    """Two who stand side by side, the second to the left, whose inner arms swing apart: (2, T, 22, 3)."""
    rest = SMPL22.rest_positions()
    rest = rest - rest[:, 1].min() * np.array([0.0, 1.0, 0.0])
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
    assert (found[0, :, J("left_elbow"), 0] < found[1, :, J("right_elbow"), 0] - 0.09).all()


def test_only_the_nearest_hands_move_and_bones_keep_their_lengths() -> None:
    pair = _walkers()
    found = hands_clasped(pair, np.ones(FRAMES))
    moved = np.abs(found - pair).max(axis=(1, 3)) > 1e-9
    names = [{SMPL22.joint_names[j] for j in np.flatnonzero(person)} for person in moved]
    assert names == [{"left_elbow", "left_wrist"}, {"right_elbow", "right_wrist"}]
    parents, children = (list(ends) for ends in zip(*SMPL22.bones, strict=True))
    lengths = [np.linalg.norm(x[:, :, children] - x[:, :, parents], axis=-1) for x in (pair, found)]
    np.testing.assert_allclose(lengths[1], lengths[0], atol=2e-3)


def test_hands_of_people_who_hold_none_or_are_far_stay() -> None:
    pair = _walkers()
    np.testing.assert_array_equal(hands_clasped(pair, np.zeros(FRAMES)), pair)
    far = _walkers(1.6)
    np.testing.assert_array_equal(hands_clasped(far, np.ones(FRAMES)), far)


def test_hands_come_together_smoothly_where_the_hold_begins() -> None:
    held = np.clip((np.arange(FRAMES) - 20) / 20, 0.0, 1.0)
    found = hands_clasped(_walkers(), held)
    np.testing.assert_array_equal(found[:, :20], _walkers()[:, :20])
    assert np.linalg.norm(np.diff(found[0, :, MINE], axis=0), axis=-1).max() < 0.05
