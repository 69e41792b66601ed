"""Motion joined smoothly to frames that are given, led through single poses, and the end of a loop to its beginning.

Only frames beside the join move. There the sum of squared third differences is least (Flash and Hogan 1985), so that
place, speed and acceleration go on; how far a frame may depart from what was made follows from its distance.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from motion import FPS, SMPL22
from motion.cleaning import foot_contacts, plant_feet
from motion.kinematics import bone_vectors, chained, followed_rotations, rotation_matrices
from motion.vectors import Array

Frames = NDArray[np.integer]

REACH = 15
"""Frames beside a join that may move, half a second."""
_AGAIN = (8, 5)
"""The same where a loop is smoothed again, after its feet were planted and after they were raised to the floor."""
_SLACK = 1e-4
"""Weight of what was made right beside a join, against the squared third difference. It grows geometrically to 1 where
nothing may move any more: beside the join little above 1 Hz is kept, in the end all up to 5 Hz."""
PASSING = 12
"""Frames beside a single pose that may move."""
_PASSING_SLACK = 1e-3
"""As :data:`_SLACK`, beside a single pose."""
_CALM, _QUIET = 30.0, 0.8
"""Weights of accelerations, and of the limbs' speeds, that should vanish where a loop closes."""


def joined(
    positions: Array,
    frames: Frames,
    given: Array,
    *,
    reach: int = REACH,
    slack: float = _SLACK,
    held: NDArray[np.bool_] | None = None,
) -> Array:
    """Positions (T, 22, 3) that are ``given`` (N, 22, 3) at ``frames`` (N,) but for planted feet, and lead there.

    Only frames within ``reach`` of a given one are smoothed. Feet that stand at given frames stay there.

    Args:
        positions: metres, on bones of constant lengths.
        frames: different frames, in any order.
        given: metres.
        reach: frames beside a given one that may move.
        slack: weight of what was made right beside one, see :data:`_SLACK`.
        held: (T,) further frames that must stay.
    """
    wanted = np.array(positions, dtype=np.float64)
    wanted[frames] = given
    away = np.abs(np.arange(len(wanted))[:, None] - frames).min(1)
    stays = np.zeros(len(wanted), dtype=bool) if held is None else held
    free = np.flatnonzero((away > 0) & (away <= reach) & ~stays)
    turned = _turned(wanted, free, away[free], reach=reach, slack=slack)
    return plant_feet(turned, foot_contacts(turned, FPS), held=stays | (away == 0))


def passing(positions: Array, frames: Frames, given: Array, held: NDArray[np.bool_]) -> Array:
    """As :func:`joined`, through single poses without a jolt; the frames of these need not be among those held.

    A pose alone says nothing about speed, so what is made on both sides of it is smoothed over :data:`PASSING` frames.
    Places are smoothed rather than rotations, which a limb that is nearly straight leaves open.
    """
    return joined(positions, frames, given, reach=PASSING, slack=_PASSING_SLACK, held=held)


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
    loop: Array = np.roll(np.asarray(positions, dtype=np.float64), middle, axis=0)
    for reach in (REACH, *_AGAIN):
        free = np.flatnonzero((away <= min(reach, middle - 2)) & moves)
        loop = _turned(loop, free, away[free], closes=middle, reach=reach)
        stand = foot_contacts(loop, FPS) & (reach == REACH)  # later feet are only raised to the floor
        loop = plant_feet(loop, stand, held=~np.isin(time, free))
    return np.roll(loop, -middle, axis=0)


def _turned(
    positions: Array, free: Frames, away: Array, *, closes: int | None = None, reach: int = REACH, slack: float = _SLACK
) -> Array:
    """Positions (T, 22, 3) with the path of the pelvis and the bones' rotations smoothed at the frames ``free``.

    Quaternions are smoothed: the mean of two of them is a rotation between both even after nearly a full turn, but the
    mean of two matrices that are half a turn apart is none.
    """
    if not len(free):
        return positions
    turns = followed_rotations(positions)
    flat = turns.reshape(len(positions), -1)
    smooth = _smoothed(flat, free, away, closes=closes, reach=reach, rests=True, slack=slack)[free]
    change = rotation_matrices(smooth.reshape(-1, *turns.shape[1:])) @ np.swapaxes(
        rotation_matrices(turns[free]), -1, -2
    )
    turned = positions.copy()
    roots = _smoothed(positions[:, 0], free, away, closes=closes, reach=reach, slack=slack)[free]
    bones = change[:, SMPL22.parents[1:]] @ bone_vectors(positions[free])[..., None]
    turned[free] = chained(roots, bones[..., 0])
    return turned


def _smoothed(
    values: Array,
    free: Frames,
    away: Array,
    *,
    closes: int | None,
    reach: int,
    rests: bool = False,
    slack: float = _SLACK,
) -> Array:
    """Values (T, N) whose frames ``free`` (M,) were moved so that third differences are small.

    Args:
        values: metres, or entries of quaternions.
        free: frames that may move.
        away: (M,) their distances from the join in frames, from 1.
        closes: the first frame of a loop that closes there.
        reach: distance up to which frames move.
        rests: whether speeds vanish there, too.
        slack: weight of the values themselves right beside the join.
    """
    meets = free[0] if closes is None else closes
    # Frames farther away have no part in the differences of those that move.
    first = max(0, min(free[0], meets) - 3)
    near = values[first : max(free[-1], meets) + 4]
    inside, unit = free - first, np.eye(len(near))
    costs = [np.diff(unit, n=3, axis=0)]
    if closes is not None:
        costs.append(np.sqrt(_CALM) * np.diff(unit, n=2, axis=0)[meets - first - 2 : meets - first])
        if rests:
            costs.append(np.sqrt(_QUIET) * np.diff(unit, axis=0)[meets - first - 2 : meets - first + 1])
    cost = np.concatenate(costs)
    moving, weights = cost[:, inside], slack ** (1 - away / (reach + 1))
    rest = cost @ near - moving @ near[inside]
    smooth = values.copy()
    smooth[free] = np.linalg.solve(
        moving.T @ moving + np.diag(weights), weights[:, None] * values[free] - moving.T @ rest
    )
    return smooth
