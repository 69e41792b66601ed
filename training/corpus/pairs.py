"""Recorded pairs as scenes: SBU and K3HI on the 22-joint skeleton, cleaned, planted, described.

The way of a clip: camera made level → exchanged sides and spikes undone → each person on the floor →
:func:`webdemo.motion.ik.fit_skeleton` → 30 fps → hands brought together where the interaction has them
touch → feet planted → judged. A clip that is judged bad is dropped and counted with its reason: a few good
pairs teach more than many broken ones.
"""

from __future__ import annotations

import json
import os
import tempfile
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from webdemo.motion.cleaning import foot_contacts, plant_feet, solve_two_bones
from webdemo.motion.ik import body_scale, fit_skeleton
from webdemo.motion.kinematics import project_to_skeleton
from webdemo.motion.skeleton import SMPL22
from webdemo.motion.transforms import canonicalize, facing, resample

from .captions import Phrasebook
from .k3hi import read_k3hi
from .sbu import KinectPair, exchanged, read_sbu, unswap, upright, without_sideways_lean, without_spikes
from .scene import Scene

Array = NDArray[np.floating]

FPS = 30.0
CACHE_VERSION = 1
_ANKLE = float(-SMPL22.offsets[SMPL22.index("left_foot"), 1])  # height of an ankle over its sole
_DEPTH_TRUST = 0.4  # a Kinect's depth is about this much less certain than its image plane, as a weight
_NOISE = 0.02  # metres; the tracker keeps many bones rigid, so bones alone would tell too little
_LEFT, _RIGHT = "left", "right"
# Wrists of hands that touch stay apart by the hands themselves.
_TOUCH = {"handshake": 0.16, "exchange": 0.24}
_MEANT_TO_FACE = {"kick", "push", "handshake", "exchange", "punch", "point"}


@dataclass
class Report:
    """How the fit went: kept clips and reasons of the dropped ones by data set and family, errors in mm."""

    kept: Counter[str] = field(default_factory=Counter)
    dropped: Counter[str] = field(default_factory=Counter)
    errors: dict[str, list[float]] = field(default_factory=dict)

    def lines(self) -> list[str]:
        lines = [
            f"{name}: {count} kept, fit error {1000 * np.median(self.errors[name]):.0f} mm"
            for name, count in sorted(self.kept.items())
        ]
        return lines + [f"dropped {count}: {reason}" for reason, count in sorted(self.dropped.items())]


def load_pairs(data_dir: str | Path, cache: str | Path | None = None, *, report: Report | None = None) -> list[Scene]:
    """All good recorded pairs as scenes, fitted once and then read from a cache.

    Args:
        data_dir: the folder that holds ``sbu`` and ``k3hi``, unpacked or as archives.
        cache: folder of the cache file; by default ``data_dir``.
        report: filled with counts and errors.

    Returns:
        scenes with split "train" or "benchmark" (the published test lists: keep them out of training).

    Raises:
        InputError: if the data are not there.
    """
    path = Path(cache or data_dir) / f"pairs-{CACHE_VERSION}.npz"
    if path.is_file():
        return _load(path, report)
    report = report if report is not None else Report()
    scenes = []
    for pair in [*read_sbu(data_dir), *read_k3hi(data_dir)]:
        scene = build_scene(pair, report)
        if scene is not None:
            scenes.append(scene)
    _save(path, scenes, report)
    return scenes


