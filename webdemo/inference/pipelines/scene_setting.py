"""Everything that is given of a window of a scene, in the network's frame."""

from __future__ import annotations

import hashlib
import json
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from acts.staging.given.beat import planned
from acts.staging.parts import KnownFrames, Part
from acts.staging.window import Window
from models.intergen.compact import CompactInterGen
from motion import FPS
from motion.placement import MEDIAN_START_DISTANCE, Placement
from motion.transforms import heading, heading_matrix
from webdemo.inference.method import SECONDS
from webdemo.inference.requests import GenerateRequest
from webdemo.inference.requests.actor import ROLES
from webdemo.inference.requests.plans import WindowPlan
from webdemo.inference.story.request import SceneRequest

from .directed import Directed, directed
from .scene_wishes import wishes
from .two_person import TwoPersonPipeline

Array = NDArray[np.floating]


@dataclass(frozen=True, eq=False)
class Setting:
    """Everything that is given of a window, in the network's frame.

    Attributes:
        window: the window.
        frames: its length with what it sees before and after.
        parts: what is given.
        placement: from the scene's world to the network's frame.
        plan: what was planned of it.
    """

    window: Window
    frames: int
    parts: tuple[Part, ...]
    placement: Placement
    plan: WindowPlan

    @classmethod
    def of(cls, request: SceneRequest, window: Window, scene: Array, kept: WindowPlan | None = None) -> Setting:
        """The setting of a window in a scene (2, T, 22, 3) whose earlier frames are there.

        Args:
            request: the scene's request.
            window: the window.
            scene: as far as it is made.
            kept: what was planned of the window when the scene was made before; by default it is planned now.
        """
        past, length = window.past, window.stop - window.start
        before = scene[:, window.start - past : window.start]
        after = scene[:, window.stop : window.stop + window.after]
        if request.loop and window.after:
            after = scene[:, : window.after]
        plan = kept or _plan(request, window, scene, _place(request, before, after))
        placement = _at(plan.place)
        parts: list[Part] = []
        for person in range(2):
            if past:
                parts.append(KnownFrames(person, range(past), placement.to_network(before[person])))
            if window.after:
                behind = range(past + length, past + length + window.after)
                parts.append(KnownFrames(person, behind, placement.to_network(after[person])))
        tail = window.after or window.tail(request.edges[-1])
        frames = max(past + length + tail, round(SECONDS[0] * FPS))
        return cls(window, frames, (*parts, *plan.parts), placement, plan)

    def scene(self, pipeline: TwoPersonPipeline[CompactInterGen]) -> Directed:
        """As the pipeline takes it."""
        return directed(pipeline.model, self.frames, self.parts, check=False)

    def share(self, pipeline: TwoPersonPipeline[CompactInterGen]) -> float:
        """The share of the new frames that the plan lays out, see :attr:`models.known.Hold.shares`."""
        planned = directed(pipeline.model, self.frames, self.plan.parts, check=False).given
        return 0.0 if planned is None else float(planned.shares[self._own].mean())

    def made(self, positions: Array) -> Array:
        """The new frames (2, T, 22, 3) in the scene's world, of the whole window's."""
        return self.placement.to_world(positions[:, self._own]).astype(np.float32)

    @property
    def _own(self) -> slice:
        """The frames that are the window's own, among those that it sees."""
        return slice(self.window.past, self.window.past + self.window.stop - self.window.start)

    def key(self, asked: GenerateRequest, digest: str) -> str:
        """A hash of all that the window is made from."""
        told = [digest, asked.to_dict(), self.plan.alone, self.frames, self.window.past]
        found = hashlib.sha256(json.dumps(told).encode())
        for part in self.parts:
            values = part.positions if isinstance(part, KnownFrames) else part.places
            headings = None if isinstance(part, KnownFrames) else part.headings
            joints = [*part.joints, part.kept] if isinstance(part, KnownFrames) else []
            found.update(repr((type(part).__name__, part.person, list(part.frames), joints)).encode())
            for array in (values, headings):
                found.update(b"-" if array is None else np.ascontiguousarray(array).tobytes())
        for array in (self.placement.turn, self.placement.origin, self.placement.goal):
            found.update(np.ascontiguousarray(array).tobytes())
        return found.hexdigest()


def _plan(request: SceneRequest, window: Window, scene: Array, place: tuple[float, float, float]) -> WindowPlan:
    """The plan, by the wishes and the words of a scene, of a window whose frame begins at a place."""
    placement, beat = _at(place), request.beats[window.beat]
    parts, notes = wishes(request, window, scene, placement)
    if request.plans_words:
        parts += planned(request, window, scene, placement, {part.person for part in parts})
    alone = beat.alone if any(beat.alone) else request.told[window.beat].alone
    return WindowPlan(place, tuple(parts), alone, tuple(notes))


def _place(request: SceneRequest, before: Array, after: Array) -> tuple[float, float, float]:
    """The x, z and heading where the network expects person a: of the first known frame, or where a path begins."""
    seen = before if before.shape[1] else after
    if seen.shape[1] and not (request.loop and not before.shape[1]):
        pose = seen[0, 0].astype(np.float64)
        return float(pose[0, 0]), float(pose[0, 2]), float(heading(pose[None])[0])
    return _anchor(request) or (0.0, 0.0, 0.0)


def _at(place: tuple[float, float, float]) -> Placement:
    """Maps a place (x, z) and a heading of the world to the origin and +Z."""
    x, z, angle = place
    return Placement(heading_matrix(-angle), np.array([x, 0.0, z]), np.zeros(3))


def _anchor(request: SceneRequest) -> tuple[float, float, float] | None:
    """The x, z and heading where a scene with paths or poses begins: person a's first ones, or in front of b's."""
    for person in ROLES:
        places: list[tuple[float, float, float, float]] = []  # seconds, x, z, heading
        for path in request.paths:
            if path.person == person:
                first = path.points[0]
                angle = math.radians(first.heading) if first.heading is not None else _direction(path.points)
                places.append((first.seconds or 0.0, first.x, first.z, angle))
        for pose in request.poses:
            if pose.person == person:
                x, _, z = (float(v) for v in pose.positions[0])
                places.append((pose.seconds, x, z, float(heading(np.asarray(pose.positions)[None])[0])))
        if not places:
            continue
        _, x, z, angle = min(places)
        if person == "a":
            return x, z, angle
        ahead = MEDIAN_START_DISTANCE
        return x + ahead * math.sin(angle), z + ahead * math.cos(angle), angle + math.pi
    return None


def _direction(points: tuple[object, ...]) -> float:
    """The heading from the first point to the first one that is away from it; 0 if there is none."""
    first = points[0]
    for point in points[1:]:
        dx, dz = point.x - first.x, point.z - first.z  # type: ignore[attr-defined]
        if math.hypot(dx, dz) > 0.3:
            return math.atan2(dx, dz)
    return 0.0
