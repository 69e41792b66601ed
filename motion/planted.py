"""Bodies that move over feet that stay: legs that follow, and hips that sink as far as a leg is too short."""

from __future__ import annotations

import numpy as np
import scipy  # its parts are loaded with their first use
from numpy.typing import NDArray

from motion.vectors import FLAT

from .cleaning import solve_two_bones
from .heels import heel_raised
from .skeleton import LEGS, SMPL22
from .transforms import facing

Array = NDArray[np.floating]

HIPS = [0, *(leg[0] for leg in LEGS)]
"""The pelvis and both hips."""
UPPER = [joint for joint in range(SMPL22.num_joints) if joint not in {0, *(joint for leg in LEGS for joint in leg)}]
"""Joints above the legs."""
_SINKS = 0.06
"""Metres by which a body sinks at most."""
_MOST = 0.995
"""Share of a leg's length that it reaches."""


def over_planted_feet(own: Array, moved: Array) -> Array:
    """A person whose hips and upper body have moved, on legs that end where they ended before.

    Args:
        own: (T, 22, 3) metres, the person before.
        moved: (T, 22, 3), the same with pelvis, hips and the joints above them elsewhere.

    Returns:
        (T, 22, 3) on bones as long as before; where a leg would not reach, the heel of a foot behind rises, and what
        was moved is lowered, smoothly.
    """
    result = np.array(moved)
    reaches = [
        _MOST * sum(np.linalg.norm(own[:, end] - own[:, start], axis=-1, keepdims=True) for start, end in bones)
        for bones in ((leg[:2], leg[1:3]) for leg in LEGS)
    ]
    ankles = [
        heel_raised(moved[:, leg[0]], own[:, leg[2]], own[:, leg[3]], reach)
        for leg, reach in zip(LEGS, reaches, strict=True)
    ]
    sunk = scipy.ndimage.gaussian_filter1d(_sunk(moved, ankles, reaches), 2.0)
    result[:, [*UPPER, *HIPS], 1] -= sunk[:, None]
    forward = facing(own)
    for (hip, knee, ankle, toe), goal in zip(LEGS, ankles, strict=True):
        shift = result[:, hip] - own[:, hip]
        bent = own[:, knee] + shift, own[:, ankle] + shift
        result[:, knee], result[:, ankle] = solve_two_bones(result[:, hip], *bent, goal, forward)
        result[:, toe] = result[:, ankle] + own[:, toe] - goal
    return result


def _sunk(moved: Array, ankles: list[Array], reaches: list[Array]) -> Array:
    """(T,) metres by which hips that are ``moved`` (T, 22, 3) go down, so that no leg is too short."""
    sunk = np.zeros(len(moved))
    for leg, ankle, most in zip(LEGS, ankles, reaches, strict=True):
        hip = moved[:, leg[0]]
        aside = np.linalg.norm((hip - ankle) * FLAT, axis=-1)
        reach = np.sqrt(np.maximum(most[:, 0] ** 2 - aside**2, 0.0))
        sunk = np.maximum(sunk, np.minimum(hip[:, 1] - ankle[:, 1] - reach, _SINKS))
    return sunk
