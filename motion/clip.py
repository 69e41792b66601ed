"""The motion types: :class:`Clip` (one person) and :class:`Duet` (two people in one world)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from .errors import InputError
from .hands import Grip
from .hands import cut as cut_grips
from .looks import UNSAID, checked
from .skeleton import SMPL22, Skeleton
from .things.thing import MOST_THINGS, Thing
from .vectors import Array

FPS = 30.0
"""Frames a second of all generated motion."""


@dataclass(frozen=True, eq=False)
class Clip:
    """One person's motion.

    Attributes:
        positions: (T, J, 3) float32 joint positions in metres, Y up, floor at 0.
        fps: frames a second.
        skeleton: names and parents of the J joints.
        name: shown in messages and file names.
        notes: sentences on how well its file could be read, such as that it does not give its frame rate.
    """

    positions: Array = field(repr=False)
    fps: float
    skeleton: Skeleton = SMPL22
    name: str = ""
    notes: tuple[str, ...] = field(default=(), repr=False)

    def __post_init__(self) -> None:
        positions = np.asarray(self.positions, dtype=np.float32)
        joints = self.skeleton.num_joints
        if positions.ndim != 3 or positions.shape[1:] != (joints, 3):
            raise InputError(
                f"Positions of shape {positions.shape} do not fit the skeleton {self.skeleton.name}: "
                f"give an array of shape (frames, {joints}, 3)."
            )
        if len(positions) == 0:
            raise InputError("The motion has no frames: give at least one.")
        if not np.isfinite(positions).all():
            raise InputError("The motion holds NaN or infinite positions: remove or repair those frames.")
        if not np.isfinite(self.fps) or self.fps <= 0:
            raise InputError(f"A frame rate of {self.fps} is not possible: give frames a second above 0.")
        object.__setattr__(self, "positions", positions)

    @property
    def people(self) -> tuple[Clip, ...]:
        """This person alone."""
        return (self,)

    @property
    def num_frames(self) -> int:
        """Length in frames."""
        return len(self.positions)

    @property
    def seconds(self) -> float:
        """Length in seconds."""
        return self.num_frames / self.fps

    def cut(self, start: int = 0, stop: int | None = None) -> Clip:
        """Frames ``start`` to ``stop`` (exclusive) as a clip of its own."""
        return replace(self, positions=self.positions[start:stop])

    def with_positions(self, positions: Array) -> Clip:
        """The same person with other positions."""
        return replace(self, positions=positions)


@dataclass(frozen=True, eq=False)
class Duet:
    """Two clips in one world frame with the same fps and length.

    Attributes:
        a: the first person; the actor where one acts and one reacts.
        b: the second person; the reactor.
        roles: what the two are called.
        manifest: everything that reproduces the motion, where it was generated.
        things: beside them in the same world, each with a track of as many frames.
        grips: shapes that their hands hold for a while; they are relaxed otherwise.
        looks: names of the bodies that a and b wear, of :data:`motion.looks.LOOKS`.
    """

    a: Clip
    b: Clip
    roles: tuple[str, str] = ("a", "b")
    manifest: dict[str, Any] | None = field(default=None, repr=False)
    things: tuple[Thing, ...] = ()
    grips: tuple[Grip, ...] = ()
    looks: tuple[str, str] = UNSAID

    def __post_init__(self) -> None:
        checked(self.looks)
        if self.a.num_frames != self.b.num_frames or self.a.fps != self.b.fps:
            raise InputError(
                f"Two people must share one clock: a has {self.a.num_frames} frames at {self.a.fps:g} fps "
                f"and b {self.b.num_frames} at {self.b.fps:g}. Resample or trim one of them."
            )
        if self.a.skeleton.joint_names != self.b.skeleton.joint_names:
            raise InputError("The two people must have the same joints: retarget one of them.")
        if len(self.things) > MOST_THINGS:
            raise InputError(f"There may be {MOST_THINGS} things beside two people, not {len(self.things)}.")
        for thing in self.things:
            if thing.num_frames != self.num_frames:
                raise InputError(
                    f"The {thing.name} has {thing.num_frames} frames and the people {self.num_frames}: "
                    "give its track as many."
                )

    @classmethod
    def from_positions(
        cls,
        positions: Array,
        *,
        fps: float,
        skeleton: Skeleton = SMPL22,
        roles: tuple[str, str] = ("a", "b"),
        manifest: dict[str, Any] | None = None,
    ) -> Duet:
        """Builds a duet from positions of shape (2, T, J, 3) in metres."""
        if np.ndim(positions) != 4 or len(positions) != 2:
            raise InputError(f"Two people need positions (2, frames, joints, 3), not {np.shape(positions)}.")
        a, b = (Clip(person, fps, skeleton, name=role) for person, role in zip(positions, roles, strict=True))
        return cls(a, b, roles, manifest)

    @property
    def people(self) -> tuple[Clip, Clip]:
        """Both people, a first."""
        return self.a, self.b

    @property
    def fps(self) -> float:
        """Frames a second of both."""
        return self.a.fps

    @property
    def num_frames(self) -> int:
        """Length in frames."""
        return self.a.num_frames

    @property
    def seconds(self) -> float:
        """Length in seconds."""
        return self.a.seconds

    @property
    def skeleton(self) -> Skeleton:
        """The skeleton of both."""
        return self.a.skeleton

    @property
    def positions(self) -> Array:
        """(2, T, J, 3) float32 metres."""
        return np.stack([self.a.positions, self.b.positions])

    def cut(self, start: int = 0, stop: int | None = None) -> Duet:
        """Frames ``start`` to ``stop`` (exclusive)."""
        things = tuple(thing.cut(start, stop) for thing in self.things)
        first, last, _ = slice(start, stop).indices(self.num_frames)
        grips = cut_grips(self.grips, first, last)
        return replace(self, a=self.a.cut(start, stop), b=self.b.cut(start, stop), things=things, grips=grips)

    def with_positions(self, positions: Sequence[Array] | Array) -> Duet:
        """The same two people with other positions (2, T, J, 3); things and grips no longer fit and are dropped."""
        a, b = self.a.with_positions(positions[0]), self.b.with_positions(positions[1])
        return replace(self, a=a, b=b, things=(), grips=())


def stacked_positions(motion: Clip | Duet) -> Array:
    """(people, T, J, 3) metres of one person or two."""
    return motion.positions if isinstance(motion, Duet) else motion.positions[None]
