"""Bodies that move over feet that stay: legs that follow, and hips that sink as far as a leg is too short."""

from __future__ import annotations

import numpy as np
import scipy  # its parts are loaded with their first use
from numpy.typing import NDArray

from .cleaning import solve_two_bones
from .skeleton import LEGS, SMPL22
from .transforms import facing

Array = NDArray[np.floating]

HIPS = [0, *(leg[0] for leg in LEGS)]
"""The pelvis and both hips."""
UPPER = [
    joint for joint in range(SMPL22.num_joints) if joint not in {0, *(joint for leg in LEGS for joint in leg)}
]
"""Joints above the legs."""
_SINKS = 0.06
"""Metres by which a body sinks at most."""
_FLAT = np.array([1.0, 0.0, 1.0])


def over_planted_feet(own: Array, moved: Array) -> Array:
    """A person whose hips and upper body have moved, on legs that end where they ended before.

    Args:
        own: (T, 22, 3) metres, the person before.
        moved: (T, 22, 3), the same with pelvis, hips and the joints above them elsewhere.

    Returns:
        (T, 22, 3) on bones as long as before; what was moved is lowered, smoothly, where a leg would not reach.
    """
    result = np.array(moved)
    result[:, [*UPPER, *HIPS], 1] -= scipy.ndimage.gaussian_filter1d(_sunk(own, moved), 2.0)[:, None]
    forward = facing(own)
    for hip, knee, ankle, toe in LEGS:
        shift = result[:, hip] - own[:, hip]
        bent = own[:, knee] + shift, own[:, ankle] + shift
        result[:, knee], result[:, ankle] = solve_two_bones(result[:, hip], *bent, own[:, ankle], forward)
        result[:, toe] = result[:, ankle] + own[:, toe] - own[:, ankle]
    return result


def _sunk(own: Array, moved: Array) -> Array:
    """(T,) metres by which hips that are ``moved`` (T, 22, 3) go down, so that no leg is too short."""
    sunk = np.zeros(len(own))
    for hip, knee, ankle, _ in LEGS:
        length = np.linalg.norm(own[:, knee] - own[:, hip], axis=-1)
        length += np.linalg.norm(own[:, ankle] - own[:, knee], axis=-1)
        aside = np.linalg.norm((moved[:, hip] - own[:, ankle]) * _FLAT, axis=-1)
        reach = np.sqrt(np.maximum((0.995 * length) ** 2 - aside**2, 0.0))
        sunk = np.maximum(sunk, np.minimum(moved[:, hip, 1] - own[:, ankle, 1] - reach, _SINKS))
    return sunk
