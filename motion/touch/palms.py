"""Palms that meet: hands that two people raise against each other, as in a high five, or shake.

A motion has no hands beyond the wrists, so a network brings wrist to wrist, and the hands that are drawn beyond them
pass through each other. Where two wrists meet, raised or with forearms that point at each other, the palms beyond
them do instead.
"""

from __future__ import annotations

import itertools

import numpy as np
from numpy.typing import NDArray

from motion.cleaning import solve_two_bones
from motion.skeleton import ARMS, SMPL22
from motion.smoothing import eased_marks, without_flicker
from motion.vectors import FLAT, unit

Array = NDArray[np.floating]
Arm = tuple[int, ...]

PALM, GRIP = 0.09, 0.07
"""Metres from a wrist along the forearm to the middle of the palm, and to where hands grip each other."""
APART = 0.042
"""Metres between the middles of two hands that lie palm to palm."""
_NEAR = 0.2
"""Metres between two wrists up to which hands meet."""
_EASE, _SHORTEST, _SHAKEN = 10, 3, 12
"""Frames in which hands come to the place where they meet, that they meet at least, and that they are shaken."""
_ROUNDS = 3
"""Rounds in which the palms are brought together: a forearm turns as its wrist moves."""
_SOFT = 0.06
"""Share of an arm's length before its end that is used up ever more slowly: a straight arm jolts its elbow."""
_AGAINST = -0.2
"""Cosine between two forearms that point at each other, at most."""
_SPINE = SMPL22.index("spine3")


def palms_met(pair: Array, free: Array | None = None) -> Array:
    """Two people whose palms meet where they raise their hands against each other, or shake them.

    Args:
        pair: (2, T, 22, 3) metres on constant bones.
        free: (T,) how far a frame may be changed, 0 to 1; wholly by default.

    Returns:
        (2, T, 22, 3) with other elbows and wrists where hands meet.
    """
    result = np.array(pair, dtype=np.float64)
    way = unit((result[1, :, _SPINE] - result[0, :, _SPINE]) * FLAT)
    for mine, theirs in itertools.product(ARMS, ARMS):
        aside = _aside(way, mine, theirs)
        against, clasped = (
            without_flicker(meets(result, mine, theirs), shortest)
            for meets, shortest in ((_raised, _SHORTEST), (shaken, _SHAKEN))
        )
        for meets, line, palm in ((against, way, PALM), (clasped, aside, GRIP)):
            share = eased_marks(meets, _EASE)
            share = share if free is None else share * free
            if share.any():
                at = np.flatnonzero(share)
                result[:, at] = _met(result[:, at], mine, theirs, share[at], APART * line[at], palm)
    return result


def _raised(pair: Array, mine: Arm, theirs: Arm) -> NDArray[np.bool_]:
    """(T,) frames at which two wrists meet above the chest of both people."""
    near = np.linalg.norm(pair[0, :, mine[-1]] - pair[1, :, theirs[-1]], axis=-1) < _NEAR
    raised = [pair[i, :, arm[-1], 1] > pair[i, :, _SPINE, 1] for i, arm in enumerate((mine, theirs))]
    return np.asarray(near & raised[0] & raised[1])


def shaken(pair: Array, mine: Arm, theirs: Arm) -> NDArray[np.bool_]:
    """(T,) frames at which two wrists meet, not both above the chest, whose forearms point at each other."""
    near = np.linalg.norm(pair[0, :, mine[-1]] - pair[1, :, theirs[-1]], axis=-1) < _NEAR
    ahead = [_forearm(pair[i], arm) for i, arm in enumerate((mine, theirs))]
    against = np.einsum("ti,ti->t", *ahead) < _AGAINST
    return np.asarray(near & against & ~_raised(pair, mine, theirs))


def _aside(way: Array, mine: Arm, theirs: Arm) -> Array:
    """(T, 3) where the other's palm lies from one's own in a handshake; above it, where a right hand holds a left."""
    if mine != theirs:
        return np.tile([0.0, 1.0, 0.0], (len(way), 1))
    left = np.stack([way[:, 2], np.zeros(len(way)), -way[:, 0]], axis=-1)
    return left if mine == ARMS[1] else -left


def _met(pair: Array, mine: Arm, theirs: Arm, share: Array, apart: Array, palm: float) -> Array:
    """Some frames (2, N, 22, 3) with the palms of two arms brought to be ``apart`` (N, 3) by a ``share`` (N,).

    A palm is so many metres beyond the wrist.
    """
    result = pair.copy()
    for _ in range(_ROUNDS):
        gap = _palm(result[1], theirs, palm) - _palm(result[0], mine, palm) - apart
        for person, arm, half in ((0, mine, 0.5), (1, theirs, -0.5)):
            shoulder, elbow, wrist = arm
            own = result[person]
            goal = own[:, wrist] + half * share[:, None] * gap
            away = unit(own[:, shoulder] - result[1 - person, :, shoulder])  # where a straight arm bends
            pole = own[:, elbow] - 0.5 * (own[:, shoulder] + own[:, wrist]) + 1e-3 * away
            own[:, elbow], own[:, wrist] = solve_two_bones(
                own[:, shoulder], own[:, elbow], own[:, wrist], goal, pole, soft=_SOFT
            )
    return result


def _forearm(person: Array, arm: Arm) -> Array:
    """(N, 3) the direction in which a forearm points."""
    return unit(person[:, arm[2]] - person[:, arm[1]])


def _palm(person: Array, arm: Arm, palm: float) -> Array:
    """(N, 3) the middle of a palm, so many metres beyond the wrist."""
    return np.asarray(person[:, arm[2]] + palm * _forearm(person, arm))