def build_scene(pair: KinectPair, report: Report | None = None) -> Scene | None:
    """One recorded pair as a scene, or ``None`` where it is judged bad (``report`` says why)."""
    report = report if report is not None else Report()
    name = f"{pair.dataset} {pair.family}"
    if pair.split == "unlisted":
        if pair.family not in ("approach", "depart"):
            report.dropped[f"{name}: who acts is not known"] += 1
            return None
        # Whoever walks further is the one who approaches or departs.
        travel = [np.linalg.norm(np.ptp(person[:, :, [0, 2]].mean(axis=1), axis=0)) for person in pair.positions]
        pair = pair.swapped() if travel[1] > travel[0] else pair
    people, error = fit_pair(pair)
    people = _meet(people, pair.family)
    people = canonicalize(np.stack([_settle(person) for person in people]))
    reason = _fault(people, pair.family, error)
    if reason:
        report.dropped[f"{name}: {reason}"] += 1
        return None
    report.kept[name] += 1
    report.errors.setdefault(name, []).append(error)
    source = f"{pair.dataset}/{pair.name}"
    slots, events = describe(people, pair.family)
    split = "benchmark" if pair.split == "benchmark" else "train"
    captions = Phrasebook(pair.family).sample(np.random.default_rng(_seed(source)), slots, n=8, name_side=False)
    return Scene(people.astype(np.float32), pair.family, captions, (source,), split, events)


def fit_pair(pair: KinectPair) -> tuple[Array, float]:
    """Two people on SMPL22 from a Kinect's joints: repaired, fitted, at 30 fps, feet at the floor.

    Returns:
        (2, T, 22, 3) metres in a level frame, and the larger of the two fit errors in metres.
    """
    repaired, weights = zip(*(_repair(pair, person) for person in (0, 1)), strict=True)
    sizes = [body_scale(person, pair.skeleton) for person in repaired]
    scale = float(np.mean(sizes))
    fits = [
        fit_skeleton(person, pair.skeleton, weights=weight, fps=pair.fps, noise=_NOISE, scale=scale)
        for person, weight in zip(repaired, weights, strict=True)
    ]
    people = [
        project_to_skeleton(resample(fit.positions, pair.fps, FPS))[0] if pair.fps != FPS else fit.positions
        for fit in fits
    ]
    return np.stack(people), max(fit.error for fit in fits)


def _repair(pair: KinectPair, person: int) -> tuple[Array, Array]:
    """(T, 15, 3) level positions over the floor with sides and spikes mended, and (T, 15, 3) weights."""
    skeleton = pair.skeleton
    level = upright(pair.positions, pair.pitch)
    own, other = level[person], level[1 - person]
    for parts in (("shoulder", "elbow", "wrist", "hip", "knee", "foot"), ("knee", "foot"), ("foot",)):
        own, _ = unswap(own, skeleton, parts, pair.fps)
    if _back_to_front(own, other, pair):
        own = exchanged(own, skeleton)
    own = without_spikes(without_sideways_lean(own, skeleton), pair.fps)
    feet = own[:, [skeleton.index("left_foot"), skeleton.index("right_foot")]]
    # Depth noise lifts and sinks feet; the lower fifth of heights is where they stand.
    own = own - np.array([0.0, np.nanpercentile(feet[..., 1], 20) - _ANKLE, 0.0])
    weights = np.broadcast_to(np.array([1.0, 1.0, _DEPTH_TRUST]), own.shape)
    return own, weights


def _back_to_front(own: Array, other: Array, pair: KinectPair) -> bool:
    """Whether the tracker took this person's back for the front.

    Who walks some way walks forwards; otherwise, in everything but a departure, the two face each other.
    """
    index = pair.skeleton.index
    across = (own[:, index("left_hip")] - own[:, index("right_hip")])[:, [0, 2]]
    forward = np.stack([-across[:, 1], across[:, 0]], axis=-1)
    middle = own[:, index("torso")][:, [0, 2]]
    walk = middle[-1] - middle[0]
    if pair.family in ("approach", "depart"):
        if np.linalg.norm(walk) < 0.5:
            return pair.family == "approach" and _mean_cos(forward, other[:, index("torso")][:, [0, 2]] - middle) < -0.3
        return _mean_cos(forward, walk[None]) < -0.3
    return _mean_cos(forward, other[:, index("torso")][:, [0, 2]] - middle) < -0.3


