"""Out of the way: a person who is made for another does not stand where that one walks."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from motion.easing import minimum_jerk

Array = NDArray[np.floating]

CLEAR = 0.55
"""Metres between two pelvises that pass each other: two bodies and some air."""
_WALKED_INTO, _WALKS = 0.3, 0.4
"""Metres between two pelvises below which one walks into the other, and metres a second from which people walk: who
stops in front of somebody to embrace them is slower by then."""
_INSIDE = 0.15
"""Metres between two pelvises below which two people are in each other whatever they do."""
_FARTHEST, _STEP = 8.0, 0.05
"""Metres over which a place is looked for, and between two places."""
_DIRECTIONS = 32
_ASIDE, _BACK = 4.0, 6.0
"""What a metre to the side, and one towards the other, counts beside one further away: a person who is addressed
stays in front, unless the other walks on and on."""
_LEAST = 30
"""Frames in which somebody whose first pose is given gets to another place, at least."""


def out_of_the_way(walker: Array, made: Array, fps: float, *, first_pose_given: bool = False) -> Array | None:
    """The way over the floor to a place where the other does not walk into a person.

    Args:
        walker: (T, 22, 3) metres, whose motion is given.
        made: (T, 22, 3) the other person.
        fps: frames a second.
        first_pose_given: their first frame stays; they go to their place before the other comes.

    Returns:
        (T, 3) metres by which the other is moved over the floor; None where nobody walks into them.
    """
    one, other = walker[:, 0, [0, 2]].astype(np.float64), made[:, 0, [0, 2]].astype(np.float64)
    into = _walks_into(one, other, fps)
    if not into.any():
        return None
    share: Array = np.ones(len(one))
    if first_pose_given:
        share = minimum_jerk(np.arange(len(one)) / max(int(np.argmax(into)) - fps / 2, _LEAST))
    ahead = other[0] - one[0]
    along = ahead / max(float(np.linalg.norm(ahead)), 1e-6)
    angles = np.linspace(-np.pi, np.pi, _DIRECTIONS, endpoint=False)
    towards = np.stack([np.cos(angles), np.sin(angles)], axis=-1) @ np.array([along, [-along[1], along[0]]])
    weights = np.hypot(np.cos(angles) * np.where(np.cos(angles) < 0, _BACK, 1.0), _ASIDE * np.sin(angles))
    lengths = np.arange(_STEP, _FARTHEST, _STEP)
    costs = np.outer(lengths, weights)
    for i in np.argsort(costs, axis=None):
        length, way = lengths[i // _DIRECTIONS], towards[i % _DIRECTIONS]
        moved = other + share[:, None] * length * way
        if _is_clear(one, moved, fps):
            return share[:, None] * np.array([length * way[0], 0.0, length * way[1]])
    return None


def _walks_into(one: Array, other: Array, fps: float) -> NDArray[np.bool_]:
    """(T,) whether one (T, 2) walks into the other, or is in them."""
    apart = np.linalg.norm(one - other, axis=-1)
    return (apart < _INSIDE) | ((apart < _WALKED_INTO) & _walking(one, fps))


def _is_clear(one: Array, moved: Array, fps: float) -> bool:
    apart = np.linalg.norm(one - moved, axis=-1)
    return bool((apart[_walking(one, fps)] >= CLEAR).all() and (apart >= _WALKED_INTO).all())


def _walking(one: Array, fps: float) -> NDArray[np.bool_]:
    """(T,) whether a pelvis (T, 2) moves as in a walk, over half a second."""
    reach = max(round(fps / 4), 1)
    frames = np.arange(len(one))
    first, last = np.maximum(frames - reach, 0), np.minimum(frames + reach, len(one) - 1)
    gone = np.linalg.norm(one[last] - one[first], axis=-1)
    return np.asarray(gone * fps / np.maximum(last - first, 1) > _WALKS)
