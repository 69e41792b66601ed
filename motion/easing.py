"""Easing between two states."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray


def smoothstep(value: ArrayLike, low: float = 0.0, high: float = 1.0) -> NDArray[np.floating]:
    """0 up to ``low``, 1 from ``high`` on, and between them 3 s² - 2 s³ of the share s of the way; of any shape."""
    share = np.clip((np.asarray(value) - low) / (high - low), 0.0, 1.0)
    return share * share * (3 - 2 * share)


def minimum_jerk(value: ArrayLike) -> NDArray[np.floating]:
    """0 up to 0, 1 from 1 on, and between them the course of least jerk, 10 s³ - 15 s⁴ + 6 s⁵; of any shape."""
    share = np.clip(np.asarray(value), 0.0, 1.0)
    return share**3 * (10 - 15 * share + 6 * share**2)
