"""Poses of single people at single moments of a story.

The floor's middle is the origin; x and z are metres, a heading is in degrees from +z towards +x.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from motion import FPS, SMPL22, InputError
from motion.kinematics import bone_lengths, swing
from motion.vectors import Array, unit
from webdemo.inference.requests.actor import ROLES, check_pose
from webdemo.inference.requests.paths import FLOOR, MOST_SPEED, FloorPath

MOST_POSES = 40
_FOLDED = 3.07
"""Radians by which a knee or an elbow bends at most; those of generated fights come to 2.99."""
_FORWARD = 0.45
"""Sine of the angle by which a knee may seem to bend forward, as its hinge is only guessed."""
_SAME_PLACE = 0.25
"""Metres by which a pose may be off the path of the same person."""


@dataclass(frozen=True, eq=False)
class Pose:
    """A pose of one person at one moment.

    Attributes:
        person: "a" or "b".
        seconds: the moment.
        positions: (22, 3) metres in the scene's world.
    """

    person: str
    seconds: float
    positions: Array

    def check(self, total: float) -> Pose:
        """The pose, rounded as a manifest keeps it; raises InputError if it is none of an adult in the scene."""
        if self.person not in ROLES:
            raise InputError(f"A pose is of person a or b, not {self.person!r:.20}.")
        if not isinstance(self.seconds, (int, float)) or not 0 <= self.seconds <= total:
            raise InputError(
                f"A pose of person {self.person} is at {self.seconds!r:.20} s, but the scene lasts "
                f"{total:g} s: give a time in it."
            )
        positions = check_pose(self.positions, "A pose")
        if (np.abs(bone_lengths(positions) / SMPL22.bone_lengths[1:] - 1) > 0.3).any():
            raise InputError(f"The pose of person {self.person} at {self.seconds:g} s has bones of other lengths.")
        if (wrong := bent_wrong(positions)) is not None:
            raise InputError(
                f"In the pose of person {self.person} at {self.seconds:g} s {wrong}: bend it as far as people can."
            )
        if np.abs(positions[0, [0, 2]]).max() > FLOOR:
            raise InputError(f"The pose of person {self.person} at {self.seconds:g} s is outside the floor.")
        return replace(self, seconds=min(self.seconds, total - 1 / FPS), positions=positions.round(5))

    def to_dict(self) -> dict[str, Any]:
        """As JSON."""
        return {"person": self.person, "seconds": self.seconds, "positions": np.asarray(self.positions).tolist()}


def bent_wrong(positions: Array) -> str | None:
    """A clause that names what nobody bends as this pose (22, 3) does; None if people can.

    Knees and elbows fold to :data:`_FOLDED` at most, and knees do not bend forward: their hinge is the pelvis' axis
    to the left, turned along with the thigh.
    """
    at = {name: np.asarray(positions, dtype=np.float64)[i] for i, name in enumerate(SMPL22.joint_names)}
    left = unit(at["left_hip"] - at["right_hip"])
    up = at["spine1"] - (at["left_hip"] + at["right_hip"]) / 2
    down = -unit(up - left * (up @ left))
    for side in ("left", "right"):
        for first, middle, end in (("hip", "knee", "ankle"), ("shoulder", "elbow", "wrist")):
            upper = unit(at[f"{side}_{middle}"] - at[f"{side}_{first}"])
            lower = unit(at[f"{side}_{end}"] - at[f"{side}_{middle}"])
            if upper @ lower < math.cos(_FOLDED):
                return f"the {side} {middle} is bent too far"
            if middle == "knee" and np.cross(upper, lower) @ (swing(down, upper) @ left) < -_FORWARD:
                return f"the {side} knee is bent forward"
    return None


def check_together(paths: Sequence[FloorPath], poses: Sequence[Pose]) -> None:
    """Raises InputError if paths and poses contradict each other."""
    for person in ROLES:
        theirs = sorted((p for p in poses if p.person == person), key=lambda pose: pose.seconds)
        for before, after in itertools.pairwise(theirs):
            gap = after.seconds - before.seconds
            way = float(np.linalg.norm(after.positions[0] - before.positions[0]))
            if round(gap * FPS) < 1:
                raise InputError(f"Two poses of person {person} are at {after.seconds:g} s: keep one.")
            if way / gap > MOST_SPEED:
                raise InputError(
                    f"Between the poses of person {person} at {before.seconds:g} and {after.seconds:g} s "
                    f"lie {way:.1f} m: move one in time or place."
                )
        for pose in theirs:
            for path in paths:
                place = path.place(pose.seconds) if path.person == person else None
                if place is not None and math.dist(place, pose.positions[0, [0, 2]]) > _SAME_PLACE:
                    raise InputError(
                        f"At {pose.seconds:g} s the pose of person {person} is off their path: move the pose "
                        "or the path."
                    )


def pose_of(values: Mapping[str, Any]) -> Pose:
    """A pose from its fields."""
    return Pose(
        values.get("person", ""), values.get("seconds", 0.0), np.asarray(values.get("positions", ()), dtype=np.float64)
    )
