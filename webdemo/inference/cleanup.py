"""The end of every generation: constant bones, planted feet and raised toes, reported as such."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from motion import SMPL22
from motion.cleaning import foot_contacts, plant_feet, solve_two_bones
from motion.ground import above_floor
from motion.kinematics import project_to_skeleton
from motion.swings import lift_swinging_feet
from motion.transforms import facing

Array = NDArray[np.floating]

_ARMS = [
    tuple(SMPL22.index(f"{side}_{j}") for j in ("shoulder", "elbow", "wrist")) for side in ("left", "right")
]
_LEGS = [
    tuple(SMPL22.index(f"{side}_{j}") for j in ("hip", "knee", "ankle", "foot")) for side in ("left", "right")
]


def clean_person(positions: Array, fps: float = 30.0) -> Array:
    """One person on SMPL22's constant bones, above the floor, feet planted where they stand, swinging toes raised.

    Bones are made constant by their directions, from the pelvis outwards; wrists and ankles are then taken
    back to their places by two-bone IK, so hands that met still meet.

    Args:
        positions: (T, 22, 3) metres as a network gave them.

    Returns:
        (T, 22, 3) metres.
    """
    result = above_floor(on_constant_bones(positions))
    return lift_swinging_feet(plant_feet(result, foot_contacts(result, fps)), fps)


def on_constant_bones(positions: Array) -> Array:
    """One person (T, 22, 3) on SMPL22's constant bones, frame by frame; see :func:`clean_person`."""
    target = np.asarray(positions, dtype=np.float64)
    result, _ = project_to_skeleton(target)
    forward = facing(result)
    for shoulder, elbow, wrist in _ARMS:
        backwards_and_down = -forward + np.array([0.0, -1.0, 0.0])
        result[:, elbow], result[:, wrist] = solve_two_bones(
            result[:, shoulder], result[:, elbow], result[:, wrist], target[:, wrist], backwards_and_down
        )
    for hip, knee, ankle, toe in _LEGS:
        foot = result[:, toe] - result[:, ankle]
        result[:, knee], result[:, ankle] = solve_two_bones(
            result[:, hip], result[:, knee], result[:, ankle], target[:, ankle], forward
        )
        result[:, toe] = result[:, ankle] + foot
    return result
