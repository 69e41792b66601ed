"""Everything that is given of a window of a scene, in the network's frame."""

from __future__ import annotations

import hashlib
import itertools
import json
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from acts.staging.given import Story, plan_parts
from acts.staging.window import KnownFrames, Part, Window, known_paths
from models.intergen.compact import CompactInterGen
from motion import FPS, InputError
from motion.placement import MEDIAN_START_DISTANCE, Placement
from motion.transforms import heading, heading_matrix
from webdemo.inference.method import SECONDS
from webdemo.inference.requests.actor import ROLES
from webdemo.inference.requests.paths import MOST_SPEED, FloorPath, FloorPoint
from webdemo.inference.requests.plans import WindowPlan
from webdemo.inference.story.request import SceneRequest

from .given import Directed, directed
from .two_person import TwoPersonPipeline

Array = NDArray[np.floating]
CATCHING_UP = 3.0
"""Metres a second of people who run to a path that begins elsewhere, where the path itself is no faster."""
ACCELERATION = 4.0
"""Metres a second by which such a run gets faster in a second."""
STROLL = 1.2
"""Metres a second below which the way to a path is left to the network."""
OFTEN = 8
"""Frames between two given places of such a way."""
OFF = 0.25
"""Metres beside a path from which a person is not on it."""
_SLACK = 0.05
"""Metres by which a pose may be farther than a run, as recorded and generated bodies sway."""


@dataclass(frozen=True, eq=False)
class Setting:
    """Everything that is given of a window, in the network's frame.

    Attributes:
        window: the window.
        frames: its length with what it sees before and after.
        parts: what is given.
        placement: from the scene's world to the network's frame.
        plan: what was planned of it.
        strictness: of the request.
    """

    window: Window
    frames: int
    parts: tuple[Part, ...]
    placement: Placement
    plan: WindowPlan
    strictness: float

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
        return cls(window, frames, (*parts, *plan.parts), placement, plan, request.strictness)

    def scene(self, pipeline: TwoPersonPipeline[CompactInterGen]) -> Directed:
        """As the pipeline takes it."""
        return directed(pipeline.model, self.frames, self.parts, self.strictness)

    def share(self, pipeline: TwoPersonPipeline[CompactInterGen], scene: Directed) -> float:
        """The share of the new frames of its scene that the plan lays out, see :attr:`models.known.Hold.shares`."""
        if len(self.parts) > len(self.plan.parts):  # the frames around it lay out some, too
            scene = directed(pipeline.model, self.frames, self.plan.parts, self.strictness)
        return float(scene.shares[self._own].mean())

    def made(self, positions: Array) -> Array:
        """The new frames (2, T, 22, 3) in the scene's world, of the whole window's."""
        return self.placement.to_world(positions[:, self._own]).astype(np.float32)

    @property
    def _own(self) -> slice:
        """The frames that are the window's own, among those that it sees."""
        return slice(self.window.past, self.window.past + self.window.stop - self.window.start)

    def key(self, request: SceneRequest, words: str, seed: int, digest: str) -> str:
        """A hash of all that the window is made from: the request's settings, the words, the network, what is given."""
        settings = {**request.sampling, "samples": 1, "tries": 1, "seed": seed}
        told = [digest, words, settings, self.plan.alone, self.frames, self.window.past, self.strictness]
        found = hashlib.sha256(json.dumps(told).encode())
        for part in self.parts:
            values = part.positions if isinstance(part, KnownFrames) else part.places
            headings = None if isinstance(part, KnownFrames) else part.headings
            joints = [*part.joints, part.kept, part.soft, part.free] if isinstance(part, KnownFrames) else []
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
        seconds, placed = [each.length for each in request.beats], bool(request.paths or request.poses)
        story = Story(request.scores, seconds, request.edges, request.seed, placed)
        parts += plan_parts(story, window, scene, placement, {part.person for part in parts})
    alone = beat.alone if any(beat.alone) else request.scores[window.beat].alone
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


