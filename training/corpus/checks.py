"""Checks that a composed scene must pass before it enters the corpus."""

from __future__ import annotations

import re

import numpy as np

from motion import FPS
from motion.skeleton import FEET, SMPL22
from motion.vectors import Array

from .cues import Scene

TRUNK = tuple(SMPL22.index(name) for name in ("pelvis", "spine1", "spine2", "spine3", "neck", "head"))
_FLYING = (
    "run jump jumping dance spin crawl somersault cartwheel kick push fall cheer chase throw rage swing punch "
    "shadow skip lie shoot squats"
)
FLYING = frozenset(_FLYING.split())
"""First words of entries during which nobody stands on a foot, or pivots on it."""


def allowed_skate(scene: Scene) -> float:
    """Foot skate allowed in a scene, metres a second."""
    acts = {name.split("-")[0] for beat in scene.beats for cue in beat["acts"] for name in re.split("[>+]", cue)}
    if "run" in acts or "chase" in acts:
        return 0.8
    return 0.3 if acts & FLYING or scene.family == "salsa" else 0.15


def slower_foot(positions: Array) -> float:
    """Mean speed over the ground, in metres a second, of the slower foot joint of a person (T, 22, 3).

    In walking and standing at least one heel or toe rests at any time, so this is near 0 without sliding;
    frames in which no foot is low (flight) are left out.
    """
    speed = np.linalg.norm(np.diff(positions[:, list(FEET)][..., [0, 2]], axis=0), axis=-1) * FPS
    low = positions[:-1][:, list(FEET[1::2]), 1].min(axis=-1) < 0.06
    return float(speed.min(axis=-1)[low].mean()) if low.any() else 0.0


def fault(scene: Scene) -> str | None:
    """The reason why a scene must not enter the corpus, or ``None`` if it may."""
    if not np.isfinite(scene.positions).all():
        return "not finite"
    if not 45 <= scene.positions.shape[1] <= 300:
        return "too short or too long"
    if len(scene.captions) < 3:
        return "too few captions"
    people = np.asarray(scene.positions, dtype=np.float64)
    lengths = np.linalg.norm(people[..., 1:, :] - people[..., list(SMPL22.parents[1:]), :], axis=-1)
    if np.abs(lengths - SMPL22.bone_lengths[1:]).max() > 1e-3:
        return "bones drift"
    trunks = people[:, :, list(TRUNK)]
    if np.linalg.norm(trunks[0, :, :, None] - trunks[1, :, None], axis=-1).min() < 0.12:
        return "trunks overlap"
    if max(slower_foot(person) for person in people) > allowed_skate(scene):
        return "feet slide"
    if np.linalg.norm(np.diff(people, n=2, axis=1), axis=-1).max() * FPS**2 > 260:
        return "a joint jumps"
    if people[..., 1].min() < -0.12:
        return "below the floor"
    return None
