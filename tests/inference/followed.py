"""A pipeline that does what it is given and no more: people go straight from one given place to the next."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from acts.staging.poses import upright
from acts.staging.window import KnownFrames, KnownPath
from motion import FPS, Duet
from motion.transforms import heading
from webdemo.inference.pipelines.scene import SceneMaker, Setting
from webdemo.inference.run import CancelToken, Result, StageTimer
from webdemo.inference.story import SceneRequest

BETWEEN = 40
"""Frames between two given poses up to which people go straight from one to the other."""
_DEFAULT = ((0.0, 0.0, 0.0), (0.0, 1.5, np.pi))


class Follower:
    """Makes the windows of scenes; keeps their settings in ``settings``."""

    digest = "follower"

    def __init__(self, patch: pytest.MonkeyPatch) -> None:
        patch.setattr(Setting, "scene", lambda setting, pipeline: setting)
        patch.setattr(Setting, "share", lambda *_: 0.0)
        self.settings: list[Setting] = []

    def sample(self, settings: Any, words: Any, given: Any, *_: Any, **__: Any) -> Iterator[Result]:
        """One result: upright people at the given places, in the given poses where whole legs are given."""
        self.settings.append(given)
        people = np.stack([followed(given, person) for person in (0, 1)])
        yield Result(duets=(Duet.from_positions(people, fps=FPS),), readouts=({"damped": 0.0},))

    def scene(self, request: SceneRequest) -> Result:
        """A scene's result; ``settings`` are those of its windows."""
        self.settings = []
        pipeline: Any = SimpleNamespace(sample=self.sample, digest=self.digest)
        *_, result = SceneMaker(pipeline, lambda *_: None).run(request, CancelToken(), StageTimer())
        assert isinstance(result, Result)
        return result


def followed(setting: Setting, person: int) -> np.ndarray:
    """The positions (T, 22, 3) of a person in the network's frame."""
    places: dict[int, tuple[float, float]] = {}
    angles: dict[int, float] = {}
    bodies: dict[int, tuple[list[int], np.ndarray]] = {}
    for part in (part for part in setting.parts if part.person == person):
        if isinstance(part, KnownPath):
            places |= {f: (p[0], p[1]) for f, p in zip(part.frames, part.places, strict=True)}
            if part.headings is not None:
                angles |= dict(zip(part.frames, part.headings.tolist(), strict=True))
        elif isinstance(part, KnownFrames) and (not part.joints or 0 in part.joints):
            for frame, pose in zip(part.frames, np.asarray(part.positions, dtype=float), strict=True):
                places[frame] = (pose[0, 0], pose[0, 2])
                if not part.joints:
                    angles[frame] = float(heading(pose[None])[0])
                bodies[frame] = (list(part.joints) or list(range(len(pose))), pose)
    x, z, angle = _DEFAULT[person]
    time, known, turned = np.arange(setting.frames), sorted(places), sorted(angles)
    xs, zs = ([places[f][axis] for f in known] or [(x, z)[axis]] for axis in (0, 1))
    at = np.stack([np.interp(time, known or [0], values) for values in (xs, zs)], axis=1)
    facing = np.interp(time, turned or [0], np.unwrap([angles[f] for f in turned] or [angle]))
    found = np.stack([upright(place, a) for place, a in zip(at, facing, strict=True)])
    found += np.insert(at - found[:, 0][:, [0, 2]], 1, 0.0, axis=1)[:, None]
    for frame, last in list(itertools.pairwise(sorted(bodies))):  # from one pose straight to the next
        near = last - frame <= BETWEEN and bodies[frame][0] == bodies[last][0]
        for t in range(frame + 1, last if near else frame + 1):
            share = (t - frame) / (last - frame)
            bodies[t] = (bodies[frame][0], bodies[frame][1] * (1 - share) + bodies[last][1] * share)
    for frame, (joints, body) in bodies.items():  # what is not given moves with the pelvis
        found[frame] += body[0] - found[frame, 0]
        found[frame, joints] = body[joints]
    return found


def speeds(positions: np.ndarray) -> np.ndarray:
    """Metres a second of the roots (2, T - 1) of two people (2, T, 22, 3) over the floor."""
    return np.linalg.norm(np.diff(positions[:, :, 0][..., [0, 2]], axis=1), axis=-1) * FPS