def _mean_cos(first: Array, second: Array) -> float:
    product = np.sum(first * second, axis=-1)
    return float(np.mean(product / np.maximum(np.linalg.norm(first, axis=-1) * np.linalg.norm(second, axis=-1), 1e-9)))


def _settle(positions: Array) -> Array:
    """One person's feet on the floor, held where they stand."""
    feet = positions[:, [SMPL22.index("left_foot"), SMPL22.index("right_foot")], 1]
    positions = positions - np.array([0.0, np.percentile(feet.min(axis=1), 30), 0.0])
    return plant_feet(positions, foot_contacts(positions, FPS, speed=0.6))


def _wrists(people: Array) -> tuple[Array, Array]:
    """(T, 3) right wrists of the two."""
    wrist = SMPL22.index("right_wrist")
    return people[0, :, wrist], people[1, :, wrist]


def _meet(people: Array, family: str) -> Array:
    """Brings the right hands together where they nearly meet: first the people, then the arms."""
    if family not in _TOUCH:
        return people
    apart = _TOUCH[family]
    one, other = _wrists(people)
    gap = np.linalg.norm(one - other, axis=-1)
    near = gap < max(gap.min() + 0.12, apart)
    if gap.min() > 0.6:
        return people
    between = (other - one)[near].mean(axis=0) * np.array([1.0, 0.0, 1.0])
    distance = float(np.linalg.norm(between))
    # Kinects and borrowed proportions put two people too near or too far by a hand; move them, half each.
    shift = between * (1 - apart / max(distance, 1e-6)) / 2 if distance > 1e-3 else between * 0
    shift *= min(1.0, 0.15 / max(float(np.linalg.norm(shift)), 1e-9))
    people = np.stack([people[0] + shift, people[1] - shift])
    one, other = _wrists(people)
    centre, axis = (one + other) / 2, other - one
    axis /= np.maximum(np.linalg.norm(axis, axis=-1, keepdims=True), 1e-9)
    weight = _fade(near, frames=6)[:, None]
    goals = (centre - axis * apart / 2, centre + axis * apart / 2)
    return np.stack(
        [_reach(person, (1 - weight) * wrist + weight * goal) for person, wrist, goal in
         zip(people, (one, other), goals, strict=True)]
    )  # fmt: skip


def _fade(mask: NDArray[np.bool_], *, frames: int) -> Array:
    """1 inside the mask, falling smoothly to 0 over ``frames`` outside it."""
    index = np.arange(len(mask))
    distance = np.abs(index[:, None] - index[mask][None]).min(axis=1) if mask.any() else np.full(len(mask), frames)
    return 0.5 + 0.5 * np.cos(np.pi * np.clip(distance / frames, 0, 1))


def _reach(positions: Array, goal: Array) -> Array:
    """One person's right wrist at ``goal`` (T, 3)."""
    shoulder, elbow, wrist = (SMPL22.index(f"right_{part}") for part in ("shoulder", "elbow", "wrist"))
    pole = positions[:, elbow] - (positions[:, shoulder] + positions[:, wrist]) / 2 + np.array([0.0, -0.02, 0.0])
    result = positions.copy()
    result[:, elbow], result[:, wrist] = solve_two_bones(
        positions[:, shoulder], positions[:, elbow], positions[:, wrist], goal, pole
    )
    return result


def _fault(people: Array, family: str, error: float) -> str | None:
    """Why a fitted clip is not good enough to learn from, or ``None``."""
    if people.shape[1] < 24:
        return "shorter than 0.8 s"
    if error > 0.09:
        return "fit further than 90 mm from the joints"
    if (np.abs(np.diff(people, axis=1)) * FPS).max() > 14:
        return "a joint moves faster than 14 m/s"
    lean = people[:, :, SMPL22.index("neck")] - people[:, :, 0]
    if (lean[..., 1] / np.linalg.norm(lean, axis=-1)).min() < 0.5:
        return "a body leans over by more than 60°"
    if family in _MEANT_TO_FACE:
        towards = (people[1, :, 0] - people[0, :, 0]) * np.array([1.0, 0.0, 1.0])
        towards /= np.maximum(np.linalg.norm(towards, axis=-1, keepdims=True), 1e-9)
        cos = [np.mean(np.sum(facing(people[0]) * towards, -1)), np.mean(np.sum(facing(people[1]) * -towards, -1))]
        if min(cos) < 0.5:
            return "the two do not face each other"
    if family in _TOUCH and np.linalg.norm(np.subtract(*_wrists(people)), axis=-1).min() > 0.35:
        return "the hands do not meet"
    return None


