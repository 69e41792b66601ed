"""The people of a result as they are described: their looks and sizes, and the things of their acts.

Pipelines make motion at an adult's size, and what is asked for is at people's own. Before the run, what the request
gives of the motion is brought to an adult's size (:func:`enlarged`): paths and poses to where adults would be, and the
kept frames of a given motion. After it, people are brought to their own sizes: by their words (:func:`furnished`, which
also gives them the things of the acts), or by the looks of the given motion, whose kept frames come back bit for bit
(:func:`as_given`).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any, TypeGuard

import numpy as np

from acts import Plan
from acts.plan import PlanFrames
from acts.things.furnishing import drawn_otherwise, furnish
from motion import SMPL22, Clip, Duet, stacked_positions
from motion.looks import SIZES, UNSAID, grown_up, looks_of, size_of
from motion.metrics import compare
from motion.sizes import at_sizes, bones_of, floor_scale, of_adults
from motion.smoothing import smoothstep
from motion.vectors import Array
from webdemo.inference.requests.paths import FloorPath
from webdemo.inference.requests.predict import PredictRequest, PredictResult, predicted
from webdemo.inference.run import Result
from webdemo.inference.story.poses import Pose
from webdemo.inference.story.request import SceneRequest

_ALIKE = 0.02
"""Share of an adult's thigh by which a child's bones may differ from those of a child's body."""
_EASES = 15
"""Frames over which people come from where they are in the kept frames to where they were made."""
_WITHOUT_THINGS = "The things of the given motion are not shown: name them in the words."
_A_CHILD = 0.87
"""Length of the legs, as a share of SMPL22's, below which a pose is one of a child."""


def furnished(result: Result, plans: Sequence[PlanFrames], *, given: bool = False) -> Result:
    """A result whose people look as their plans say, with the things of the acts, and hands that take shapes.

    Args:
        result: of two people on SMPL22; another is returned as it is.
        plans: of the request's words.
        given: a part of the motion was given, with adults: nobody is a child.

    Returns:
        the result, with ``things`` in the manifests where there are some, and with shapes of hands.
    """
    looks = looks_in(plan for plan, *_ in plans)
    result = _at_their_sizes(result, grown_up(looks) if given else looks)
    lengths = lengths_of(result.manifest)
    duets = tuple(furnish(each, plans, lengths) if _is_on_bodies(each) else each for each in result.duets)
    rows = [(each.manifest or {}).get("things") if isinstance(each, Duet) else None for each in duets]
    manifest = {**result.manifest, "things": rows[0] or []} if any(rows) else result.manifest
    told = drawn_otherwise(manifest.get("things", ()), plans)
    return replace(result, duets=duets, manifest=manifest, notes=(*result.notes, *told))


def looks_in(plans: Iterable[Plan]) -> tuple[str, str]:
    """The looks of the two people, each as the first plan that says something about them has it."""
    people = [("", ""), ("", "")]
    for plan in plans:
        people = [(sex or p.sex, age or p.age) for (sex, age), p in zip(people, plan.people, strict=True)]
    return looks_of(people)


def lengths_of(manifest: Mapping[str, Any]) -> list[float]:
    """Seconds of the beats into which a sentence was split, from a result's manifest; [] where it was not."""
    plan = manifest.get("plan")
    beats: Iterable[Any] = plan.get("beats", ()) if isinstance(plan, Mapping) else ()
    seconds = [beat.get("seconds") for beat in beats if isinstance(beat, Mapping)]
    return [float(each) for each in seconds if isinstance(each, int | float)]


def _at_their_sizes(result: Result, looks: tuple[str, str]) -> Result:
    """A result whose people look as their plans say, at the sizes of these looks; who looks somehow already, stays so.

    Of people who are smaller than they were made only what is shown is measured.
    """
    if looks == UNSAID:
        return _measured(result, tuple(map(_by_their_bones, result.duets)))
    duets, sizes = list(result.duets), _sizes(looks)
    for i, duet in enumerate(duets):
        if _is_undressed(duet):
            sized = duet if sizes == (1.0, 1.0) else duet.with_positions(at_sizes(duet.positions, sizes))
            duets[i] = replace(sized, looks=looks)
    return _measured(replace(result, manifest={**result.manifest, "looks": list(looks)}), tuple(duets))


