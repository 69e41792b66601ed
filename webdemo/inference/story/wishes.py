"""Wishes of a story for single people at single moments: paths on the floor, and poses.

The floor's middle is the origin; x and z are metres, a heading is in degrees from +z towards +x.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from motion import SMPL22, Clip, InputError
from motion.kinematics import swing
from motion.vectors import unit
from webdemo.inference.actor import FPS, ROLES, check_actor

Array = NDArray[np.floating]

FLOOR = 8.0
"""Metres from the middle of the floor to its edges."""
MOST_SPEED = 4.0
"""Metres a second between two points of a path or two poses: a fast run."""
WALKING = 1.2
"""Metres a second at which a path without times is walked."""
MOST_POINTS = 600
MOST_POSES = 40
NEAR = 0.45
"""Metres between two people's paths below which they would walk into each other."""
_FOLDED = 3.07
"""Radians by which a knee or an elbow bends at most; those of generated fights come to 2.99."""
_FORWARD = 0.45
"""Sine of the angle by which a knee may seem to bend forward, as its hinge is only guessed."""
_SAME_PLACE = 0.25
"""Metres by which a pose may be off the path of the same person."""


@dataclass(frozen=True)
class FloorPoint:
    """A place on the floor.

    Attributes:
        x, z: metres.
        seconds: when a person's pelvis is over it; by default it follows from the points around it.
        heading: degrees that the person faces there; free by default.
    """

    x: float
    z: float
    seconds: float | None = None
    heading: float | None = None


