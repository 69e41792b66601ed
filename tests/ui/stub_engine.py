"""An engine without networks: two people who walk up to each other, made by sines."""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from motion import SMPL22, Clip, Duet, InputError, stacked_positions
from motion.kinematics import forward_kinematics
from motion.metrics import compare
from motion.transforms import heading_matrix
from webdemo.inference.requests import GenerateRequest, ReactRequest
from webdemo.inference.requests.live import Belief, LiveTake
from webdemo.inference.requests.predict import PredictRequest, PredictResult, with_people
from webdemo.inference.run import Cancelled, Progress, Result, StageTimer
from webdemo.inference.story import SceneProgress, SceneRequest
from webdemo.inference.story.sentences import as_scene

FPS = 30
_WALK = 0.8  # metres a second
_STRIDE = 2 * np.pi * 0.9  # radians a second


def walking(seconds: float, seed: int = 0) -> Duet:
    """Two people who walk towards each other with swinging arms and legs, as far apart as the seed says."""
    times = np.arange(round(seconds * FPS)) / FPS
    apart = 2.4 + 1.6 * np.random.default_rng(seed).random()
    reach = min(_WALK * times[-1], apart / 2 - 0.35)
    along = reach * np.minimum(times * _WALK / max(reach, 1e-6), 1.0)
    people = []
    for turn, start in ((0.0, -apart / 2), (np.pi, apart / 2)):
        rotations = np.tile(np.eye(3), (len(times), 22, 1, 1))
        rotations[:, 0] = heading_matrix(turn)
        swing = np.sin(_STRIDE * times) * (along < reach - 1e-6)
        for side, sign in (("left", 1.0), ("right", -1.0)):
            rotations[:, SMPL22.index(f"{side}_hip")] = _about("x", -0.45 * sign * swing)
            rotations[:, SMPL22.index(f"{side}_knee")] = _about("x", 0.35 * (1 + sign * swing) / 2)
            down = _about("z", -sign * 1.25)
            rotations[:, SMPL22.index(f"{side}_shoulder")] = _about("x", 0.4 * sign * swing) @ down
        root = np.zeros((len(times), 3))
        root[:, 1] = 0.94
        root[:, 2] = start + (along if turn == 0 else -along)
        people.append(forward_kinematics(rotations, root))
    positions = np.stack(people)
    positions[..., 1] -= positions[..., 1].min()
    return Duet.from_positions(positions, fps=FPS)


def beside(person: Clip, role: str, seed: int) -> Duet:
    """A given person and a copy who stands beside them, as far off as the seed says."""
    other = person.with_positions(person.positions + np.float32([1.0 + 0.1 * seed, 0, 0]))
    pair = (person, other) if role == "a" else (other, person)
    return Duet(*pair, ("actor", "reactor"))


def drift(request: PredictRequest) -> PredictResult:
    """Everyone rises after the marker, by a centimetre a frame, or two by another method than the usual.

    Each of several futures rises half as fast again as the one before.
    """
    past, frames = stacked_positions(request.past), round(request.seconds * FPS)
    pace = 0.01 if request.model == PredictRequest.model else 0.02
    rise = pace * np.arange(1, frames + 1)[:, None, None] * np.array([0, 1.0, 0])
    whole = [np.concatenate([past, past[:, -1:] + 1.5**i * rise], axis=1) for i in range(request.samples)]
    known = 0 if request.truth is None else request.truth.num_frames
    return PredictResult(
        duets=tuple(with_people(request.motion, each) for each in whole),
        manifest={"model": request.model, "request": request.to_dict()},
        past_frames=request.past_frames,
        truth=request.truth,
        error=tuple(10.0 * (i + 1) for i in range(known)),
        speed=(1000 * pace,) * frames,
        true_speed=(12.0,) * known,
    )


def _about(axis: str, angle: Any) -> np.ndarray:
    return Rotation.from_euler(axis, np.asarray(angle)[..., None]).as_matrix()


class Mirror:
    """A live partner who does what the person does, a metre and a half further on and turned around.

    Computing a frame takes ``pause`` seconds.
    """

    def __init__(self, pause: float = 0.0) -> None:
        self.pause = pause
        self.gaze = None
        self.things = ()
        self.belief = Belief("watches", "The stub watches.", (("wave", 0.75), ("bow", 0.2)))

    def step(self, pose: np.ndarray) -> np.ndarray:
        if self.pause:
            time.sleep(self.pause)
        return pose * [-1, 1, -1] + [0, 0, 1.5]


