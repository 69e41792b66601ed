"""Sight: what a person's face points to, along a ray from between the eyes.

A thing counts with the box around it: who looks through a window looks at it.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from motion.body import bone_rotations
from motion.skeleton import SMPL22
from motion.vectors import Array

from .thing import Thing

EYES = np.array([0.0, 0.07, 0.1])
"""Metres from the joint of the head to between the eyes, in the head's frame."""
ROUND = 0.1
"""Metres of flesh about the joints of a person who stands in the way."""
FARTHEST = 8.0
"""Metres beyond which nothing is looked at."""
_HEAD = SMPL22.index("head")


def gazes(positions: Array) -> tuple[Array, Array]:
    """The eyes (T, 3) of a person (T, 22, 3) and the directions (T, 3) in which the face points."""
    turned = bone_rotations(np.asarray(positions, dtype=np.float64))[:, _HEAD]
    return positions[:, _HEAD] + turned @ EYES, turned @ np.array([0.0, 0.0, 1.0])


def distances(eyes: Array, ways: Array, low: Array, high: Array) -> Array:
    """(T,) metres along rays to where they enter boxes; infinite where they do not.

    Args:
        eyes, ways: (T, 3) where the rays begin, and their unit directions.
        low, high: (3,) or (T, 3) opposite corners of the boxes, whose sides lie along the axes.
    """
    ways = np.where(np.abs(ways) < 1e-9, 1e-9, ways)
    planes = np.stack([low - eyes, high - eyes]) / ways
    enters, leaves = planes.min(axis=0).max(axis=-1), planes.max(axis=0).min(axis=-1)
    return np.where((enters <= leaves) & (leaves > 0), np.maximum(enters, 0.0), np.inf)


def looked_at(things: Sequence[Thing], person: Array, other: Array) -> NDArray[np.integer]:
    """The number of the thing that a person's face points to in each frame.

    Args:
        things: beside them.
        person: (T, 22, 3) metres, who looks.
        other: (T, 22, 3) metres, who may be in the way.

    Returns:
        (T,) an index into ``things``, ``len(things)`` for the other person, and -1 for nothing.
    """
    eyes, ways = gazes(person)
    far = []
    for thing in things:  # met in its own frame
        turned = thing.rotations.astype(np.float64)
        own = [np.einsum("ti,tij->tj", each, turned) for each in (eyes - thing.places, ways)]
        far.append(distances(own[0], own[1], thing.mesh.vertices.min(axis=0), thing.mesh.vertices.max(axis=0)))
    far.append(distances(eyes, ways, other.min(axis=1) - ROUND, other.max(axis=1) + ROUND))
    return np.where(np.min(far, axis=0) <= FARTHEST, np.argmin(far, axis=0), -1)
