"""People of different sizes: a motion that was made at an adult's size, with a child in it.

A child is an adult in small: all bones are shorter by one factor, so poses stay as they are. Two children are the whole
scene in small. Beside an adult a child walks over the same floor, with longer steps for its legs, and the adult takes
shorter ones: the ways over the floor, and the distance between the two, shrink by the mean of both sizes. As a foot
that stands is one point of a way, it stands afterwards too. What then no longer meets is brought together by
:mod:`motion.meeting`.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .limbs import limb_length, sink, solve_two_bones
from .meeting import met_again
from .skeleton import LEGS, SMPL22
from .smoothing import begun_before, eased_marks, smoothstep, without_flicker
from .transforms import facing
from .vectors import FLAT

Array = NDArray[np.floating]

_ON_FEET = (0.55, 0.75)
"""Heights in metres of an adult's pelvis up to which the feet go with the body, and from which they stand."""
_LOW = (0.15, 0.4)
"""Heights in metres of an adult's toe up to which a foot belongs to a step, and from which it goes with the body."""
_SINKS = 0.09
"""Metres by which a body sinks at most, as a share of its size, for steps that are long for its legs."""
_STRIDE, _EASED = 8, 4.0
"""Frames to both sides over which the deepest sinking counts, and over which it is smoothed: a walk bobs little."""
_STRAIGHT = 0.985
"""Share of a leg's length that a step uses."""
_LIFTED = 0.12
"""Height in metres of the lower toe of a person who is carried, at the size at which the motion was made."""
_HELD_UP = 0.75
"""Height in metres of the pelvis of a person who is carried, at least: one who lies has their toes up, too."""
_CARRIES = 0.9
"""Metres between the pelvises of a person who carries and the one carried, at most."""
_SHORTEST, _RISES = 12, 10
"""Frames of the shortest lift, which is longer than a jump, and those in which one begins and ends."""
_CHEST = SMPL22.index("spine3")
_TOES = [leg[-1] for leg in LEGS]


def at_sizes(pair: Array, sizes: tuple[float, float]) -> Array:
    """Two people at their own sizes.

    Args:
        pair: (2, T, 22, 3) metres on SMPL22's bones, floor at 0.
        sizes: of a's and b's bones, as shares of SMPL22's.

    Returns:
        (2, T, 22, 3); the very same array for two adults.
    """
    if sizes == (1.0, 1.0):
        return pair
    if sizes[0] == sizes[1]:
        return np.asarray(sizes[0] * pair, dtype=pair.dtype)
    made = np.asarray(pair, dtype=np.float64)
    way = floor_scale(sizes)
    lifted = [_lifted(made[person], made[1 - person]) for person in (0, 1)]
    small = np.stack([_stepping(made[p], sizes[p], way, 1 - lifted[p]) for p in (0, 1)])
    for person in (0, 1):
        if lifted[person].any():
            small[person] += _raised(made, small, person, way) * lifted[person][:, None, None]
    return np.asarray(met_again(made, small, sizes), dtype=pair.dtype)


def of_adults(pair: Array, sizes: tuple[float, float]) -> Array:
    """Two people of other sizes as adults, to go on from: the way back from :func:`at_sizes` but for their hands."""
    if sizes[0] == sizes[1]:
        return np.asarray(pair / sizes[0], dtype=pair.dtype)
    way, own = 1 / floor_scale(sizes), np.asarray(pair, dtype=np.float64)
    free = np.ones(own.shape[1])
    grown = [_stepping(own[person], 1 / size, way, free, now=size) for person, size in enumerate(sizes)]
    return np.asarray(np.stack(grown), dtype=pair.dtype)


def bones_of(sizes: tuple[float, float]) -> Array:
    """(2, 22) lengths of both people's bones in metres."""
    return np.multiply.outer(np.array(sizes), SMPL22.bone_lengths)


def floor_scale(sizes: tuple[float, float]) -> float:
    """Factor by which ways over the floor, from the world's origin, differ from those of two adults."""
    return (sizes[0] + sizes[1]) / 2


def _stepping(own: Array, size: float, way: float, free: Array, now: float = 1.0) -> Array:
    """A person (T, 22, 3) whose bones are ``size`` times as long as ``now``, and who goes ``way`` times as far.

    ``free`` (T,) is 0 where they are carried.
    """
    pelvis = own[:, :1]
    small = pelvis * [way, size, way] + size * (own - pelvis)
    upright = free * smoothstep(pelvis[:, 0, 1] / now, *_ON_FEET)
    goals = []
    for *_, ankle, toe in LEGS:
        steps = (upright * (1 - smoothstep(own[:, toe, 1] / now, *_LOW)))[:, None]
        aside = (own[:, toe] - pelvis[:, 0]) * FLAT
        stood = small[:, toe] + (way - size) * steps * aside
        goals.append(stood + small[:, ankle] - small[:, toe])
    reaches = [_STRAIGHT * limb_length(small, leg)[:, None] for leg in LEGS]
    need = sink([small[:, leg[0]] for leg in LEGS], goals, reaches, _SINKS * size * now)
    small[..., 1] -= (upright * begun_before(need, _STRIDE, _EASED))[:, None]
    return on_legs(small, goals, facing(own))


def on_legs(person: Array, ankles: list[Array], forward: Array) -> Array:
    """A person (T, 22, 3) whose legs end at ``ankles``, two of (T, 3); feet keep their directions."""
    result = person.copy()
    for (hip, knee, ankle, toe), goal in zip(LEGS, ankles, strict=True):
        foot = person[:, toe] - person[:, ankle]
        result[:, knee], result[:, ankle] = solve_two_bones(
            person[:, hip], person[:, knee], person[:, ankle], goal, forward
        )
        result[:, toe] = result[:, ankle] + foot
    return result


def _lifted(own: Array, other: Array) -> Array:
    """(T,) how far a person is in the air beside the other, who stands: 0 to 1."""
    up = (own[:, _TOES, 1].min(axis=1) > _LIFTED) & (own[:, 0, 1] > _HELD_UP)
    stands = other[:, _TOES, 1].min(axis=1) <= _LIFTED
    near = np.linalg.norm((own[:, 0] - other[:, 0]) * FLAT, axis=-1) < _CARRIES
    return eased_marks(without_flicker(up & stands & near, _SHORTEST), _RISES)


def _raised(made: Array, small: Array, person: int, way: float) -> Array:
    """(T, 1, 3) what takes a carried person's chest to where it is for the one who carries them, above the floor."""
    between = made[person, :, _CHEST] - made[1 - person, :, _CHEST]
    goal = small[1 - person, :, _CHEST] + between * [way, 1.0, way]
    shift = goal - small[person, :, _CHEST]
    shift[:, 1] = np.maximum(shift[:, 1], -small[person, :, _TOES, 1].min(axis=0))
    return np.asarray(shift[:, None])
