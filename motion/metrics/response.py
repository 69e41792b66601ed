"""The delay of one person's response to the other."""

from __future__ import annotations

import numpy as np
import scipy  # its parts are loaded with their first use
from numpy.typing import NDArray

from motion import Clip, Duet

Array = NDArray[np.floating]

LONGEST_DELAY = 1.5
"""Largest delay in seconds, in either direction."""
ALIKE = 0.3
"""Least correlation of speeds at which one person counts as responding to the other."""
_SMOOTHING = 0.1
"""Seconds; standard deviation of the Gaussian over the speeds."""
_MOVES = 0.05
"""Least standard deviation of a moving person's speed, in m/s; less is noise and breathing."""


def joint_speed(person: Clip) -> Array:
    """(T − 1,) mean speed of a person's joints in m/s, smoothed over 0.1 s."""
    steps = np.diff(person.positions.astype(np.float64), axis=0)
    speed = np.linalg.norm(steps, axis=-1).mean(axis=-1) * person.fps
    return scipy.ndimage.gaussian_filter1d(speed, _SMOOTHING * person.fps, mode="nearest") if len(speed) else speed


def response_delay(duet: Duet) -> float | None:
    """Delay in seconds of the second person's movement after the first's; negative if it precedes it.

    The lag of the highest peak of the cross-correlation of the two speeds, over lags of at most 1.5 s and half the
    motion; each correlation is taken over the overlapping frames (Boker
    et al., "Windowed cross-correlation and peak picking for the analysis of variability in the association
    between behavioral time series", Psychological Methods 2002; used on the motion energy of two people by
    Ramseyer & Tschacher, "Nonverbal synchrony in psychotherapy", J. Consult. Clin. Psychol. 2011).

    Returns:
        None if one of the two hardly moves, or if no lag within those limits has a peak of 0.3 or more.
    """
    first, second = (joint_speed(person) for person in duet.people)
    furthest = min(round(LONGEST_DELAY * duet.fps), len(first) // 2)
    if furthest < 2 or min(first.std(), second.std()) < _MOVES:
        return None
    lags = np.arange(-furthest, furthest + 1)
    alike = np.array([_correlation(first, second, int(lag)) for lag in lags])
    inner = alike[1:-1]
    peaks = 1 + np.flatnonzero((inner >= alike[:-2]) & (inner >= alike[2:]) & (inner >= ALIKE))
    if not len(peaks):
        return None
    return float(lags[peaks[np.argmax(alike[peaks])]] / duet.fps)


def _correlation(first: Array, second: Array, lag: int) -> float:
    """Pearson's, of the first person's speeds and the second's ``lag`` frames later."""
    count = len(first) - abs(lag)
    one = first[max(-lag, 0) : max(-lag, 0) + count]
    other = second[max(lag, 0) : max(lag, 0) + count]
    one, other = one - one.mean(), other - other.mean()
    size = np.sqrt((one @ one) * (other @ other))
    return float(one @ other / size) if size > 1e-12 else 0.0
