"""Scenes of several beats: window after window, each of which is given the end of the one before.

Person a stands at the origin of the network's frame where a window begins, as in training, so each window is
turned and moved there and back. What is given of a window is held at every step (:mod:`webdemo.inference.directed`).
Windows that were made are kept by their content: their words, settings, seed and everything that is given of them.
"""

from __future__ import annotations

import hashlib
import json
import math
import threading
from collections import OrderedDict
from collections.abc import Generator, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from motion import Duet
from motion.metrics import compare
from motion.transforms import heading, heading_matrix
from webdemo.inference import methods
from webdemo.inference.actor import FPS, MEDIAN_START_DISTANCE, ROLES, SECONDS, Placement
from webdemo.inference.cancel import CancelToken
from webdemo.inference.directed import Directed, KnownFrames, Part, directed
from webdemo.inference.joining import closed
from webdemo.inference.requests import GenerateRequest, Progress, Result
from webdemo.inference.scenes import NAMES
from webdemo.inference.story.plan import MOST_FRAMES, Window, window_seed, windows
from webdemo.inference.story.progress import SceneProgress
from webdemo.inference.story.request import SceneRequest
from webdemo.inference.story.wishes import meeting
from webdemo.inference.timer import StageTimer

from .scene_floor import known_paths, plan_note, planned

if TYPE_CHECKING:
    from .intergen import InterGenPipeline
    from .two_person import Passes

Array = NDArray[np.floating]

KEPT = 400
"""Windows that are kept; one of five seconds takes 160 kB."""
TAIL = 8
"""Frames that are made behind a window and thrown away where another follows: the network is least sure of the last
ones, and its feet are fast there."""
FAR = 6.0
"""Metres between two people beyond which the training scenes hold next to nothing."""


@dataclass(frozen=True, kw_only=True)
class WindowRequest(GenerateRequest):
    """The request of one window of a scene; its words may be missing.

    Attributes:
        alone: what each person does, as sentences of their own, for a model that reads them; "" where the words for
            both say it. The prompt has them, too.
    """

    split: bool = False
    alone: tuple[str, str] = ("", "")

    def __post_init__(self) -> None:
        self._check(methods.method(self.model, "scene"))


@dataclass(frozen=True)
class Made:
    """The motion of a window: positions (2, frames, 22, 3) in the scene's world, and notes."""

    positions: Array
    notes: tuple[str, ...] = ()


class Parts:
    """Windows by the hash of what they were made from; the one that was used longest ago goes first."""

    def __init__(self, most: int = KEPT) -> None:
        self.most = most
        self._made: OrderedDict[str, Made] = OrderedDict()
        self._lock = threading.Lock()

    def get(self, key: str) -> Made | None:
        """A window that was made before."""
        with self._lock:
            if key in self._made:
                self._made.move_to_end(key)
            return self._made.get(key)

    def keep(self, key: str, made: Made) -> None:
        """Keeps a window."""
        made.positions.setflags(write=False)
        with self._lock:
            self._made[key] = made
            while len(self._made) > self.most:
                self._made.popitem(last=False)


class SceneMaker:
    """Makes scenes with a pipeline.

    Args:
        pipeline: makes the windows.
    """

    def __init__(self, pipeline: InterGenPipeline) -> None:
        self.pipeline = pipeline
        self.parts = Parts()

    def run(
        self,
        request: SceneRequest,
        cancel: CancelToken,
        timer: StageTimer,
        passes: Passes | None = None,
        notes: Sequence[str] = (),
    ) -> Iterator[Progress | Result]:
        """Progress events, a :class:`SceneProgress` after each window, then one :class:`Result`.

        Args:
            request: what is asked for.
            cancel: looked at before every step.
            timer: of the run.
            passes: as :meth:`TwoPersonPipeline.run` takes them.
            notes: come first among the result's notes.

        Raises:
            Cancelled: within one denoising step; the windows that were finished are kept.
        """
        plan = windows(request)
        steps = request.steps * len(plan) * request.samples
        done, duets, said = 0, [], [*notes, *_notes(request), *plan_note(request)]
        for sample in range(request.samples):
            scene = _blank(request)
            for window in plan:
                cancel.raise_if_cancelled()
                made = yield from self._window(
                    request, sample, window, scene, cancel, timer, passes, done, steps
                )
                scene[:, window.start : window.stop] = made.positions
                said += made.notes
                done += request.steps
                finished = Duet.from_positions(scene[:, : window.stop], fps=FPS, roles=NAMES)
                yield SceneProgress(
                    stage="sample", step=done, total=steps, elapsed=timer.elapsed, sample=sample,
                    beat=window.beat, motion=finished,
                )  # fmt: skip
            if request.loop:
                _close(request, scene)
            duets.append(_duet(request, scene))
        said += _distance_note(duets, request)
        yield timer.progress("finish")
        yield Result(
            duets=tuple(duets),
            manifest={},
            readouts=tuple(compare(None, duet) for duet in duets),
            timings={**timer.stages, "total": round(timer.elapsed, 4)},
            notes=tuple(dict.fromkeys(said)),
        )

    def _window(
        self,
        request: SceneRequest,
        sample: int,
        window: Window,
        scene: Array,
        cancel: CancelToken,
        timer: StageTimer,
        passes: Passes | None,
        done: int,
        steps: int,
    ) -> Generator[Progress, None, Made]:
        """One window, made now or kept from an earlier run."""
        setting = _Setting.of(request, window, scene)
        asked = _asked(request, sample, window, setting.frames)
        key = setting.key(asked, self.pipeline.digest)
        if (kept := self.parts.get(key)) is not None:
            return kept
        given = setting.scene(self.pipeline)
        for event in self.pipeline.run(asked, cancel, timer, passes, given):
            if isinstance(event, Result):
                made = setting.made(event.duets[0].positions)
                found = Made(made, tuple(_of_beat(note, request, window) for note in event.notes))
                if (
                    passes is None
                ):  # sharing a pass changes the rounding, and kept windows give the same bytes
                    self.parts.keep(key, found)
                return found
            if event.stage == "sample":
                yield replace(event, step=done + event.step, total=steps)
        raise AssertionError("A pipeline ends with its result.")


