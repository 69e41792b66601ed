"""How planned a motion looks."""

import numpy as np
import pytest

from motion import SMPL22
from motion.metrics.naturalness import limb_depth, naturalness
from motion.transforms import turn

FPS = 30.0
REST = SMPL22.rest_positions() + np.array([0, 0.98, 0])


def stands(frames: int = 60) -> np.ndarray:
    return np.repeat(REST[None], frames, axis=0)


def test_somebody_who_glides_has_no_standing_foot() -> None:
    assert naturalness(stands(), FPS).standing_foot == 0.0
    gliding = stands() + 0.3 / FPS * np.arange(60)[:, None, None] * np.array([0, 0, 1.0])
    assert naturalness(gliding, FPS).standing_foot == pytest.approx(30, abs=0.1)


def test_of_somebody_who_walks_only_the_slower_foot_counts() -> None:
    walking = stands()
    walking[:, [SMPL22.index("left_ankle"), SMPL22.index("left_foot")], 2] += np.arange(60)[:, None] / FPS
    assert naturalness(walking, FPS).standing_foot == 0.0


@pytest.mark.parametrize("angle", [0.0, 1.0])
def test_arms_that_do_the_same_mirror_each_other(angle: float) -> None:
    both, one = stands(), stands()
    wave = 0.2 * np.sin(np.arange(60) / 4)
    left, right = SMPL22.index("left_wrist"), SMPL22.index("right_wrist")
    for motion, sides in ((both, (left, right)), (one, (left,))):
        motion[:, sides, 1] += wave[:, None]
    assert naturalness(turn(both, angle), FPS).mirror_gap == pytest.approx(0, abs=0.5)
    assert naturalness(turn(one, angle), FPS).mirror_gap == pytest.approx(100 * np.abs(wave).mean(), abs=0.5)


@pytest.mark.parametrize(("hertz", "slow"), [(0.5, True), (3.0, False)])
def test_slow_arms_have_their_energy_under_one_hertz(hertz: float, slow: bool) -> None:
    motion = stands(121)
    wrist = SMPL22.index("left_wrist")
    motion[:, wrist, 1] += 0.2 * np.sin(2 * np.pi * hertz * np.arange(121) / FPS)
    assert (naturalness(motion, FPS).slow_arms > 0.5) == slow


@pytest.mark.parametrize(("angle", "share"), [(0.8, 0.0), (1.3, 0.5), (-2.5, 0.5)])
def test_a_trunk_that_is_twisted_against_the_hips_is_seen(angle: float, share: float) -> None:
    motion = turn(stands(), 2.0)
    trunk = [
        i for i, name in enumerate(SMPL22.joint_names) if not any(p in name for p in ("hip", "knee", "ankle", "foot"))
    ]
    motion[30:, trunk] = turn(motion[30:], angle)[:, trunk]
    assert naturalness(motion, FPS).twisted == pytest.approx(share)


def test_a_jolt_and_a_fast_joint_are_seen() -> None:
    motion = stands()
    motion[30, SMPL22.index("left_elbow"), 0] += 0.3
    found = naturalness(motion, FPS)
    assert found.fastest == pytest.approx(9.0, abs=0.1)
    motion = stands() + 0.01 * np.random.default_rng(0).normal(size=(60, 22, 3))
    assert naturalness(motion, FPS).jerk > 500 > naturalness(stands(), FPS).jerk


def test_a_forearm_in_the_other_trunk_is_deep_and_a_hand_that_is_held_is_not() -> None:
    one, other = stands(4), turn(stands(4), np.pi) + np.array([0, 0, 0.6])
    assert limb_depth(one, other).max() == 0.0
    spine = other[:, SMPL22.index("spine3")]
    one[2:, SMPL22.index("left_wrist")] = spine[2:]
    one[2:, SMPL22.index("left_elbow")] = spine[2:] - np.array([0, 0, 0.26])
    assert (limb_depth(one, other) > 0.02).tolist() == [False, False, True, True]
    assert naturalness(one, FPS, other).deep == 0.5
    assert np.isnan(naturalness(one, FPS).deep)