def _direction(points: Sequence[FloorPoint]) -> float:
    """The heading from the first point to the first one that is away from it; 0 if there is none."""
    first = points[0]
    for point in points[1:]:
        dx, dz = point.x - first.x, point.z - first.z
        if math.hypot(dx, dz) > 0.3:
            return math.atan2(dx, dz)
    return 0.0


@dataclass(frozen=True)
class Fixed:
    """A place of a person that cannot be moved: of the motion around a window, or of a pose.

    Attributes:
        frame: of the scene.
        place: (2,) x and z in metres.
        speed: metres a second there.
    """

    frame: int
    place: Array
    speed: float = 0.0


def wishes(request: SceneRequest, window: Window, scene: Array, placement: Placement) -> tuple[list[Part], list[str]]:
    """The poses and paths that fall into a window, and notes on those that begin elsewhere than their person stands.

    A path that goes on behind the window is also given at the window's last frame.

    Args:
        request: the scene's request.
        window: the window.
        scene: (2, T, 22, 3), whose frames before the window, and those that are kept behind it, are there.
        placement: from the scene's world to the network's frame.

    Raises:
        InputError: if nobody runs as fast as a pose asks for.
    """
    parts: list[Part] = []
    notes: list[str] = []
    for person, role in enumerate(ROLES):
        fixed = _fixed(request, window, scene, person)
        poses = [p for p in request.poses if p.person == role]
        inside = {f: p for p in poses if window.start <= (f := round(p.seconds * FPS)) < window.stop}
        for frame, pose in inside.items():
            positions = placement.to_network(np.asarray(pose.positions)[None])
            parts.append(KnownFrames(person, [frame - window.start + window.past], positions))
        _check_speeds(role, fixed)
        for path in (path for path in request.paths if path.person == role):
            frames, places, headings, said = _walked(path, window, fixed, placement)
            kept = [i for i, frame in enumerate(frames) if frame not in inside]
            at = np.array(frames, dtype=int)[kept] - window.start + window.past
            parts += known_paths(person, at, places[kept], headings[kept], placement)
            notes += said
    return parts, notes


def _fixed(request: SceneRequest, window: Window, scene: Array, person: int) -> list[Fixed]:
    """The fixed places of a person in and around a window, in order."""
    found = [
        Fixed(frame, np.asarray(pose.positions)[0, [0, 2]])
        for pose in request.poses
        if pose.person == ROLES[person] and window.start <= (frame := round(pose.seconds * FPS)) < window.stop
    ]
    roots = scene[person, :, 0][:, [0, 2]].astype(np.float64)
    if window.start:
        last = roots[max(window.start - 2, 0) : window.start]
        speed = float(np.linalg.norm(last[-1] - last[0])) * FPS
        found.append(Fixed(window.start - 1, last[-1], speed))
    if window.after:
        found.append(Fixed(window.stop, roots[0 if request.loop else window.stop]))
    return sorted(found, key=lambda each: each.frame)


def _check_speeds(role: str, fixed: list[Fixed]) -> None:
    """Raises InputError if nobody gets from one fixed place to the next in time."""
    for before, after in itertools.pairwise(fixed):
        way, seconds = float(np.linalg.norm(after.place - before.place)), (after.frame - before.frame) / FPS
        if way > MOST_SPEED * seconds + _SLACK:
            raise InputError(
                f"Person {role.upper()} is {way:.1f} m away {seconds:.1f} s before the pose or the kept motion at "
                f"{after.frame / FPS:.1f} s, and nobody runs that fast: move the pose, or give it another time."
            )


