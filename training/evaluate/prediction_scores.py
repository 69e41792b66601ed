"""Scores of predictions: error at the papers' frames, speed, the seam (thesis, section 2.5.3)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from webdemo.inference.requests.predict import mean_steps

Array = NDArray[np.floating]
Predict = Callable[[Array], Array]
"""(N, past, J, 3) metres → (N, future, J, 3)."""


@dataclass(frozen=True)
class Scores:
    """Of one method on the windows of one action.

    Attributes:
        windows: how many.
        error: (future,) mean distance of joints from the truth at each predicted frame, in millimetres, as the
            papers' tables have it.
        rms: (future,) the thesis' eq. 2.12: root mean square of the distances over joints and all frames so
            far, in millimetres.
        speed: (future,) mean distance per joint and frame (MPJS, eq. 2.13), in millimetres.
        true_speed: the same of the truth.
        seam: share of windows whose first predicted step is at most the largest step of the past.
    """

    windows: int
    error: Array
    rms: Array
    speed: Array
    true_speed: Array
    seam: float


def score(predict: Predict, windows: Array, past: int, *, batch: int = 512) -> Scores:
    """Scores a method on windows (N, past + future, J, 3) in metres."""
    errors, squares, speeds, true_speeds, seams = [], [], [], [], []
    for start in range(0, len(windows), batch):
        part = windows[start : start + batch]
        seen, truth = part[:, :past], part[:, past:]
        made = predict(seen)
        distances = np.linalg.norm(made - truth, axis=-1)
        errors.append(distances.mean(-1))
        so_far = np.arange(1, distances.shape[1] + 1)
        squares.append(np.sqrt(np.square(distances).mean(-1).cumsum(-1) / so_far))
        speeds.append(mean_steps(np.concatenate([seen[:, -1:], made], axis=1)))
        true_speeds.append(mean_steps(part[:, past - 1 :]))
        seams.append(speeds[-1][:, 0] <= mean_steps(seen).max(axis=1) + 1e-6)
    means = (1000 * np.concatenate(x).mean(0) for x in (errors, squares, speeds, true_speeds))
    return Scores(len(windows), *means, float(np.concatenate(seams).mean()))


def zero_velocity(future: int) -> Predict:
    """The last pose, held (Martinez et al.; thesis, section 2.5.3)."""
    return lambda past: np.repeat(past[:, -1:], future, axis=1)


def average(scores: list[Scores]) -> Scores:
    """The mean over actions, each with the same weight, as in the papers' tables."""
    return Scores(
        sum(s.windows for s in scores),
        *(np.mean([getattr(s, name) for s in scores], axis=0) for name in ("error", "rms", "speed", "true_speed")),
        float(np.mean([s.seam for s in scores])),
    )
