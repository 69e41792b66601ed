"""Hands that are held: two people who walk hand in hand, or stand so.

A network that is told where two people walk, and that one hand of each is beside the other, lets the hands glide about
each other. Where the words have the two hold hands, the hands meet between them and stay together, and each elbow is on
its own side.
"""

from __future__ import annotations

import itertools

import numpy as np
import scipy  # its parts are loaded with their first use
from numpy.typing import NDArray

from motion.skeleton import ARMS, SMPL22
from motion.smoothing import eased_marks, without_flicker
from motion.transforms import facing
from motion.vectors import FLAT, unit

from .bending import across, bent_towards

Array = NDArray[np.floating]

APART = 0.075
"""Metres between two wrists whose hands hold each other, palm to palm."""
_NEAR = 0.45
"""Metres between two wrists up to which hands that are to be held can be."""
_EASE, _SHORTEST = 12, 8
"""Frames in which hands come together, and that they are held at least."""
_SMOOTH = 3.0
"""Frames over which the place where hands are held is spread (standard deviation)."""
_REACH = 0.96
"""Share of an arm's length at which a held hand is at most."""
_OUT = 0.6
"""How far an elbow is to its own side, for a metre backwards."""
_SPINE = SMPL22.index("spine3")


def hands_clasped(pair: Array, held: Array) -> Array:
    """Two people who hold each other by the hand.

    Args:
        pair: (2, T, 22, 3) metres on constant bones.
        held: (T,) how far hands are to be held, 0 to 1.

    Returns:
        (2, T, 22, 3) with other elbows and wrists, of those hands alone that are nearest to each other.
    """
    result = np.array(pair, dtype=np.float64)
    if not (held > 0).any():
        return result
    mine, theirs = min(itertools.product(ARMS, ARMS), key=lambda arms: _gap(pair, arms)[held > 0].mean())
    near = without_flicker((_gap(pair, (mine, theirs)) < _NEAR) & (held > 0), _SHORTEST)
    share = held * eased_marks(near, _EASE)
    at = np.flatnonzero(share)
    if not len(at):
        return result
    middle: Array = 0.5 * (pair[0, :, mine[-1]] + pair[1, :, theirs[-1]])
    middle = scipy.ndimage.gaussian_filter1d(middle, _SMOOTH, axis=0, mode="nearest")[at]
    middle = _within_reach(middle, [(pair[p, at], arm) for p, arm in enumerate((mine, theirs))])
    ahead = 0.5 * FLAT * (facing(pair[0]) + facing(pair[1]))
    way = unit((pair[1, at, _SPINE] - pair[0, at, _SPINE]) * FLAT)
    for person, arm, side in ((0, mine, -1.0), (1, theirs, 1.0)):
        shoulder, elbow, wrist = (result[person, at, joint] for joint in arm)
        goal = wrist + share[at, None] * (middle + 0.5 * side * APART * way - wrist)
        pole = across(elbow - shoulder, wrist - shoulder)
        pole += share[at, None] * (_OUT * side * way - ahead[at] - pole)
        bent, met = bent_towards(shoulder, elbow, wrist, goal, pole)
        result[person, at, arm[1]], result[person, at, arm[2]] = bent, met
    return result


def _gap(pair: Array, arms: tuple[tuple[int, ...], tuple[int, ...]]) -> Array:
    """(T,) metres between the wrists of an arm of each."""
    return np.asarray(np.linalg.norm(pair[0, :, arms[0][-1]] - pair[1, :, arms[1][-1]], axis=-1))


def _within_reach(place: Array, people: list[tuple[Array, tuple[int, ...]]]) -> Array:
    """Places (N, 3) drawn in to where two arms both reach them."""
    found = np.array(place)
    for person, (shoulder, elbow, wrist) in (*people, *people):
        length = np.linalg.norm(person[:, elbow] - person[:, shoulder], axis=-1)
        length += np.linalg.norm(person[:, wrist] - person[:, elbow], axis=-1)
        line = found - person[:, shoulder]
        far = np.linalg.norm(line, axis=-1)
        most = _REACH * length - 0.5 * APART
        found = person[:, shoulder] + line * np.minimum(1.0, most / np.maximum(far, 1e-6))[:, None]
    return found
