"""Paths on the floor that people are asked to walk.

The floor's middle is the origin; x and z are metres, a heading is in degrees from +z towards +x.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from motion import FPS, InputError

from .actor import ROLES, finite

FLOOR = 8.0
"""Metres from the middle of the floor to its edges."""
MOST_SPEED = 4.0
"""Metres a second between two points of a path or two poses: a fast run."""
WALKING = 1.2
"""Metres a second at which a path without times is walked."""
MOST_POINTS = 600
NEAR = 0.45
"""Metres between two people's paths below which they would walk into each other."""


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
            if not all(map(finite, numbers)):
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
                        f"Points {i - 1} and {i} of the path of {who} are at the same time: give later times."
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


def timed_paths(paths: Sequence[FloorPath], total: float) -> tuple[FloorPath, ...]:
    """The paths of a motion of ``total`` seconds, with a time for every point.

    Raises:
        InputError: if nobody can walk one of them, or a person has two.
    """
    for path in paths:
        path.check(total)
    if len({path.person for path in paths}) < len(paths):
        raise InputError("A person has two paths: put all points into one.")
    return tuple(path.timed(total) for path in paths)


def meeting(one: FloorPath, other: FloorPath) -> tuple[float, float] | None:
    """(seconds, metres) at which the two people's timed paths come too near each other; None if they do not."""
    first = max(path.points[0].seconds or 0.0 for path in (one, other))
    last = min(path.points[-1].seconds or 0.0 for path in (one, other))
    closest: tuple[float, float] | None = None
    for seconds in np.arange(first, last + 1e-6, 0.1):
        places = one.place(seconds), other.place(seconds)
        if places[0] is None or places[1] is None:
            continue
        gap = math.dist(places[0], places[1])
        if gap < NEAR and (closest is None or gap < closest[1]):
            closest = (float(seconds), gap)
    return closest


def path_of(values: Mapping[str, Any]) -> FloorPath:
    """A path from its fields; a point may be a mapping or ``[seconds, x, z]`` with or without a heading.

    Raises:
        InputError: if there are too many points, or one is none.
    """
    points = values.get("points", ())
    if len(points) > MOST_POINTS:
        raise InputError(f"A path has {len(points)} points: keep to {MOST_POINTS} or fewer.")
    return FloorPath(values.get("person", ""), tuple(_point_of(point, i) for i, point in enumerate(points, 1)))


def _point_of(values: Any, number: int) -> FloorPoint:
    names = ("x", "z") if isinstance(values, Sequence) and len(values) == 2 else ("seconds", "x", "z", "heading")
    known: Mapping[str, Any] = values if isinstance(values, Mapping) else {}
    if isinstance(values, Sequence) and len(values) <= len(names):
        known = dict(zip(names, values, strict=False))
    given = [value for value in known.values() if value is not None]
    numbers = all(isinstance(value, (int, float)) and not isinstance(value, bool) for value in given)
    if not numbers or not {"x", "z"} <= known.keys() <= {*names, "seconds", "heading"}:
        raise InputError(
            f"Point {number} of a path must be [x, z], [seconds, x, z] or [seconds, x, z, heading], all numbers."
        )
    return FloorPoint(**known)
