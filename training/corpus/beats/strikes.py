"""Punches, kicks and sword cuts of recordings, and how a body gives way to them."""

from __future__ import annotations

import numpy as np

from motion.kinematics import forward_kinematics
from motion.skeleton import SMPL22

from ..compose import Motion, drift, lean
from ..library import Library, Take, pick
from .performer import Rng

TIPS = {"punch": "wrist", "kick": "ankle"}


def blow(rng: Rng, library: Library, action: str, *, most: int) -> Take:
    """One to ``most`` blows in a row."""
    for _ in range(40):
        take = library.take(rng, action)
        if 1 <= len(take.peaks) <= most:
            break
    return take


def reach(take: Take) -> float:
    """Reach of the blow at its first peak, in metres in front of the attacker's first place."""
    joint = SMPL22.index(f"{take.side}_{TIPS[take.action]}")
    peak = take.peaks[0]
    tip = forward_kinematics(take.motion.rotations[peak], take.motion.root[peak])[joint]
    return float(np.linalg.norm((tip - take.motion.root[0])[[0, 2]]))


def pulse(frames: int, start: int, rise: int, fall: int) -> np.ndarray:
    """(frames,) 0, up to 1 within ``rise`` frames from ``start`` on, back to 0 within ``fall``; smooth."""
    t = np.arange(frames) - start
    up = 0.5 - 0.5 * np.cos(np.pi * np.clip(t / rise, 0, 1))
    down = 0.5 + 0.5 * np.cos(np.pi * np.clip((t - rise) / fall, 0, 1))
    return up * down


def recoil(rng: Rng, motion: Motion, frame: int) -> Motion:
    """The upper body is thrown back at ``frame`` and comes forward again; the hips give way a little."""
    shape = pulse(len(motion), frame, int(rng.integers(5, 8)), int(rng.integers(16, 26)))
    motion = lean(motion, -shape * rng.uniform(0.5, 0.85), towards=float(rng.normal(0, 0.4)))
    back = -np.stack([np.sin(motion.headings), np.zeros(len(motion)), np.cos(motion.headings)], axis=-1)
    return drift(motion, back * shape[:, None] * rng.uniform(0.08, 0.16))


def dodge(rng: Rng, motion: Motion, frame: int) -> Motion:
    """The upper body leans out of the way around ``frame``, to one side and back."""
    shape = pulse(len(motion), max(frame - 10, 0), 10, int(rng.integers(14, 22)))
    towards = pick(rng, (-1, 1)) * rng.uniform(1.3, 2.3)
    motion = lean(motion, shape * rng.uniform(0.45, 0.7), towards=towards)
    angle = motion.headings + towards
    aside = np.stack([np.sin(angle), np.zeros(len(motion)), np.cos(angle)], axis=-1)
    return drift(motion, aside * shape[:, None] * rng.uniform(0.08, 0.16) - np.array([0, 0.05, 0]) * shape[:, None])
