"""The room that the poses of a beat need: people begin, or step, so far apart that their bodies do not overlap."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from motion import FPS, SMPL22
from motion.placement import Placement

from .places import Standing, eased
from .poses import JOINT, Pose, upright
from .window import Part, Window, known_paths

Array = NDArray[np.floating]

BODY = 0.2
"""Metres between the bones of two people at which their bodies touch."""
FARTHEST = 3.0
"""Metres by which two people are moved apart at most."""
_STEP = 0.05
"""Metres by which the distance is tried."""
PACE = 0.9
"""Metres a second of people who step apart."""
SETTLE = 0.3
"""Seconds in which they come to rest."""
_OFTEN = 8
"""Frames between two given places of a step."""
_CROWN = 0.2
"""Metres from the joint of the head to its top, along the neck."""
_PARENTS, _CHILDREN = (list(side) for side in zip(*SMPL22.bones, strict=True))


@dataclass(frozen=True, eq=False)
class Room:
    """Two people with the room that they need.

    Attributes:
        stand: where they are for the poses of the beat.
        delay: frames of the beat in which they step there.
        before: where they are when the beat begins.
    """

    stand: Standing
    delay: int = 0
    before: Standing = field(default_factory=lambda: Standing(np.zeros((2, 2)), np.zeros(2)))

    def steps(self, start: int, window: Window, placement: Placement) -> list[Part]:
        """The places of people who step apart, as the network is given them."""
        at = np.arange(_OFTEN, self.delay + 1, _OFTEN)
        inside = (at + start >= window.start) & (at + start < window.stop)
        if not inside.any():
            return []
        done = eased(np.arange(1, self.delay + 1) / self.delay, 0.4)[at - 1][:, None]
        frames, parts = (at + start - window.start + window.past)[inside], []
        for person in (0, 1):
            first, last = self.before.places[person], self.stand.places[person]
            if np.linalg.norm(last - first) > _STEP / 2:
                places = (first + done * (last - first))[inside]
                headings = np.full(len(frames), float(self.stand.headings[person]))
                parts += known_paths(person, frames, places, headings, placement)
        return parts


def roomy(stand: Standing, poses: Mapping[int, Sequence[Pose]], fixed: Sequence[int], *, first: bool) -> Room:
    """The room of two people for the poses of a beat.

    Args:
        stand: where they are when it begins.
        poses: by person, as :func:`.postures.postures` gives them for people who stand there. Who has none
            stands upright.
        fixed: people who cannot step aside, as they are down already.
        first: nothing comes before: they begin where they have room.
    """
    moving = [person for person in (0, 1) if person not in fixed]
    if not any(poses.values()) or not moving:
        return Room(stand)
    bodies = _together(stand, poses)
    line = stand.towards(0)
    shares = np.zeros((2, 2))
    for person in moving:
        shares[person] = (line if person else -line) / len(moving)
    if first:  # a is where the scene begins
        shares = np.stack([np.zeros(2), line])
    for apart in np.arange(0.0, FARTHEST + _STEP, _STEP):
        moved = [bodies[i] + np.insert(apart * shares[i], 1, 0.0) for i in (0, 1)]
        if distance(moved[0], moved[1]) >= BODY:
            break
    places = stand.places + apart * shares
    if first:
        return Room(replace(stand, places=places))
    if not apart:
        return Room(stand)
    delay = math.ceil((apart / len(moving) / PACE + SETTLE) * FPS)
    return Room(Standing(places, stand.headings), delay, stand)


def _together(stand: Standing, poses: Mapping[int, Sequence[Pose]]) -> tuple[Array, Array]:
    """(N, 22, 3) of both people at every frame at which one of them has a pose."""
    frames = sorted({frame for listed in poses.values() for frame, _ in listed})
    found = []
    for person in (0, 1):
        listed = poses.get(person) or [(0, upright(stand.places[person], float(stand.headings[person])))]
        known = np.array([frame for frame, _ in listed])
        found.append(np.stack([listed[int(np.abs(known - frame).argmin())][1] for frame in frames]))
    return found[0], found[1]


def distance(a: Array, b: Array) -> float:
    """The least metres between the bones of two people (N, 22, 3) at one moment."""
    gaps = np.linalg.norm(_points(a)[:, :, None] - _points(b)[:, None], axis=-1)
    return float(gaps.min())


def _points(poses: Array) -> Array:
    """Joints (N, 22, 3), the middles of their bones, and the tops of the heads."""
    neck, head = (poses[:, JOINT[name]] for name in ("neck", "head"))
    up = (head - neck) / np.linalg.norm(head - neck, axis=-1, keepdims=True).clip(min=1e-6)
    crowns = head[:, None] + _CROWN * np.array([[0.5], [1.0]]) * up[:, None]
    return np.concatenate([poses, 0.5 * (poses[:, _PARENTS] + poses[:, _CHILDREN]), crowns], axis=1)