def _asked(request: SceneRequest, sample: int, window: Window, frames: int) -> WindowRequest:
    beat = request.beats[window.beat]
    return WindowRequest(
        prompt=beat.sentence, alone=beat.alone, seconds=frames / FPS, seed=window_seed(request, sample, window),
        guidance=request.guidance, steps=request.steps, damping=request.damping, sampler=request.sampler,
        model=request.model, cleanup=request.cleanup,
    )  # fmt: skip


def _blank(request: SceneRequest) -> Array:
    """The scene (2, T, 22, 3) with the frames that are kept of a given motion."""
    scene = np.zeros((2, request.num_frames, 22, 3), dtype=np.float32)
    if request.motion is not None:
        first, last = request.made
        before, after = request.kept(request.motion)
        scene[:, :first] = before
        scene[:, last : last + after.shape[1]] = after
    return scene


def _duet(request: SceneRequest, scene: Array) -> Duet:
    if request.motion is None:
        return Duet.from_positions(scene, fps=FPS, roles=NAMES)
    return replace(request.motion.with_positions(scene), manifest=None)


def _close(request: SceneRequest, scene: Array) -> None:
    """Leads the end of a loop (2, T, 22, 3) into its beginning; poses that were asked for stay."""
    for person, role in enumerate(ROLES):
        posed = np.array([round(p.seconds * FPS) for p in request.poses if p.person == role], dtype=int)
        scene[person] = closed(scene[person], posed)


def _notes(request: SceneRequest) -> Iterator[str]:
    if (found := meeting(request.paths)) is not None:
        yield (
            f"The two paths come within {100 * found[1]:.0f} cm of each other at {found[0]:.1f} s: move one of them, "
            "or one of their times, unless they are meant to touch."
        )


def _distance_note(duets: list[Duet], request: SceneRequest) -> list[str]:
    first, last = request.made
    gap = max(
        float(np.linalg.norm((d.positions[0] - d.positions[1])[first:last, 0][:, [0, 2]], axis=-1).max())
        for d in duets
    )
    if gap <= FAR:
        return []
    return [
        f"The two get {gap:.0f} m apart, farther than in almost all scenes that the model was trained on: let them "
        "come back with a beat or a path."
    ]


def _of_beat(note: str, request: SceneRequest, window: Window) -> str:
    return f"Beat {window.beat + 1}: {note}" if len(request.beats) > 1 else note