class StubEngine:
    """Answers as the real engine does, after ``steps`` pauses of ``pause`` seconds.

    A prompt that holds the word "impossible" is refused, one with "crash" raises an error that is no
    sentence for a user, one with "hang" never ends, and one with "unknown" comes with a note.
    """

    def __init__(self, *, pause: float = 0.0, load: float = 0.0, partner_pause: float = 0.0) -> None:
        self.pause, self.partner_pause = pause, partner_pause
        self.load = load
        self.ready = load == 0.0
        self.steps_done = 0
        self.requests: list[GenerateRequest | ReactRequest | PredictRequest] = []

    def warm_up(self) -> None:
        time.sleep(self.load)
        self.ready = True

    def info(self) -> dict[str, Any]:
        return {
            "name": "Stub walkers",
            "summary": "No network at all: two people walk up to each other.\n\nMade for trying the page.",
            "parameters": 0,
            "weights": "none",
        }

    def partner(self, name: str, *, seed: int = 0) -> Mirror:
        return Mirror(self.partner_pause)

    def run(
        self, request: GenerateRequest | ReactRequest | PredictRequest, cancel: Any = None
    ) -> Iterator[Progress | Result]:
        started = time.monotonic()
        self.requests.append(request)
        if isinstance(request, GenerateRequest):
            if cancel is not None:
                cancel.raise_if_cancelled()
            as_scene(request)  # sentences are read as by the engine itself
        if isinstance(request, PredictRequest):
            yield Progress(stage="sample", step=1, total=1, unit="pass")
            yield drift(request)
            return
        if isinstance(request, SceneRequest):
            yield from self._scene(request, cancel)
            return
        if isinstance(request, LiveTake):
            manifest = {"model": "stub", "request": request.to_dict()}
            for event in request.results(StageTimer()):
                yield replace(event, manifest=manifest) if isinstance(event, Result) else event
            return
        if "impossible" in request.prompt:
            raise InputError("The stub cannot do this: ask for something possible.")
        yield Progress(stage="text")
        while "hang" in request.prompt:
            time.sleep(0.1)
        for step in range(request.steps):
            if cancel is not None and cancel.cancelled:
                raise Cancelled("The run was cancelled.")
            if "crash" in request.prompt and step == 1:
                raise RuntimeError("tensor sizes 3 and 4 do not match")
            time.sleep(self.pause)
            self.steps_done = step + 1
            unit = "frame" if getattr(request, "mode", "") == "online" else "step"
            yield Progress(
                stage="sample", step=step + 1, total=request.steps, elapsed=time.monotonic() - started, unit=unit
            )
        seeds = range(request.seed, request.seed + request.samples)
        if isinstance(request, ReactRequest):
            after = tuple(beside(request.actor, request.role, seed) for seed in seeds)
        else:
            after = tuple(walking(request.seconds, seed) for seed in seeds)
        noise = np.random.default_rng(request.seed).normal(0, 0.004, after[0].positions.shape)
        before = [duet.with_positions(duet.positions + noise) for duet in after]
        planned = {} if isinstance(request, ReactRequest) else {"planned": 0.6 * request.planned}
        notes = ()
        if "unknown" in request.prompt:
            notes = (
                "This lies far from anything the model was trained on. The nearest that it knows: "
                "“two people shake hands”, “one person waves <b>hello</b>”.",
            )
        yield Result(
            duets=after,
            manifest={"model": "stub", "request": request.to_dict()},
            readouts=tuple({**compare(b, a), **planned} for b, a in zip(before, after, strict=True)),
            timings={"text": 0.01, "sampling": time.monotonic() - started, "finish": 0.05},
            notes=notes,
        )

    def _scene(self, request: SceneRequest, cancel: Any) -> Iterator[Progress | Result]:
        """The two walk, beat by beat; what is kept of a given motion stays."""
        wholes = [walking(request.total_seconds, request.seed + i).positions for i in range(request.samples)]
        for sample, whole in enumerate(wholes):
            first, last = request.made
            if request.motion is not None:
                before, after = request.kept(request.motion)
                whole[:, :first], whole[:, last : last + after.shape[1]] = before, after
            for pose in request.poses:
                whole["ab".index(pose.person), round(pose.seconds * FPS)] = pose.positions
            for beat, stop in enumerate(request.edges[1:]):
                time.sleep(self.pause)
                if cancel is not None and cancel.cancelled:
                    raise Cancelled("The run was cancelled.")
                so_far = Duet.from_positions(whole[:, :stop], fps=FPS, roles=("actor", "reactor"))
                step = sample * len(request.beats) + beat + 1
                yield SceneProgress(
                    stage="sample",
                    step=step,
                    total=request.samples * len(request.beats),
                    sample=sample,
                    beat=beat,
                    motion=so_far,
                )
        duets = tuple(Duet.from_positions(whole, fps=FPS) for whole in wholes)
        yield Result(
            duets=duets,
            manifest={"model": "stub", "request": request.to_dict()},
            readouts=tuple(compare(None, duet) for duet in duets),
            timings={"sampling": 0.1},
        )
