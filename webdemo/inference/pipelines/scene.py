"""Scenes of several beats: window after window, each of which is given the end of the one before.

Person a stands at the origin of the network's frame where a window begins, as in training, so each window is
turned and moved there and back. What is given of a window is held at every step, or shown as a draft (:mod:`.given`).
Windows that were made are kept by their content: their words, settings, seed and everything that is given of them.
"""

from __future__ import annotations

import hashlib
import json
import math
import threading
from collections import OrderedDict
from collections.abc import Callable, Collection, Generator, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from acts import Plan
from acts.staging.given import Story, plan_parts
from acts.staging.window import KnownFrames, Part, Window
from models.intergen.compact import CompactInterGen
from motion import FPS, Duet, InputError
from motion.metrics import compare
from motion.transforms import MEDIAN_START_DISTANCE, Placement, heading, heading_matrix
from motion.vectors import Array
from webdemo.inference.finish.cleanup import finished, finishes
from webdemo.inference.finish.joining import closed
from webdemo.inference.method import SECONDS
from webdemo.inference.requests.actor import ROLES
from webdemo.inference.requests.paths import FloorPoint, meeting
from webdemo.inference.requests.plans import KeptPlan, WindowPlan
from webdemo.inference.run import CancelToken, Progress, Result, StageTimer
from webdemo.inference.story.request import SceneProgress, SceneRequest, window_seed, windows

from .given import NAMES, Scene, directed
from .two_person import Conditioning, TwoPersonPipeline
from .wishes import wishes

KEPT = 400
"""Windows that are kept; one of five seconds takes 160 kB."""
Planner = Callable[[Story, Window, Array, Placement, Collection[int]], Sequence[Part]]
"""What a window is given by its story, as :func:`acts.staging.given.plan_parts`."""
FAR = 6.0
"""Metres between two people beyond which the training scenes hold next to nothing."""


