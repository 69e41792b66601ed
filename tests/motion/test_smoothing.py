"""Paths of least jerk."""

from __future__ import annotations

import numpy as np

from motion.smoothing import REACH, least_jerk, led, smoothstep


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


def test_it_rests_at_both_ends_and_rises_between() -> None:
    values = smoothstep(np.linspace(-1, 7, 801), 1.0, 5.0)
    assert values.min() == 0 and values.max() == 1 and (np.diff(values) >= 0).all()
    np.testing.assert_allclose(smoothstep(np.array([1.0, 2.0, 3.0, 5.0]), 1.0, 5.0), [0, 0.15625, 0.5, 1])
    slope = np.gradient(values, 0.01)
    assert slope[[200, 600]].max() < 0.01 and abs(slope[400] - 1.5 / 4) < 1e-3