@dataclass(frozen=True, eq=False)
class _Setting:
    """Everything that is given of a window, in the network's frame.

    Attributes:
        window: the window.
        frames: its length with what it sees before and after.
        parts: what is given.
        placement: from the scene's world to the network's frame.
    """

    window: Window
    frames: int
    parts: tuple[Part, ...]
    placement: Placement

    @classmethod
    def of(cls, request: SceneRequest, window: Window, scene: Array) -> _Setting:
        """The setting of a window in a scene (2, T, 22, 3) whose earlier frames are there."""
        past, length = window.past, window.stop - window.start
        before = scene[:, window.start - past : window.start]
        after = scene[:, window.stop : window.stop + window.after]
        if request.loop and window.after:
            after = scene[:, : window.after]
        placement = _placement(request, before, after)
        parts: list[Part] = []
        for person in range(2):
            if past:
                parts.append(KnownFrames(person, range(past), placement.to_network(before[person])))
            if window.after:
                behind = range(past + length, past + length + window.after)
                parts.append(KnownFrames(person, behind, placement.to_network(after[person])))
        wished = _wishes(request, window, placement)
        parts += wished
        if request.planned and request.end is None and not request.loop:
            taken = {part.person for part in wished}
            parts += planned(request, window, scene, placement, taken)
        ends = window.after or window.stop == request.edges[-1]
        tail = window.after if ends else min(TAIL, MOST_FRAMES - past - length)
        frames = max(past + length + tail, round(SECONDS[0] * FPS))
        return cls(window, frames, tuple(parts), placement)

    def scene(self, pipeline: InterGenPipeline) -> Directed:
        """As the pipeline takes it."""
        return directed(pipeline.model, self.frames, self.parts, check=False)

    def made(self, positions: Array) -> Array:
        """The new frames (2, T, 22, 3) in the scene's world, of the whole window's."""
        first = self.window.past
        new = positions[:, first : first + self.window.stop - self.window.start]
        return self.placement.to_world(new).astype(np.float32)

    def key(self, asked: WindowRequest, digest: str) -> str:
        """A hash of all that the window is made from."""
        found = hashlib.sha256(json.dumps([digest, asked.to_dict(), self.frames, self.window.past]).encode())
        for part in self.parts:
            values = part.positions if isinstance(part, KnownFrames) else part.places
            headings = None if isinstance(part, KnownFrames) else part.headings
            joints = list(part.joints) if isinstance(part, KnownFrames) else []
            found.update(repr((type(part).__name__, part.person, list(part.frames), joints)).encode())
            for array in (values, headings):
                found.update(b"-" if array is None else np.ascontiguousarray(array).tobytes())
        for array in (self.placement.turn, self.placement.origin, self.placement.goal):
            found.update(np.ascontiguousarray(array).tobytes())
        return found.hexdigest()


def _placement(request: SceneRequest, before: Array, after: Array) -> Placement:
    """Puts person a where the network expects them: at the window's first known frame, or where a path begins."""
    seen = before if before.shape[1] else after
    if seen.shape[1] and not (request.loop and not before.shape[1]):
        pose = seen[0, 0].astype(np.float64)
        return _at(pose[0, [0, 2]], float(heading(pose[None])[0]))
    found = _anchor(request)
    return found if found is not None else _at(np.zeros(2), 0.0)


def _at(place: Array, angle: float) -> Placement:
    """Maps a place and a heading of the world to the origin and +Z."""
    return Placement(heading_matrix(-angle), np.array([place[0], 0.0, place[1]]), np.zeros(3))


def _anchor(request: SceneRequest) -> Placement | None:
    """The place where a scene with paths or poses begins: person a at their first point, or in front of b's."""
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
            return _at(np.array([x, z]), angle)
        ahead = MEDIAN_START_DISTANCE * np.array([math.sin(angle), math.cos(angle)])
        return _at(np.array([x, z]) + ahead, angle + math.pi)
    return None


def _direction(points: tuple[object, ...]) -> float:
    """The heading from the first point to the first one that is away from it; 0 if there is none."""
    first = points[0]
    for point in points[1:]:
        dx, dz = point.x - first.x, point.z - first.z  # type: ignore[attr-defined]
        if math.hypot(dx, dz) > 0.3:
            return math.atan2(dx, dz)
    return 0.0


def _wishes(request: SceneRequest, window: Window, placement: Placement) -> list[Part]:
    """The poses and paths that fall into a window; a path that goes on behind it is also given at its last frame."""
    parts: list[Part] = []
    posed: set[tuple[int, int]] = set()
    shift = window.past - window.start
    for pose in request.poses:
        frame, person = round(pose.seconds * FPS), ROLES.index(pose.person)
        if window.start <= frame < window.stop:
            posed.add((person, frame))
            parts.append(
                KnownFrames(person, [frame + shift], placement.to_network(np.asarray(pose.positions)[None]))
            )
    for path in request.paths:
        person = ROLES.index(path.person)
        wanted: dict[int, tuple[float, float, float | None]] = {}
        for point in path.points:
            frame = round((point.seconds or 0.0) * FPS)
            if window.start <= frame < window.stop:
                wanted[frame] = (point.x, point.z, point.heading)
        last = path.place((window.stop - 1) / FPS)
        if last is not None and window.stop - 1 not in wanted:
            wanted[window.stop - 1] = (*last, None)
        frames = [frame for frame in sorted(wanted) if (person, frame) not in posed]
        headings = np.array([math.nan if wanted[f][2] is None else wanted[f][2] for f in frames], dtype=float)
        places = np.array([wanted[f][:2] for f in frames], dtype=float).reshape(-1, 2)
        at = np.array(frames, dtype=int) + shift
        parts += known_paths(person, at, places, np.radians(headings), placement)
    return parts
