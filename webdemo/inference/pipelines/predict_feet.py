"""Feet of a predicted motion that stand where they came down; no torch here."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from motion.cleaning import foot_contacts, plant_feet

Array = NDArray[np.floating]

_BLEND = 5
"""Frames over which a correction fades in and out."""
_FLOOR = 0.1
"""Metres from 0 within which the lowest that a person was must lie to be the floor that they stand on."""
_STILL = 1e-3
"""Metres: a future in which no joint moves farther stands still."""


def with_planted_feet(past: Array, future: Array, fps: float) -> Array:
    """A future whose standing feet do not glide.

    Who stood with a foot at the end of the past goes on standing in the same place; that a foot comes down
    is believed only some frames later, so that its correction can fade in after the seam. People who are not
    on the floor are left alone, and so is one whose first step would grow.

    Args:
        past: (P, T, 22, 3) metres.
        future: (P, F, 22, 3) metres, with the bone lengths of the past's last pose.
        fps: frames a second.

    Returns:
        (P, F, 22, 3) with the same bone lengths.
    """
    made = np.array(future, dtype=np.float64)
    for person, before in enumerate(past.astype(np.float64)):
        floor = np.array([0.0, before[..., 1].min(), 0.0])
        moves = np.abs(made[person] - before[-1]).max() > _STILL
        if abs(floor[1]) > _FLOOR or not moves:
            continue
        before, after = before - floor, made[person] - floor
        contacts = foot_contacts(np.concatenate([before, after]), fps)[len(before) - 1 :]
        stood, contacts = contacts[0], contacts[1:]
        contacts[:_BLEND] = contacts[:_BLEND] & stood
        # The last pose, held for as long as the future, outvotes it where a contact's place is sought.
        held = np.repeat(before[-1:], len(after), axis=0)
        whole = plant_feet(
            np.concatenate([held, after]),
            np.concatenate([np.repeat(stood[None], len(after), axis=0), contacts]),
            blend=_BLEND,
            held=np.arange(2 * len(after)) < len(after),
        )
        planted = whole[len(after) :]
        if _step(before[-1], planted[0]) <= max(_step(before[-1], after[0]), _largest_step(before)):
            made[person] = planted + floor
    return made


def _step(before: Array, after: Array) -> float:
    """Mean distance of the joints (22, 3) of two poses."""
    return float(np.linalg.norm(after - before, axis=-1).mean())


def _largest_step(positions: Array) -> float:
    return float(np.linalg.norm(np.diff(positions, axis=0), axis=-1).mean(-1).max())
