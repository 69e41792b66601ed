"""Stretches of time: runs of frames in which something holds, as (T,) masks of truth values."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from motion.vectors import runs

Mask = NDArray[np.bool_]

PAUSE = 0.2
"""Seconds for which something may stop holding and still count as going on."""


def stretches(mask: Mask, fps: float, *, pause: float = PAUSE) -> list[tuple[int, int]]:
    """(first frame, one past the last) of a mask's runs; runs less than ``pause`` seconds apart are one."""
    found: list[tuple[int, int]] = []
    for start, stop in runs(np.asarray(mask)):
        if found and start - found[-1][1] < pause * fps:
            found[-1] = (found[-1][0], stop)
        else:
            found.append((start, stop))
    return found


def keep(mask: Mask, fps: float, holds: Callable[[int, int], bool], *, pause: float = PAUSE) -> Mask:
    """The stretches of a mask of which ``holds(start, stop)`` is true, pauses filled in."""
    kept = np.zeros(len(mask), dtype=bool)
    for start, stop in stretches(mask, fps, pause=pause):
        if holds(start, stop):
            kept[start:stop] = True
    return kept


def longest(mask: Mask, fps: float) -> float:
    """Seconds of the longest stretch."""
    return max((stop - start for start, stop in stretches(mask, fps)), default=0) / fps
