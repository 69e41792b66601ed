"""The smooth step between two values."""

from __future__ import annotations

import numpy as np

from motion.easing import smoothstep


def test_it_rests_at_both_ends_and_rises_between() -> None:
    values = smoothstep(np.linspace(-1, 7, 801), 1.0, 5.0)
    assert values.min() == 0 and values.max() == 1 and (np.diff(values) >= 0).all()
    np.testing.assert_allclose(smoothstep(np.array([1.0, 2.0, 3.0, 5.0]), 1.0, 5.0), [0, 0.15625, 0.5, 1])
    slope = np.gradient(values, 0.01)
    assert slope[[200, 600]].max() < 0.01 and abs(slope[400] - 1.5 / 4) < 1e-3


def test_it_falls_where_low_lies_above_high() -> None:
    np.testing.assert_allclose(smoothstep([0.0, 1.0, 2.0, 3.0], 2.0, 1.0), [1, 1, 0, 0])
