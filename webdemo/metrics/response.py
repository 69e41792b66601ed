"""How long one person takes to answer the other."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d

from webdemo.motion import Clip, Duet

Array = NDArray[np.floating]

LONGEST_DELAY = 1.5
"""Seconds by which one may follow the other, either way round."""
ALIKE = 0.3
"""The correlation of speeds from which two people are said to answer one another."""
_SMOOTHING = 0.1
"""Seconds; standard deviation of the Gaussian over the speeds."""
_MOVES = 0.05
"""m/s by which the speed of somebody who moves varies; below that are noise and breath."""


def joint_speed(person: Clip) -> Array:
    """(T − 1,) mean speed of a person's joints in m/s, smoothed over 0.1 s."""
    steps = np.diff(person.positions.astype(np.float64), axis=0)
    speed = np.linalg.norm(steps, axis=-1).mean(axis=-1) * person.fps
    return gaussian_filter1d(speed, _SMOOTHING * person.fps, mode="nearest") if len(speed) else speed


def response_delay(duet: Duet) -> float | None:
    """Seconds by which the second person's movement follows the first's; negative where it goes before.

    The lag at which the speeds of the two are most alike: the highest peak of their cross-correlation, over
    lags of at most 1.5 s and half the motion, each correlation taken over the frames that both have (Boker
    et al., "Windowed cross-correlation and peak picking for the analysis of variability in the association
    between behavioral time series", Psychological Methods 2002; used on the motion energy of two people by
    Ramseyer & Tschacher, "Nonverbal synchrony in psychotherapy", J. Consult. Clin. Psychol. 2011).

    Returns:
        None where one of the two hardly moves, or no lag within those limits has a peak of 0.3 or more.
    """
    first, second = (joint_speed(person) for person in duet.people)
    furthest = min(round(LONGEST_DELAY * duet.fps), len(first) // 2)
    if furthest < 2 or min(first.std(), second.std()) < _MOVES:
        return None
    lags = np.arange(-furthest, furthest + 1)
    alike = np.array([_correlation(first, second, lag) for lag in lags])
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
