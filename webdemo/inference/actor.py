"""The given person of a reaction: chosen from a file, and seen in the frame that the network knows.

No torch here: the page and the shell choose and trim before any network loads.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from webdemo.formats import read
from webdemo.motion import SMPL22, Clip, Duet, InputError
from webdemo.motion.transforms import heading, heading_matrix, resample

Array = NDArray[np.floating]

FPS = 30.0
"""Frames a second of everything that is generated."""
ROLES = ("a", "b")
APART = 1.5
"""Metres between the two people of the median training scene at its first frame; they face each other."""
# Metres around the floor at 0 within which a motion's lowest joint is believed to stand on it.
_ON_FLOOR = (-0.05, 0.15)
# Bones of an actor over those of an adult; beyond, the file is in another unit.
_BODY_SIZES = (0.5, 1.6)
# Metres; farther away, 32-bit positions are not exact to a tenth of a millimetre.
_FARTHEST = 1000.0


def choose_actor(
    motion: Clip | Duet, *, person: str | None = None, start: float = 0.0, end: float | None = None
) -> Clip:
    """One person of a motion, trimmed, at 30 fps.

    Args:
        motion: what a file held.
        person: "a" or "b"; needed where there are two.
        start, end: seconds in the file; to the end by default.

    Raises:
        InputError: where the choice is open, or the times do not lie in the motion.
    """
    name = f"{motion.name} " if isinstance(motion, Clip) and motion.name else "The file "
    if person is not None and person not in ROLES:
        raise InputError(f"Person {person!r:.40} is not known: choose a or b.")
    if isinstance(motion, Duet):
        if person is None:
            raise InputError("The file holds two people: choose person a or b.")
        clip = motion.people[ROLES.index(person)]
    elif person == "b":
        raise InputError(f"{name}holds one person only: leave the choice of a person out.")
    else:
        clip = motion
    if start >= clip.seconds:
        raise InputError(f"The start, {start:g} s, lies behind the motion, which lasts {clip.seconds:.1f} s.")
    stop = clip.seconds if end is None else end
    if not (math.isfinite(start) and math.isfinite(stop) and 0 <= start < stop):
        raise InputError(f"Start and end must be seconds with 0 ≤ start < end, not {start:g} and {stop:g}.")
    first, last = round(start * clip.fps), round(min(stop, clip.seconds) * clip.fps)
    return at_30_fps(clip.cut(first, max(last, first + 1)))


def other_pose(motion: Clip | Duet, *, person: str | None, start: float = 0.0) -> Array:
    """How the one who is not the actor stands where the actor's part begins: (22, 3) metres.

    Args:
        motion: what a file held.
        person: the actor, "a" or "b".
        start: seconds in the file.

    Raises:
        InputError: where the file holds nobody else, or the start lies behind its end.
    """
    if not isinstance(motion, Duet):
        raise InputError("The file holds one person only: nobody else's start can be taken from it.")
    other = ROLES[1 - ROLES.index(person)] if person in ROLES else person
    return np.asarray(choose_actor(motion, person=other, start=start).positions[0])


def read_actor(
    path: str | Path, *, person: str | None = None, start: float = 0.0, end: float | None = None
) -> Clip:
    """:func:`choose_actor` from a motion file, after which the clip is called."""
    clip = choose_actor(read(Path(path)), person=person, start=start, end=end)
    return replace(clip, name=Path(path).name)


def at_30_fps(clip: Clip) -> Clip:
    """The clip at the networks' rate, without rotations; its positions are the same array if it has it."""
    positions = clip.positions if clip.fps == FPS else resample(clip.positions, clip.fps, FPS)
    return Clip(positions, FPS, clip.skeleton, name=clip.name)


def check_actor(clip: Any, seconds: tuple[float, float]) -> Clip:
    """An actor as the networks take it: :func:`at_30_fps`, on SMPL22's joints, of a fitting length.

    Args:
        clip: what was given.
        seconds: the shortest and the longest motion.

    Raises:
        InputError: one sentence on what does not fit and what to do.
    """
    shortest, longest = seconds
    if not isinstance(clip, Clip):
        raise InputError("The actor must be one person's clip: of two people, choose person a or b.")
    if clip.skeleton.joint_names != SMPL22.joint_names:
        raise InputError(
            f"The actor has the joints of {clip.skeleton.name}, not SMPL's 22: bring the clip onto them "
            "with webdemo.motion.retarget.to_smpl."
        )
    if clip.seconds < shortest:
        raise InputError(f"The actor's motion lasts {clip.seconds:.2f} s: give {shortest:g} s or more of it.")
    # From the first frame to the last: ten seconds at 30 fps are often stored as 301 frames.
    if (clip.num_frames - 1) / clip.fps > longest:
        raise InputError(
            f"The actor's motion lasts {clip.seconds:.1f} s: trim it to {longest:g} s or less by its start "
            "and end."
        )
    actor = at_30_fps(clip)
    parents, children = (list(side) for side in zip(*SMPL22.bones, strict=True))
    lengths = np.linalg.norm(actor.positions[:, children] - actor.positions[:, parents], axis=-1)
    size = float(lengths.sum(-1).mean() / SMPL22.bone_lengths[children].sum())
    if not _BODY_SIZES[0] <= size <= _BODY_SIZES[1]:
        raise InputError(
            f"The actor's bones are {size:.3g} times as long as an adult's: give positions in metres."
        )
    if np.abs(actor.positions).max() > _FARTHEST:
        raise InputError(f"The actor is more than {_FARTHEST:g} m from the origin: move the motion there.")
    return actor


@dataclass(frozen=True)
class Placement:
    """A turn about the vertical and a shift, from a clip's world to the frame that the network knows.

    There person a stands at the origin at the first frame and faces +Z; person b is taken to stand
    :data:`APART` in front of that place and to face it. The floor is at 0.

    Attributes:
        turn: (3, 3) rotation about Y.
        origin: (3,) the point of the clip's world that goes to ``goal``.
        goal: (3,) metres.
    """

    turn: Array
    origin: Array
    goal: Array

    @classmethod
    def of(cls, clip: Clip, role: str) -> Placement:
        """The placement that puts a person of this role where the network expects one."""
        positions = clip.positions.astype(np.float64)
        lowest = positions[..., 1].min()
        floor = 0.0 if _ON_FLOOR[0] <= lowest <= _ON_FLOOR[1] else lowest
        origin = np.array([positions[0, 0, 0], floor, positions[0, 0, 2]])
        goal = np.array([0.0, 0.0, 0.0 if role == "a" else APART])
        towards = 0.0 if role == "a" else math.pi
        return cls(heading_matrix(towards - float(heading(positions[0]))), origin, goal)

    def to_network(self, positions: Array) -> Array:
        """(…, 3) float64 metres in the network's frame."""
        return (positions.astype(np.float64) - self.origin) @ self.turn.T + self.goal

    def to_world(self, positions: Array) -> Array:
        """Inverse of :meth:`to_network`."""
        return (positions.astype(np.float64) - self.goal) @ self.turn + self.origin