@dataclass(frozen=True)
class Made:
    """The motion of a window: positions (2, frames, 22, 3) in the scene's world, and notes.

    ``planned`` is the share of it that the plan, or given paths and poses, laid out for the network, and ``damped`` the
    metres by which damping moved the joints at the last timestep, on average.
    """

    positions: Array
    planned: float
    damped: float
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
        pipeline: samples the windows.
        words: what a window's sentence gives the network, as :meth:`.intergen.InterGenPipeline.words`.

    Attributes:
        parts: windows that were made before.
        planner: lays out what the words of a window say.
    """

    def __init__(
        self,
        pipeline: TwoPersonPipeline[CompactInterGen],
        words: Callable[[str, Plan, tuple[str, str], float], Conditioning],
    ) -> None:
        self.pipeline, self.words = pipeline, words
        self.parts = Parts()
        self.planner: Planner = plan_parts

    def run(
        self, request: SceneRequest, cancel: CancelToken, timer: StageTimer, notes: Sequence[str] = ()
    ) -> Iterator[Progress | Result]:
        """Progress events, a :class:`SceneProgress` after each window, then one :class:`Result`.

        Args:
            request: what is asked for.
            cancel: looked at before every step.
            timer: of the run.
            notes: come first among the result's notes, where the plan of the request has none.

        Raises:
            InputError: if the request has a plan that is not of this scene.
            Cancelled: within one denoising step; the windows that were finished are kept.
        """
        listed, kept = windows(request), request.plan_of_result
        if kept is not None and len(kept.windows) != len(listed) * request.samples:
            raise InputError(
                f"The kept plan is of {len(kept.windows)} windows, and this scene has {len(listed) * request.samples}: "
                "leave the plan out, so that the words are read."
            )
        steps, done, duets = request.steps * len(listed) * request.samples, 0, []
        made_plans: list[WindowPlan] = []
        effects: list[dict[str, float]] = []
        planning = kept.notes if kept else notes
        said = [*planning, *_notes(request)]
        for sample in range(request.samples):
            scene, effect = _blank(request), {"planned": 0.0, "damped": 0.0}
            total = sum(window.stop - window.start for window in listed)
            for window in listed:
                cancel.raise_if_cancelled()
                planned = kept.windows[len(made_plans)] if kept else None
                setting = Setting.of(request, window, scene, self.planner, planned)
                made_plans.append(setting.plan)
                said += setting.plan.notes
                made = yield from self._window(request, sample, setting, cancel, timer, done, steps)
                scene[:, window.start : window.stop] = made.positions
                said += made.notes
                weight = made.positions.shape[1] / total
                effect["planned"] += made.planned * weight
                effect["damped"] += made.damped * weight
                done += request.steps
                finished = Duet.from_positions(scene[:, : window.stop], fps=FPS, roles=NAMES)
                yield SceneProgress(
                    stage="sample",
                    step=done,
                    total=steps,
                    elapsed=timer.elapsed,
                    sample=sample,
                    beat=window.beat,
                    motion=finished,
                )
            if request.loop:
                _close(request, scene)
            duets.append(_duet(request, scene, sample))
            effects.append(effect)
        said += _distance_note(duets, request)
        plan = KeptPlan(request.plans, windows=tuple(made_plans), notes=tuple(planning))
        yield timer.progress("finish")
        yield Result(
            duets=tuple(duets),
            manifest={"plan": replace(plan, finishes=finishes(request)).to_dict()},
            readouts=tuple({**compare(None, duet), **effect} for duet, effect in zip(duets, effects, strict=True)),
            notes=tuple(dict.fromkeys(said)),
        )

    def _window(
        self,
        request: SceneRequest,
        sample: int,
        setting: Setting,
        cancel: CancelToken,
        timer: StageTimer,
        done: int,
        steps: int,
    ) -> Generator[Progress, None, Made]:
        """One window, made now or kept from an earlier run."""
        window = setting.window
        seed, words = window_seed(request, sample, window), request.beats[window.beat].sentence
        key = setting.key(request, words, seed, self.pipeline.digest)
        if (kept := self.parts.get(key)) is not None:
            return kept
        conditioning = self.words(words, request.plans[window.beat], setting.plan.alone, request.guidance)
        timer.lap("text")
        scene = setting.scene(self.pipeline)
        for event in self.pipeline.sample(request, conditioning, scene, (seed, 1), cancel, timer, measured=False):
            if isinstance(event, Result):
                positions = setting.made(event.duets[0].positions)
                notes = tuple(_of_beat(note, request, window) for note in event.notes)
                made = Made(positions, setting.share(self.pipeline, scene), event.readouts[0]["damped"], notes)
                self.parts.keep(key, made)
                return made
            if event.stage == "sample":
                yield replace(event, step=done + event.step, total=steps)
        raise AssertionError("A pipeline ends with its result.")


def _blank(request: SceneRequest) -> Array:
    """The scene (2, T, 22, 3) with the frames that are kept of a given motion."""
    scene = np.zeros((2, request.num_frames, 22, 3), dtype=np.float32)
    if request.motion is not None:
        first, last = request.made
        before, after = request.kept(request.motion)
        scene[:, :first] = before
        scene[:, last : last + after.shape[1]] = after
    return scene


def _duet(request: SceneRequest, scene: Array, sample: int) -> Duet:
    if request.cleanup and not (request.loop or request.poses):  # these stay as they are
        scene = finished(request, scene)
    if request.motion is None:
        return Duet.from_positions(scene, fps=FPS, roles=NAMES)
    return replace(request.motion.with_positions(scene), manifest=None)


def _close(request: SceneRequest, scene: Array) -> None:
    """Leads the end of a loop (2, T, 22, 3) into its beginning; poses that were asked for stay."""
    for person, role in enumerate(ROLES):
        posed = np.array([round(p.seconds * FPS) for p in request.poses if p.person == role], dtype=int)
        scene[person] = closed(scene[person], posed)


def _notes(request: SceneRequest) -> Iterator[str]:
    if len(request.paths) == 2 and (where := meeting(*request.paths)) is not None:
        yield (
            f"The two paths come within {100 * where[1]:.0f} cm of each other at {where[0]:.1f} s: move one of them, "
            "or one of their times, unless they are meant to touch."
        )


def _distance_note(duets: list[Duet], request: SceneRequest) -> list[str]:
    first, last = request.made
    gap = max(
        float(np.linalg.norm((d.positions[0] - d.positions[1])[first:last, 0][:, [0, 2]], axis=-1).max()) for d in duets
    )
    if gap <= FAR:
        return []
    return [
        f"The two get {gap:.0f} m apart, farther than in almost all scenes that the model was trained on: let them "
        "come back with a beat or a path."
    ]


def _of_beat(note: str, request: SceneRequest, window: Window) -> str:
    return f"Beat {window.beat + 1}: {note}" if len(request.beats) > 1 else note


# ---- what is given of a window -----------------------------------------------------------------------------
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
    def of(
        cls, request: SceneRequest, window: Window, scene: Array, planner: Planner, kept: WindowPlan | None = None
    ) -> Setting:
        """The setting of a window in a scene (2, T, 22, 3) whose earlier frames are there.

        Args:
            request: the scene's request.
            window: the window.
            scene: as far as it is made.
            planner: lays out what the words say.
            kept: what was planned of the window when the scene was made before; by default it is planned now.
        """
        past, length = window.past, window.stop - window.start
        before = scene[:, window.start - past : window.start]
        after = scene[:, window.stop : window.stop + window.after]
        if request.loop and window.after:
            after = scene[:, : window.after]
        plan = kept or _plan(request, window, scene, _place(request, before, after), planner)
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

    def scene(self, pipeline: TwoPersonPipeline[CompactInterGen]) -> Scene:
        """As the pipeline takes it."""
        return directed(pipeline.model, self.frames, self.parts, self.strictness)

    def share(self, pipeline: TwoPersonPipeline[CompactInterGen], scene: Scene) -> float:
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
        frames = (self.frames, self.window.past, self.window.stop - self.window.start)
        told = [digest, words, settings, self.plan.alone, *frames, self.strictness]
        sha256 = hashlib.sha256(json.dumps(told).encode())
        for part in self.parts:
            values = part.positions if isinstance(part, KnownFrames) else part.places
            headings = None if isinstance(part, KnownFrames) else part.headings
            joints = [*part.joints, part.kept, part.soft, part.free] if isinstance(part, KnownFrames) else []
            sha256.update(repr((type(part).__name__, part.person, list(part.frames), joints)).encode())
            for array in (values, headings):
                sha256.update(b"-" if array is None else np.ascontiguousarray(array).tobytes())
        for array in (self.placement.turn, self.placement.origin, self.placement.goal):
            sha256.update(np.ascontiguousarray(array).tobytes())
        return sha256.hexdigest()


def _plan(
    request: SceneRequest, window: Window, scene: Array, place: tuple[float, float, float], planner: Planner
) -> WindowPlan:
    """The plan, by the wishes and the words of a scene, of a window whose frame begins at a place."""
    placement, beat = _at(place), request.beats[window.beat]
    asked = bool(request.paths or request.poses)
    parts, notes = wishes(request, window, scene, placement) if asked or window.after else ([], [])
    if request.plans_words:
        seconds = [each.length for each in request.beats]
        story = Story(request.scores, seconds, request.edges, request.seed, asked)
        parts += planner(story, window, scene, placement, {part.person for part in parts})
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
