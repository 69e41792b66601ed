"""Requests with a child in them: pipelines make motion at an adult's size, and what is asked for is at people's own.

Before the run, what the request gives of the motion is brought to an adult's size (:func:`enlarged`): paths and poses
to where adults would be, and the kept frames of a given motion. After it, people are brought to their own sizes: by
their words in :mod:`webdemo.inference.things`, or by the looks of the given motion here, whose kept frames come back
bit for bit (:func:`as_given`).
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from motion import SMPL22, Clip, Duet, stacked_positions
from motion.looks import UNSAID, grown_up, size_of
from motion.sizes import at_sizes, bones_of, floor_scale, of_adults
from motion.smoothing import smoothstep
from webdemo.inference.requests.acting import plans_of
from webdemo.inference.requests.paths import FloorPath
from webdemo.inference.requests.predict import PredictRequest, PredictResult, compared
from webdemo.inference.run import Result
from webdemo.inference.story.poses import Pose
from webdemo.inference.story.request import SceneRequest
from webdemo.inference.things import looks_in

Array = NDArray[np.floating]

_EASES = 15
"""Frames over which people come from where they are in the kept frames to where they were made."""
_A_CHILD = 0.87
"""Length of the legs, as a share of SMPL22's, below which a pose is one of a child."""


def enlarged(request: Any) -> Any:
    """A request whose paths, poses and given motion are those of two adults; the same one where both are adults."""
    given = getattr(request, "motion", None)
    if isinstance(request, PredictRequest):
        return _of_adults(request)
    if isinstance(request, SceneRequest) and given is not None:
        looks = given.looks
    elif getattr(request, "paths", ()) or getattr(request, "poses", ()):
        looks = looks_in(plan for plan, *_ in plans_of(request))
    else:
        return request
    sizes = _sizes(looks)
    if sizes == (1.0, 1.0):
        return request
    way = 1 / floor_scale(sizes)
    changes: dict[str, Any] = {"paths": tuple(_path(path, way) for path in request.paths)}
    if isinstance(request, SceneRequest):
        changes["poses"] = tuple(_pose(pose, way) for pose in request.poses)
    if given is not None:
        motion = given.with_positions(of_adults(given.positions, sizes))
        changes["motion"] = replace(motion, looks=grown_up(looks))
    return replace(request, **changes)


def as_given(result: Result, request: Any) -> Result:
    """A result that goes on from a given motion, whose people look as they did, at the sizes that they had."""
    given = getattr(request, "motion", None)
    if not isinstance(given, Duet) or given.looks == UNSAID:
        return result
    if isinstance(request, PredictRequest):
        return _predicted(result, given, request)
    kept, made = request.kept(given), request.made
    return replace(result, duets=tuple(_as_given(duet, given, kept, made) for duet in result.duets))


def _of_adults(request: PredictRequest) -> PredictRequest:
    """A prediction from the same two people as adults."""
    given = request.motion
    if not isinstance(given, Duet) or (sizes := _sizes(given.looks)) == (1.0, 1.0):
        return request
    motion = given.with_positions(of_adults(given.positions, sizes))
    return replace(request, motion=replace(motion, looks=grown_up(given.looks)))


def _predicted(result: Result, given: Duet, request: PredictRequest) -> Result:
    """A prediction at the sizes of its people, compared with what they really did next."""
    if _sizes(given.looks) == (1.0, 1.0) or not isinstance(result, PredictResult):
        return result
    first, frames = result.past_frames, result.duets[0].num_frames
    kept = given.positions[:, :first], given.positions[:, :0]
    duets = [_as_given(duet, given, kept, (first, frames)) for duet in result.duets]
    futures = [stacked_positions(duet)[:, first:] for duet in duets]
    curves = compared(request, futures)
    return replace(result, duets=tuple(duets), truth=request.truth, **curves)


def _as_given(duet: Duet | Clip, given: Duet, kept: tuple[Array, Array], made: tuple[int, int]) -> Duet | Clip:
    """People as they are in a ``given`` motion, who were made between the frames of it that are ``kept``."""
    sizes = _sizes(given.looks)
    if not isinstance(duet, Duet) or sizes == (1.0, 1.0):
        return replace(duet, looks=given.looks) if isinstance(duet, Duet) else duet
    (before, after), (first, last) = kept, made
    positions = np.array(at_sizes(duet.positions, sizes))
    bones = bones_of(sizes)
    for edge, beside, step in ((first - 1, before[:, -1:], 1), (last, after[:, :1], -1)):
        if beside.shape[1]:
            positions = _led(positions, edge, beside[:, 0] - positions[:, edge], step, bones)
    positions[:, :first] = before
    positions[:, last:] = after
    return replace(duet.with_positions(positions), looks=given.looks)


def _led(pair: Array, edge: int, miss: Array, step: int, bones: Array) -> Array:
    """Two people (2, T, 22, 3) who are shifted by ``miss`` (2, 22, 3) at a frame, and less and less after it."""
    result = pair.copy()
    for k in range(1, _EASES):
        frame = edge + step * k
        if not 0 <= frame < pair.shape[1]:
            break
        moved = pair[:, frame] + float(smoothstep(1 - k / _EASES)) * miss
        for parent, joint in SMPL22.bones:
            bone = moved[:, joint] - moved[:, parent]
            length = np.maximum(np.linalg.norm(bone, axis=-1, keepdims=True), 1e-9)
            moved[:, joint] = moved[:, parent] + bone * bones[:, joint, None] / length
        result[:, frame] = moved
    return result


def _sizes(looks: tuple[str, str]) -> tuple[float, float]:
    a, b = looks
    return size_of(a), size_of(b)


def _path(path: FloorPath, way: float) -> FloorPath:
    return replace(path, points=tuple(replace(p, x=way * p.x, z=way * p.z) for p in path.points))


def _pose(pose: Pose, way: float) -> Pose:
    """A pose at an adult's size, at an adult's place."""
    own = np.asarray(pose.positions, dtype=np.float64)
    hip, knee, ankle = (SMPL22.index(f"left_{part}") for part in ("hip", "knee", "ankle"))
    legs = np.linalg.norm(own[knee] - own[hip]) + np.linalg.norm(own[ankle] - own[knee])
    size = legs / (SMPL22.bone_lengths[knee] + SMPL22.bone_lengths[ankle])
    grow = 1 / size if size < _A_CHILD else 1.0
    root = own[:1] * [way, grow, way]
    return replace(pose, positions=root + grow * (own - own[:1]))
