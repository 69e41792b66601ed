"""Paths of least jerk."""

import numpy as np

from motion.smoothing import REACH, frames_from, least_jerk, led


def third(path: np.ndarray) -> float:
    return float(np.abs(np.diff(path, n=3, axis=0)).max())


def test_slow_motion_stays_and_trembling_goes() -> None:
    time = np.arange(150) / 30
    slow = np.sin(2 * np.pi * time)[:, None]
    fast = 0.02 * np.sin(2 * np.pi * 10 * time)[:, None]
    found = least_jerk(slow + fast, np.full(150, 0.3))
    assert np.abs(found - slow)[5:-5].max() < 0.003 < 0.02
    assert third(found) < 0.3 * third(slow + fast)


def test_a_path_keeps_its_fixed_frames_and_starts_from_them_without_a_jolt() -> None:
    path = np.zeros((60, 3))
    path[30:, 0] = 0.05 + 0.02 * np.arange(30)
    fixed = np.arange(60) < 30
    found = led(path, fixed)
    np.testing.assert_array_equal(found[fixed], path[fixed])
    np.testing.assert_array_equal(found[30 + REACH :], path[30 + REACH :])
    assert third(found) < 0.2 * third(path)


def test_nothing_fixed_or_all_fixed_changes_nothing() -> None:
    path = np.random.default_rng(0).normal(size=(20, 3))
    for fixed in (np.zeros(20, bool), np.ones(20, bool)):
        np.testing.assert_array_equal(led(path, fixed), path)
    np.testing.assert_array_equal(least_jerk(path[:3], np.ones(3)), path[:3])


def test_distances_from_marked_frames() -> None:
    assert frames_from(np.array([0, 0, 1, 0, 0, 0, 1], bool)).tolist() == [2, 1, 0, 1, 2, 1, 0]
    assert frames_from(np.zeros(4, bool)).tolist() == [4] * 4
