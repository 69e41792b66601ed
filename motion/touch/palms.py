"""Palms that meet: hands that two people raise against each other, as in a high five.

A motion has no hands beyond the wrists, so a network brings wrist to wrist, and the hands that are drawn beyond them
pass through each other. Where two raised wrists meet, the palms beyond them do instead.
"""

from __future__ import annotations

import itertools

import numpy as np
from numpy.typing import NDArray

from motion.cleaning import solve_two_bones
from motion.skeleton import ARMS, SMPL22
from motion.smoothing import eased_marks, without_flicker

Array = NDArray[np.floating]

PALM = 0.09
"""Metres from a wrist to the middle of the palm, in the direction of the forearm."""
APART = 0.03
"""Metres between the middles of two hands that lie palm to palm."""
_NEAR = 0.2
"""Metres between two wrists up to which hands meet."""
_EASE, _SHORTEST = 10, 3
"""Frames in which hands come to the place where they meet, and that they meet at least."""
_ROUNDS = 3
"""Rounds in which the palms are brought together: a forearm turns as its wrist moves."""
_SPINE = SMPL22.index("spine3")


def palms_met(pair: Array, free: Array | None = None) -> Array:
    """Two people whose palms meet where they raise their hands against each other.

    Args:
        pair: (2, T, 22, 3) metres on constant bones.
        free: (T,) how far a frame may be changed, 0 to 1; wholly by default.

    Returns:
        (2, T, 22, 3) with other elbows and wrists where hands meet.
    """
    result = np.array(pair, dtype=np.float64)
    for mine, theirs in itertools.product(ARMS, ARMS):
        share = eased_marks(without_flicker(_meeting(result, mine[-1], theirs[-1]), _SHORTEST), _EASE)
        share = share if free is None else share * free
        if share.any():
            at = np.flatnonzero(share)
            result[:, at] = _met(result[:, at], mine, theirs, share[at])
    return result


def _meeting(pair: Array, mine: int, theirs: int) -> NDArray[np.bool_]:
    """(T,) frames at which two wrists meet above the chest of both people."""
    near = np.linalg.norm(pair[0, :, mine] - pair[1, :, theirs], axis=-1) < _NEAR
    raised = [pair[i, :, wrist, 1] > pair[i, :, _SPINE, 1] for i, wrist in enumerate((mine, theirs))]
    return np.asarray(near & raised[0] & raised[1])


def _met(pair: Array, mine: tuple[int, ...], theirs: tuple[int, ...], share: Array) -> Array:
    """Some frames (2, N, 22, 3) with the palms of two arms brought together by a ``share`` (N,)."""
    result = pair.copy()
    way = (pair[1, :, _SPINE] - pair[0, :, _SPINE]) * np.array([1.0, 0.0, 1.0])
    way /= np.maximum(np.linalg.norm(way, axis=-1, keepdims=True), 1e-6)
    for _ in range(_ROUNDS):
        gap = _palm(result[1], theirs) - _palm(result[0], mine) - APART * way
        for person, arm, half in ((0, mine, 0.5), (1, theirs, -0.5)):
            shoulder, elbow, wrist = arm
            own = result[person]
            goal = own[:, wrist] + half * share[:, None] * gap
            pole = own[:, elbow] - 0.5 * (own[:, shoulder] + own[:, wrist])
            own[:, elbow], own[:, wrist] = solve_two_bones(
                own[:, shoulder], own[:, elbow], own[:, wrist], goal, pole
            )
    return result


def _palm(person: Array, arm: tuple[int, ...]) -> Array:
    """(N, 3) the middle of a palm."""
    bone = person[:, arm[2]] - person[:, arm[1]]
    return np.asarray(person[:, arm[2]] + PALM * bone / np.linalg.norm(bone, axis=-1, keepdims=True))