def describe(people: Array, family: str) -> tuple[dict[str, Any], dict[str, Any]]:
    """(slots of the phrase book, events of the scene) that the motion shows.

    Args:
        people: (2, T, 22, 3) metres.
    """
    slots: dict[str, Any] = {}
    events: dict[str, Any] = {}
    if family in _MEANT_TO_FACE:
        events["facing"] = True
    if family in ("approach", "depart"):
        events["distance"] = "approach" if family == "approach" else "part"
    if family in ("kick", "punch", "push", "point"):
        side = _striking_side(people, "foot" if family == "kick" else "wrist")
        if side is not None and family != "push":
            slots["side_a"] = side
            events["side"] = {"a": side}
    if family in _TOUCH:
        touching = np.flatnonzero(np.linalg.norm(np.subtract(*_wrists(people)), axis=-1) < _TOUCH[family] + 0.06)
        if len(touching):
            start, end = int(touching[0]), int(touching[-1])
            events["contact"] = [{"a": "right_wrist", "b": "right_wrist", "start": start, "end": end}]
        slots["side_a"] = _RIGHT
        events["side"] = {"a": _RIGHT}
    return slots, events


def _striking_side(people: Array, part: str) -> str | None:
    """The actor's hand or foot that goes towards the other, where one clearly leads."""
    towards = (people[1, :, 0] - people[0, :, 0]) * np.array([1.0, 0.0, 1.0])
    towards /= np.maximum(np.linalg.norm(towards, axis=-1, keepdims=True), 1e-9)
    reach = {
        side: np.max(np.sum((people[0, :, SMPL22.index(f"{side}_{part}")] - people[0, :, 0]) * towards, axis=-1))
        for side in (_LEFT, _RIGHT)
    }
    if abs(reach[_LEFT] - reach[_RIGHT]) < 0.12:
        return None
    return max(reach, key=lambda side: reach[side])


def _seed(text: str) -> int:
    return int.from_bytes(text.encode()[-8:], "little")


def _save(path: Path, scenes: list[Scene], report: Report) -> None:
    meta = [
        {"family": s.family, "captions": s.captions, "sources": s.sources, "split": s.split, "events": s.events}
        for s in scenes
    ]
    summary = {"kept": report.kept, "dropped": report.dropped, "errors": report.errors}
    lengths = np.array([scene.positions.shape[1] for scene in scenes])
    joined = np.concatenate([s.positions for s in scenes], axis=1) if scenes else np.zeros((2, 0, 22, 3), np.float32)
    path.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.NamedTemporaryFile(dir=path.parent, suffix=".npz", delete=False) as file:
        np.savez(file, positions=joined, lengths=lengths, meta=json.dumps(meta), report=json.dumps(summary))
    os.replace(file.name, path)


def _load(path: Path, report: Report | None) -> list[Scene]:
    with np.load(path, allow_pickle=False) as stored:
        meta = json.loads(str(stored["meta"]))
        parts = np.split(stored["positions"], np.cumsum(stored["lengths"])[:-1], axis=1)
        summary = json.loads(str(stored["report"]))
    if report is not None:
        report.kept.update(summary["kept"])
        report.dropped.update(summary["dropped"])
        report.errors.update(summary["errors"])
    return [Scene(positions, **{**entry, "sources": tuple(entry["sources"])})
            for positions, entry in zip(parts, meta, strict=False)]  # fmt: skip