@dataclass(frozen=True)
class FloorPath:
    """Points that a person passes, in order; between them the way is free.

    Attributes:
        person: "a" or "b".
        points: one or more.
    """

    person: str
    points: tuple[FloorPoint, ...]

    def timed(self, total: float) -> FloorPath:
        """The same path with a time for every point, within ``total`` seconds.

        Points without a time are walked at an even speed between those that have one; where the last has none,
        at :data:`WALKING`.
        """
        points = self.points
        times: list[float | None] = [point.seconds for point in points]
        steps = [math.hypot(q.x - p.x, q.z - p.z) for p, q in itertools.pairwise(points)]
        along = np.concatenate([[0.0], np.cumsum(steps)])
        last = total - 1 / FPS
        if times[0] is None:
            known = next((i for i, time in enumerate(times) if time is not None), None)
            times[0] = 0.0 if known is None else max(0.0, float(times[known] or 0.0) - along[known] / WALKING)
        if times[-1] is None:
            known = max(i for i, time in enumerate(times) if time is not None)
            times[-1] = min(last, float(times[known] or 0.0) + (along[-1] - along[known]) / WALKING)
        known_at = [i for i, time in enumerate(times) if time is not None]
        filled = np.interp(along, along[known_at], [float(times[i] or 0.0) for i in known_at])
        return replace(
            self,
            points=tuple(
                replace(p, seconds=float(filled[i]) if times[i] is None else float(times[i] or 0.0))
                for i, p in enumerate(points)
            ),
        )

    def check(self, total: float) -> None:
        """Raises InputError if the path is not one of ``total`` seconds on the floor; it must be timed."""
        who = f"person {self.person}"
        if self.person not in ROLES:
            raise InputError(f"A path is for person a or b, not {self.person!r:.20}.")
        if not 1 <= len(self.points) <= MOST_POINTS:
            raise InputError(f"The path of {who} has {len(self.points)} points: give 1 to {MOST_POINTS}.")
        for i, point in enumerate(self.points, 1):
            numbers = [v for v in (point.x, point.z, point.seconds, point.heading) if v is not None]
            if not all(
                isinstance(v, (int, float)) and not isinstance(v, bool) and math.isfinite(v) for v in numbers
            ):
                raise InputError(f"Point {i} of the path of {who} needs finite numbers.")
            if max(abs(point.x), abs(point.z)) > FLOOR:
                raise InputError(
                    f"Point {i} of the path of {who}, ({point.x:g}, {point.z:g}), is outside the floor: keep x and z "
                    f"from {-FLOOR:g} to {FLOOR:g} metres."
                )
        self._check_times(self.timed(total), total)

    def _check_times(self, timed: FloorPath, total: float) -> None:
        who, before = f"person {self.person}", None
        for i, point in enumerate(timed.points, 1):
            seconds = point.seconds or 0.0
            if not 0 <= seconds <= total:
                raise InputError(
                    f"Point {i} of the path of {who} is at {seconds:g} s, but the scene lasts "
                    f"{total:g} s: give a time in it."
                )
            if before is not None:
                gap = seconds - (before.seconds or 0.0)
                if round(gap * FPS) < 1:
                    raise InputError(
                        f"Points {i - 1} and {i} of the path of {who} are at one time: give later times."
                    )
                speed = math.hypot(point.x - before.x, point.z - before.z) / gap
                if speed > MOST_SPEED:
                    raise InputError(
                        f"Points {i - 1} to {i} of the path of {who} ask for {speed:.1f} m/s: give more time "
                        f"or a shorter way (at most {MOST_SPEED:g} m/s)."
                    )
            before = point

    def place(self, seconds: float) -> tuple[float, float] | None:
        """The place (x, z) at a time, on straight lines between the points; None outside of their times."""
        times = [point.seconds or 0.0 for point in self.points]
        if not times[0] <= seconds <= times[-1]:
            return None
        return (
            float(np.interp(seconds, times, [p.x for p in self.points])),
            float(np.interp(seconds, times, [p.z for p in self.points])),
        )


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
        positions = np.asarray(self.positions, dtype=np.float64)
        if positions.shape != (SMPL22.num_joints, 3) or not np.isfinite(positions).all():
            raise InputError("A pose needs the positions of SMPL's 22 joints as finite numbers, in metres.")
        check_actor(Clip(np.repeat(positions[None], 30, axis=0), FPS), (0.0, 2.0))
        parents, children = np.array(SMPL22.bones).T
        lengths = np.linalg.norm(positions[children] - positions[parents], axis=-1)
        if (np.abs(lengths / np.asarray(SMPL22.bone_lengths)[children] - 1) > 0.3).any():
            raise InputError(
                f"The pose of person {self.person} at {self.seconds:g} s has bones of other lengths."
            )
        if (wrong := bent_wrong(positions)) is not None:
            raise InputError(
                f"In the pose of person {self.person} at {self.seconds:g} s {wrong}: bend it as far as people can."
            )
        if np.abs(positions[0, [0, 2]]).max() > FLOOR:
            raise InputError(f"The pose of person {self.person} at {self.seconds:g} s is outside the floor.")
        return replace(self, positions=positions.round(5))

    def to_dict(self) -> dict[str, Any]:
        """As JSON."""
        return {
            "person": self.person,
            "seconds": self.seconds,
            "positions": np.asarray(self.positions).tolist(),
        }


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
    """Raises InputError if wishes contradict each other."""
    for person in ROLES:
        own = sorted((p for p in poses if p.person == person), key=lambda pose: pose.seconds)
        for before, after in itertools.pairwise(own):
            gap = after.seconds - before.seconds
            way = float(np.linalg.norm(after.positions[0] - before.positions[0]))
            if round(gap * FPS) < 1:
                raise InputError(f"Two poses of person {person} are at {after.seconds:g} s: keep one.")
            if way / gap > MOST_SPEED:
                raise InputError(
                    f"Between the poses of person {person} at {before.seconds:g} and {after.seconds:g} s "
                    f"lie {way:.1f} m: move one in time or place."
                )
        for pose in own:
            for path in paths:
                place = path.place(pose.seconds) if path.person == person else None
                if place is not None and math.dist(place, pose.positions[0, [0, 2]]) > _SAME_PLACE:
                    raise InputError(
                        f"At {pose.seconds:g} s the pose of person {person} is off their path: move the pose "
                        "or the path."
                    )
    if sum(path.person == "a" for path in paths) > 1 or sum(path.person == "b" for path in paths) > 1:
        raise InputError("A person has two paths: put all points into one.")


def meeting(paths: Sequence[FloorPath]) -> tuple[float, float] | None:
    """(seconds, metres) at which the two people's paths come too near each other; None if they do not."""
    people = {path.person: path for path in paths}
    if set(people) != {"a", "b"}:
        return None
    first = max(path.points[0].seconds or 0.0 for path in paths)
    last = min(path.points[-1].seconds or 0.0 for path in paths)
    found: tuple[float, float] | None = None
    for seconds in np.arange(first, last + 1e-6, 0.1):
        places = people["a"].place(seconds), people["b"].place(seconds)
        if places[0] is None or places[1] is None:
            continue
        gap = math.dist(places[0], places[1])
        if gap < NEAR and (found is None or gap < found[1]):
            found = (float(seconds), gap)
    return found
