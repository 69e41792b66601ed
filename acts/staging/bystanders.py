"""People who stand by, as recorded: how the weight shifts, where the head turns, what the arms do meanwhile.

The network alone lets them freeze. The seed chooses a recording and where it begins (acts/recordings/CARD.md); where it
ends, it is played back to its beginning.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from motion import FPS
from motion.transforms import heading, heading_matrix

Array = NDArray[np.floating]
Frames = NDArray[np.integer]

RATE = 10
"""Poses a second of a recording."""
_FILE = Path(__file__).parents[1] / "recordings" / "idle.npz"


@cache
def recordings() -> tuple[Array, ...]:
    """The recordings, (T, 22, 3) metres each at :data:`RATE`, around the origin and facing +Z in the mean."""
    found = []
    with np.load(_FILE, allow_pickle=False) as kept:
        for name in sorted(kept.files):
            poses = kept[name] / 1000.0
            facing = heading(poses)
            mean = float(np.arctan2(np.sin(facing).mean(), np.cos(facing).mean()))
            found.append((poses - poses[:, :1].mean(0) * [1.0, 0.0, 1.0]) @ heading_matrix(-mean).T)
    return tuple(found)


def standing_by(place: Array, angle: float | Array, frames: Frames, seed: int) -> Array:
    """A person who stands by.

    Args:
        place: (2,) or (N, 2) x and z in metres, around which the pelvis sways.
        angle: heading, or (N,) headings, in radians from +Z towards +X.
        frames: (N,) frames of the scene.
        seed: chooses the recording, and where it begins.

    Returns:
        (N, 22, 3) metres.
    """
    dice, known = np.random.default_rng([seed, 2]), recordings()
    poses = known[int(dice.integers(len(known)))]
    at = dice.uniform(0, len(poses)) + np.asarray(frames) * RATE / FPS
    last = len(poses) - 1
    at = last - np.abs(at % (2 * last) - last)  # to its end and back
    before = np.minimum(at.astype(int), last - 1)
    share = (at - before)[:, None, None]
    mixed = (1 - share) * poses[before] + share * poses[before + 1]
    turns = heading_matrix(np.broadcast_to(angle, len(mixed)))
    return np.einsum("nij,nkj->nki", turns, mixed) + np.insert(np.atleast_2d(place), 1, 0.0, axis=1)[:, None]
