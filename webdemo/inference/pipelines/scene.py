"""Scenes of several beats: window after window, each of which is given the end of the one before.

Person a stands at the origin of the network's frame where a window begins, as in training, so each window is
turned and moved there and back. What is given of a window is held at every step, or shown as a draft (:mod:`.given`).
Windows that were made are kept by their content: their words, settings, seed and everything that is given of them.
"""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Callable, Generator, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from acts import Plan
from acts.staging.window import Window
from models.intergen.compact import CompactInterGen
from motion import FPS, Duet, InputError
from motion.metrics import compare
from webdemo.inference.finish.joining import closed
from webdemo.inference.finish.scene import finished, finishes
from webdemo.inference.requests.actor import ROLES
from webdemo.inference.requests.paths import meeting
from webdemo.inference.requests.plans import KeptPlan, WindowPlan
from webdemo.inference.run import CancelToken, Progress, Result, StageTimer
from webdemo.inference.story.request import SceneProgress, SceneRequest, window_seed, windows

from .given import NAMES
from .two_person import Conditioning, TwoPersonPipeline
from .window import Setting

Array = NDArray[np.floating]

KEPT = 400
"""Windows that are kept; one of five seconds takes 160 kB."""
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
    """

    def __init__(
        self,
        pipeline: TwoPersonPipeline[CompactInterGen],
        words: Callable[[str, Plan, tuple[str, str], float], Conditioning],
    ) -> None:
        self.pipeline, self.words = pipeline, words
        self.parts = Parts()

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
                setting = Setting.of(request, window, scene, planned)
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
        scene = finished(request, scene, window_seed(request, sample, windows(request)[0]))
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
