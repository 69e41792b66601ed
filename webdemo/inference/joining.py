"""Motion joined smoothly to frames that are given, led through single poses, and the end of a loop to its beginning.

Only frames beside the join move. There the sum of squared third differences is least (Flash and Hogan 1985), so that
place, speed and acceleration go on; how far a frame may depart from what was made follows from its distance.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from motion.cleaning import foot_contacts, plant_feet
from motion.kinematics import fit_rotations, forward_kinematics, project_to_skeleton

from .actor import FPS

Array = NDArray[np.floating]
Frames = NDArray[np.integer]

REACH = 15
"""Frames beside a join that may move, half a second."""
_AGAIN = 5
"""The same where a loop is smoothed once more, after its feet were planted."""
_SLACK = 1e-4
"""Weight of what was made right beside a join, against the squared third difference. It grows geometrically to 1 where
nothing may move any more: beside the join little above 1 Hz is kept, in the end all up to 5 Hz."""
PASSING = 12
"""Frames beside a single pose that may move."""
_PASSING_SLACK = 1e-3
"""As :data:`_SLACK`, beside a single pose."""
_CALM, _QUIET = 30.0, 0.8
"""Weights of accelerations, and of the limbs' speeds, that should vanish where a loop closes."""
_ROUNDS = 2


def joined(positions: Array, frames: Frames, given: Array) -> Array:
    """Positions (T, 22, 3) that are ``given`` (N, 22, 3) at ``frames`` (N,) but for planted feet, and lead there.

    Only frames within :data:`REACH` of a given one are smoothed. Feet that stand at given frames stay there.

    Args:
        positions: metres, on bones of constant lengths.
        frames: different frames, in any order.
        given: metres.
    """
    wanted = np.array(positions, dtype=np.float64)
    wanted[frames] = given
    away = np.abs(np.arange(len(wanted))[:, None] - frames).min(1)
    free = np.flatnonzero((away > 0) & (away <= REACH))
    found = _turned(wanted, free, away[free])
    return plant_feet(found, foot_contacts(found, FPS), held=away == 0)


def passing(positions: Array, frames: Frames, given: Array, held: NDArray[np.bool_]) -> Array:
    """Positions (T, 22, 3) that pass through single poses, ``given`` (N, 22, 3) at ``frames`` (N,), without a jolt.

    A pose alone says nothing about speed, so what is made on both sides of it is smoothed over :data:`PASSING` frames.
    Places are smoothed rather than rotations, which a limb that is nearly straight leaves open.

    Args:
        positions: metres, on bones of constant lengths.
        frames: different frames, in any order.
        given: metres.
        held: (T,) frames that must stay; the poses' own need not be among them.
    """
    wanted = np.array(positions, dtype=np.float64)
    wanted[frames] = given
    away = np.abs(np.arange(len(wanted))[:, None] - frames).min(1)
    free = np.flatnonzero((away > 0) & (away <= PASSING) & ~held)
    found = _straightened(wanted, free, away[free], PASSING, slack=_PASSING_SLACK)
    return plant_feet(found, foot_contacts(found, FPS), held=held | (away == 0))


def closed(positions: Array, fixed: Frames) -> Array:
    """A loop of one person (T, 22, 3): its end meets its beginning in place and speed.

    Where a loop closes, the hips go on at an even speed and the limbs nearly rest.

    Args:
        positions: metres, on bones of constant lengths.
        fixed: (K,) frames that must stay.
    """
    total, middle = len(positions), len(positions) // 2
    time = np.arange(total)
    away = np.abs(time + 0.5 - middle) + 0.5  # 1 at the first frame and the last, which lie in the middle
    moves = ~np.isin((time - middle) % total, fixed)
    given: Array = np.roll(np.asarray(positions, dtype=np.float64), middle, axis=0)
    found = given
    for reach in (REACH, _AGAIN):
        free = np.flatnonzero((away <= min(reach, middle - 2)) & moves)
        found = _turned(found, free, away[free], closes=middle, reach=reach)
        for _ in range(_ROUNDS):
            found = _straightened(found, free, away[free], reach, closes=middle)
        if reach == REACH:
            found = plant_feet(found, foot_contacts(found, FPS), held=~np.isin(time, free))
    found = plant_feet(found, np.zeros((total, 4), dtype=bool))  # only up to the floor
    found[~moves] = given[~moves]
    return np.roll(found, -middle, axis=0)


def _turned(
    positions: Array, free: Frames, away: Array, *, closes: int | None = None, reach: int = REACH
) -> Array:
    """Positions (T, 22, 3) with the path of the pelvis and the joints' rotations smoothed at the frames ``free``."""
    if not len(free):
        return positions
    rotations, pelvis = fit_rotations(positions), positions[:, 0]
    way = _smoothed(pelvis, free, away, closes=closes, reach=reach)[free]
    flat = rotations.reshape(len(positions), -1)
    turns = _smoothed(flat, free, away, closes=closes, reach=reach, rests=True)[free]
    u, _, vt = np.linalg.svd(turns.reshape(len(free), -1, 3, 3))
    u[..., -1] *= np.linalg.det(u @ vt)[..., None]  # a rotation, not a reflection
    found = positions.copy()
    found[free] += forward_kinematics(u @ vt, way) - forward_kinematics(rotations[free], pelvis[free])
    return found


def _straightened(
    positions: Array,
    free: Frames,
    away: Array,
    reach: int,
    *,
    closes: int | None = None,
    slack: float = _SLACK,
) -> Array:
    """Smooths places where rotations could not be told apart, and brings them back onto constant bones."""
    if not len(free):
        return positions
    pelvis = positions[:, :1]
    limbs: Array = (positions - pelvis).reshape(len(positions), -1)
    limbs = _smoothed(limbs, free, away, closes=closes, reach=reach, rests=True, slack=slack)
    way = _smoothed(pelvis[:, 0], free, away, closes=closes, reach=reach, slack=slack)
    found = positions.copy()
    found[free] = project_to_skeleton((limbs.reshape(positions.shape) + way[:, None])[free])[0]
    return found


def _smoothed(
    values: Array, free: Frames, away: Array, *, closes: int | None, reach: int, rests: bool = False,
    slack: float = _SLACK,
) -> Array:  # fmt: skip
    """Values (T, N) whose frames ``free`` (M,) were moved so that third differences are small.

    Args:
        values: metres, or entries of rotation matrices.
        free: frames that may move.
        away: (M,) their distances from the join in frames, from 1.
        closes: the first frame of a loop that closes there.
        reach: distance up to which frames move.
        rests: whether speeds vanish there, too.
        slack: weight of the values themselves right beside the join.
    """
    unit = np.eye(len(values))
    costs = [np.diff(unit, n=3, axis=0)]
    if closes is not None:
        costs.append(np.sqrt(_CALM) * np.diff(unit, n=2, axis=0)[closes - 2 : closes])
        if rests:
            costs.append(np.sqrt(_QUIET) * np.diff(unit, axis=0)[closes - 2 : closes + 1])
    cost = np.concatenate(costs)
    moving, weights = cost[:, free], slack ** (1 - away / (reach + 1))
    rest = cost @ values - moving @ values[free]
    found = values.copy()
    found[free] = np.linalg.solve(
        moving.T @ moving + np.diag(weights), weights[:, None] * values[free] - moving.T @ rest
    )
    return found