def _walked(
    path: FloorPath, window: Window, fixed: list[Fixed], placement: Placement
) -> tuple[list[int], Array, Array, list[str]]:
    """The frames, places (N, 2) and headings (N,) in radians of a path in a window, and a note on its beginning."""
    first, last = (round((path.points[i].seconds or 0.0) * FPS) for i in (0, -1))
    low, high = max(first, window.start), min(last, window.stop - 1)
    if low > high:
        return [], np.zeros((0, 2)), np.zeros(0), []
    turned = {
        round((p.seconds or 0.0) * FPS): math.nan if p.heading is None else math.radians(p.heading) for p in path.points
    }
    frames = {f for f in turned if low <= f <= high} | {high}
    line = np.array([_on_path(path, f) for f in range(low, high + 1)])
    before = next((each for each in reversed(fixed) if each.frame < low), None)
    after = next((each for each in fixed if each.frame > high), None)
    walked, start = _reached(line, low, before, placement, ROLES.index(path.person))
    if after is not None:
        walked, _ = _chased(walked[::-1], Fixed(0, after.place), after.frame - high, len(walked) - 1)
        walked = walked[::-1]
    behind = np.linalg.norm(walked[low - start :] - line, axis=1)
    late = np.flatnonzero(behind > 0.01)
    if start < low or len(late):
        until = low + (int(late[-1]) if len(late) else 0)
        frames |= {*range(start, until + 1, OFTEN), min(until + 1, high)}
    ordered = sorted(frames)
    places = walked[np.array(ordered) - start]
    headings = np.array([turned.get(f, math.nan) for f in ordered])
    return ordered, places, headings, _note(path, before, line, behind, low) if low == first else []


def _reached(line: Array, low: int, before: Fixed | None, placement: Placement, person: int) -> tuple[Array, int]:
    """The places (N, 2) of a person who gets to a line, one a frame, and the frame of the first of them."""
    if before is None:  # where they begin is free, and they begin at the path unless they can stroll there
        usual = placement.to_world(np.array([0.0, 0.0, person * MEDIAN_START_DISTANCE]))[[0, 2]]
        near = float(np.linalg.norm(line[0] - usual)) <= STROLL * low / FPS
        return (line, low) if not low or near else (np.concatenate([line[:1].repeat(low, axis=0), line]), 0)
    way = float(np.linalg.norm(line[0] - before.place))
    if way <= STROLL * (low - before.frame) / FPS:
        return line, low
    ahead = low - before.frame - 1
    wanted = np.concatenate([line[:1].repeat(ahead, axis=0), line])
    walked, _ = _chased(wanted, before, 1, len(wanted))
    return walked, before.frame + 1


def _chased(wanted: Array, begins: Fixed, gap: int, frames: int) -> tuple[Array, float]:
    """Places (N, 2), one a frame, of a person who runs after the wanted ones.

    Args:
        wanted: (N, 2) metres.
        begins: where they are ``gap`` frames before the first of these.
        gap: at least 1.
        frames: over which they may catch up.
    """
    found, here, speed = wanted.copy(), begins.place, begins.speed
    own = np.linalg.norm(np.diff(wanted, axis=0, prepend=wanted[:1]), axis=1) * FPS
    for i in range(min(frames + 1, len(wanted))):
        since = gap if i == 0 else 1
        most = min(max(CATCHING_UP, float(own[i])), MOST_SPEED)
        reach = min(speed + ACCELERATION * since / FPS, most) * since / FPS
        line = wanted[i] - here
        way = float(np.linalg.norm(line))
        found[i] = wanted[i] if way <= reach else here + reach / way * line
        speed = float(np.linalg.norm(found[i] - here)) * FPS / since
        here = found[i]
    return found, speed


def _note(path: FloorPath, before: Fixed | None, line: Array, behind: Array, low: int) -> list[str]:
    """A sentence on a path that begins elsewhere than its person stands."""
    if before is None or behind[0] <= OFF:
        return []
    who, way = f"Person {path.person.upper()}", float(np.linalg.norm(line[0] - before.place))
    begins = f"{who}'s path begins {way:.1f} m from where they are at {low / FPS:.1f} s"
    there = np.flatnonzero(behind > OFF)[-1] + 1
    if there == len(line):
        return [f"{begins}, and they cannot be on it in that time: begin it where they are, or give it more time."]
    return [f"{begins}: they run there and are on it from {(low + there) / FPS:.1f} s on."]


def _on_path(path: FloorPath, frame: int) -> tuple[float, float]:
    first, last = ((path.points[i].seconds or 0.0) for i in (0, -1))
    found = path.place(min(max(frame / FPS, first), last))
    assert found is not None
    return found
