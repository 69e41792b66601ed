"""Bodies beside each other instead of in each other."""

from __future__ import annotations

import numpy as np
import pytest

from motion import SMPL22
from motion.metrics.naturalness import DEEP, jerk_percentile, limb_depth, standing_foot
from motion.planted import UPPER
from motion.touch.apart import bodies_apart
from motion.transforms import heading_matrix

J = SMPL22.index
FRAMES = 90
FEET = [J(f"{side}_{joint}") for side in ("left", "right") for joint in ("ankle", "foot")]


def _pair(gap: float, aside: float = 0.0, turned: float = np.pi) -> np.ndarray:
    """Two people with hanging arms, the second ``gap`` metres ahead and ``aside``: (2, T, 22, 3)."""
    rest = SMPL22.rest_positions()
    rest = rest - rest[:, 1].min() * np.array([0.0, 1.0, 0.0])
    for side in ("left", "right"):
        for joint, down in (("elbow", 0.26), ("wrist", 0.52)):
            rest[J(f"{side}_{joint}")] = rest[J(f"{side}_shoulder")] - [0.0, down, 0.0]
    other = rest @ heading_matrix(turned).T + np.array([aside, 0.0, gap])
    return np.stack([np.tile(one, (FRAMES, 1, 1)) for one in (rest, other)])


def _deepest(pair: np.ndarray) -> float:
    return float(max(limb_depth(pair[i], pair[1 - i]).max() for i in (0, 1)))


@pytest.mark.parametrize(
    ("gap", "aside", "turned"), [(0.16, 0.03, np.pi), (0.02, 0.36, 0.0)], ids=["face to face", "beside"]
)
def test_bodies_and_feet_move_apart_on_bones_as_long_as_before(gap: float, aside: float, turned: float) -> None:
    pair = _pair(gap, aside, turned)
    found = bodies_apart(pair, 30.0)
    assert _deepest(pair) > 2 * DEEP
    assert _deepest(found) < DEEP
    parents, children = (list(ends) for ends in zip(*SMPL22.bones, strict=True))
    lengths = [np.linalg.norm(x[:, :, children] - x[:, :, parents], axis=-1) for x in (pair, found)]
    np.testing.assert_allclose(lengths[1], lengths[0], atol=2e-3)


def test_feet_that_stand_do_not_slide_when_the_other_comes_for_a_while() -> None:
    pair = _pair(0.6)
    pair[1, :, :, 2] -= 0.44 * np.exp(-(((np.arange(FRAMES) - 45) / 12) ** 2))[:, None]
    found = bodies_apart(pair, 30.0)
    assert _deepest(pair) > 2 * DEEP > 2 * _deepest(found)
    assert np.abs(np.diff(found[0][:, FEET], axis=0)).max() < 1e-3
    assert standing_foot(found[0], 30.0) < 0.1
    assert jerk_percentile(found[0], 30.0) < 20


def test_trunks_that_touch_part_over_feet_that_stay() -> None:
    pair = _pair(0.4)
    pair[1, :, UPPER, 2] -= 0.2
    found = bodies_apart(pair, 30.0)
    chests = np.linalg.norm((found[0] - found[1])[:, J("spine3")], axis=-1)
    assert chests.min() > 0.22
    np.testing.assert_allclose(found[:, :, FEET], pair[:, :, FEET], atol=0.03)


@pytest.mark.parametrize("what", ["far", "carried", "lying"])
def test_people_who_do_not_stand_in_each_other_stay(what: str) -> None:
    pair = _pair(0.8 if what == "far" else 0.1)
    pair[1, :, :, 1] += {"far": 0.0, "carried": 0.3, "lying": -0.4}[what]
    np.testing.assert_array_equal(bodies_apart(pair, 30.0), pair)


def test_what_may_not_change_stays() -> None:
    pair = _pair(0.16)
    free = (np.arange(FRAMES) >= 45).astype(float)
    found = bodies_apart(pair, 30.0, np.zeros(FRAMES))
    np.testing.assert_array_equal(found, pair)
    assert np.abs(bodies_apart(pair, 30.0, free)[:, 60:] - pair[:, 60:]).max() > 0.01


def test_a_kick_ends_at_the_other_body() -> None:
    pair = _pair(0.75)
    share = np.clip((12 - np.abs(np.arange(FRAMES) - 45)) / 8, 0.0, 1.0)[:, None]
    hip = pair[0, :, J("right_hip")]
    for joint, there in (("right_knee", [0.0, 0.12, 0.34]), ("right_ankle", [0.02, 0.2, 0.68])):
        pair[0, :, J(joint)] += share * (hip + np.array(there) - pair[0, :, J(joint)])
    toe = pair[0, :, J("right_ankle")] + np.array([0.0, 0.12, 0.04])
    pair[0, :, J("right_foot")] += share * (toe - pair[0, :, J("right_foot")])
    found = bodies_apart(pair, 30.0)
    assert limb_depth(pair[0], pair[1]).max() > 0.08
    assert limb_depth(found[0], found[1]).max() < DEEP
    assert found[0, 45, J("right_ankle"), 2] > 0.4, "it still goes as far as the body"