def _measured(result: Result, duets: tuple[Duet | Clip, ...]) -> Result:
    """A result of these duets, of which those with a child are measured as they are shown."""
    readouts = list(result.readouts)
    for i, duet in enumerate(duets[: len(readouts)]):
        if _is_on_bodies(duet) and _sizes(duet.looks) != (1.0, 1.0):
            readouts[i] = {**readouts[i], **compare(None, duet)}
    return replace(result, duets=duets, readouts=tuple(readouts))


def _by_their_bones(duet: Duet | Clip) -> Duet | Clip:
    """Two people who are not described; one with a child's bones, such as the given person of a reaction, is one."""
    if not _is_undressed(duet):
        return duet
    hip, knee = (SMPL22.index(f"left_{part}") for part in ("hip", "knee"))
    thighs = np.linalg.norm(duet.positions[:, :, knee] - duet.positions[:, :, hip], axis=-1).mean(axis=1)
    a, b = np.abs(thighs / SMPL22.bone_lengths[knee] - SIZES["boy"]) < _ALIKE
    return replace(duet, looks=("boy" if a else UNSAID[0], "girl" if b else UNSAID[1]))


def _is_on_bodies(duet: Duet | Clip) -> TypeGuard[Duet]:
    """True for two people on SMPL22."""
    return isinstance(duet, Duet) and duet.skeleton.joint_names == SMPL22.joint_names


def _is_undressed(duet: Duet | Clip) -> TypeGuard[Duet]:
    """True for two people on SMPL22 to whom nobody has given looks yet."""
    return _is_on_bodies(duet) and duet.looks == UNSAID


def enlarged(request: Any) -> Any:
    """A request whose paths, poses and given motion are those of two adults; the same one where both are adults."""
    given = getattr(request, "motion", None)
    if isinstance(given, Duet):
        looks = given.looks
    elif getattr(request, "paths", ()) or getattr(request, "poses", ()):
        looks = looks_in(plan for plan, *_ in request.spans())
    else:
        return request
    sizes = _sizes(looks)
    if sizes == (1.0, 1.0):
        return request
    way, changes = 1 / floor_scale(sizes), dict[str, Any]()
    if isinstance(given, Duet):
        adults = given.with_positions(of_adults(given.positions, sizes))
        changes["motion"] = replace(adults, looks=grown_up(looks))
    if not isinstance(request, PredictRequest):
        changes["paths"] = tuple(_path(path, way) for path in request.paths)
    if isinstance(request, SceneRequest):
        changes["poses"] = tuple(_pose(pose, way) for pose in request.poses)
    return replace(request, **changes)


def as_given(result: Result, request: Any) -> Result:
    """A result that goes on from a given motion, whose people look as they did, at the sizes that they had."""
    given = getattr(request, "motion", None)
    if isinstance(given, Duet) and given.things:
        result = replace(result, notes=(*result.notes, _WITHOUT_THINGS))
    if not isinstance(given, Duet) or given.looks == UNSAID:
        return result
    if isinstance(request, PredictRequest):
        return _predicted(result, given, request)
    kept, made = request.kept(given), request.made
    return _measured(result, tuple(_as_given(duet, given, kept, made) for duet in result.duets))


def _predicted(result: Result, given: Duet, request: PredictRequest) -> Result:
    """A prediction at the sizes of its people, compared with what they really did next."""
    if _sizes(given.looks) == (1.0, 1.0) or not isinstance(result, PredictResult):
        return result
    first, frames = result.past_frames, result.duets[0].num_frames
    kept = given.positions[:, :first], given.positions[:, :0]
    duets = [_as_given(duet, given, kept, (first, frames)) for duet in result.duets]
    futures = [stacked_positions(duet)[:, first:] for duet in duets]
    return replace(predicted(request, futures), duets=tuple(duets), notes=result.notes)


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
