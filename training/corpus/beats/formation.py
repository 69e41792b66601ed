"""Two of three dancers who were recorded together."""

from __future__ import annotations

import numpy as np

from motion.kinematics import forward_kinematics
from motion.transforms import canonicalize

from ..compose import FPS, Motion, mirror, motion_from_positions, place, realise
from ..cues import Beat
from ..library import Library
from ..scene import Scene, SourceClip
from ..telling import describe
from .performer import Rng

DANCERS = ("formation-a", "formation-b", "formation-c")


def formation(rng: Rng, library: Library) -> Scene:
    """Two of three dancers, as they were recorded in one formation."""
    chosen = rng.permutation(3)[:2]
    parts = [library.clips(DANCERS[k]) for k in chosen]
    number = int(rng.integers(len(parts[0])))
    a, b = (_in_place(part[number]) for part in parts)
    frames = min(int(rng.uniform(4, 9) * FPS), len(a), len(b))
    for _ in range(12):  # now and then a dancer waits for long
        start = int(rng.integers(0, min(len(a), len(b)) - frames + 1))
        if min(_liveliness(m[start : start + frames]) for m in (a, b)) > 0.35:
            break
    if rng.random() < 0.5:
        a, b = mirror(a), mirror(b)
    positions = canonicalize(np.stack([realise(m[start : start + frames]) for m in (a, b)]))
    sources = tuple(sorted(set(a.sources + b.sources)))
    beats = [Beat(("dance", "dance"), 0, frames, relation="while")]
    return describe(rng, Scene(positions.astype(np.float32), "formation", sources, library.split, played=beats))


def _liveliness(motion: Motion) -> float:
    """Mean speed of the joints against the pelvis, metres a second."""
    body = forward_kinematics(motion.rotations, 0.0 * motion.root)
    return float(np.linalg.norm(np.diff(body, axis=0), axis=-1).mean() * FPS)


def _in_place(clip: SourceClip) -> Motion:
    """The recording where it was made."""
    return place(motion_from_positions(clip.positions, sources=(clip.source,)), *clip.place)
