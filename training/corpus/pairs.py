"""Recorded pairs as scenes: SBU and K3HI on the 22-joint skeleton, cleaned, planted, described.

The way of a clip: camera made level → exchanged sides and spikes undone → each person on the floor →
:func:`motion.ik.fit_skeleton` → 30 fps → hands brought together where the interaction has them
touch → feet planted → judged. A clip that is judged bad is dropped and counted with its reason: a few good
pairs teach more than many broken ones.
"""

from __future__ import annotations

import json
import logging
import zlib
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_closing, binary_opening, gaussian_filter1d

from motion.cleaning import plant_feet
from motion.formats.files import replacing
from motion.limbs import solve_two_bones
from motion.skeleton import SMPL22
from motion.transforms import canonicalize, facing
from motion.vectors import unit

from .checks import foot_skate
from .cues import STILL, Beat, Scene
from .kinect import ANKLE, FPS, KinectPair, fit_pair, read_pairs
from .telling import describe as write_words

Array = NDArray[np.floating]

logger = logging.getLogger(__name__)
CACHE_VERSION = 3
_ANKLES = [SMPL22.index("left_ankle"), SMPL22.index("right_ankle")]
_TOES = [SMPL22.index("left_foot"), SMPL22.index("right_foot")]
_LEFT, _RIGHT = "left", "right"
# Metres between the wrists of two hands that touch.
_TOUCH = {"handshake": 0.10, "exchange": 0.18}
SHOWS = {
    "approach": ("walk-up", STILL),
    "depart": ("walk-away", STILL),
    "exchange": ("hand-over", "take-from"),
    "handshake": ("shake-hands", "shake-hands"),
    "kick": ("kick", ""),
    "meet": ("walk-up", "walk-up"),
    "part": ("part", "part"),
    "point": ("point", ""),
    "punch": ("punch", ""),
    "push": ("push", ""),
}
"""The cues of a and b that a recorded family shows; what the other does of a blow is left open."""
_MEANT_TO_FACE = {"kick", "push", "handshake", "exchange", "punch"}


def load_pairs(data_dir: str | Path, cache: str | Path | None = None) -> list[Scene]:
    """All good recorded pairs as scenes, fitted once and then read from a cache.

    Args:
        data_dir: the folder that holds ``sbu`` and ``k3hi``, unpacked or as archives.
        cache: folder of the cache file; by default ``data_dir``.

    Returns:
        scenes with split "train" or "benchmark" (the published test lists: keep them out of training).

    Raises:
        InputError: if the data are not there.
    """
    path = Path(cache or data_dir) / f"pairs-{CACHE_VERSION}.npz"
    if not path.is_file():
        left_out: Counter[str] = Counter()
        made = [build_scene(pair, left_out) for pair in read_pairs(data_dir)]
        for reason, count in sorted(left_out.items()):
            logger.warning("Left out %d recorded pairs: %s", count, reason)
        scenes = [scene for scene in made if scene is not None]
        _save(path, scenes)
        return scenes
    with np.load(path, allow_pickle=False) as stored:
        meta = json.loads(str(stored["meta"]))
        parts = np.split(stored["positions"], np.cumsum(stored["lengths"])[:-1], axis=1)
    return [_told(positions, **entry) for positions, entry in zip(parts, meta, strict=True)]


def _save(path: Path, scenes: list[Scene]) -> None:
    meta = [{"family": s.family, "source": s.sources[0], "split": s.split} for s in scenes]
    lengths = np.array([scene.positions.shape[1] for scene in scenes])
    joined = np.concatenate([s.positions for s in scenes], axis=1) if scenes else np.zeros((2, 0, 22, 3), np.float32)
    with replacing(path) as temporary, open(temporary, "wb") as file:
        np.savez(file, positions=joined, lengths=lengths, meta=json.dumps(meta))


def build_scene(pair: KinectPair, left_out: Counter[str]) -> Scene | None:
    """One recorded pair as a scene, or ``None`` if it is not good enough, whose reason is counted."""
    name = f"{pair.dataset} {pair.family}"
    if pair.split == "unlisted":
        if pair.family not in ("approach", "depart"):
            left_out[f"{name}: who acts is not known"] += 1
            return None
        # The person who walks farther is the one who approaches or departs.
        travel = [np.linalg.norm(np.ptp(person[:, :, [0, 2]].mean(axis=1), axis=0)) for person in pair.positions]
        pair = pair.swapped() if travel[1] > travel[0] else pair
    people, error = fit_pair(pair)
    people = np.stack([_settle(person) for person in _meet(people, pair.family)])
    family, people = _as_seen(pair.family, people)
    people = canonicalize(people)
    reason = _fault(people, family, error)
    if reason:
        left_out[f"{name}: {reason}"] += 1
        return None
    split = "benchmark" if pair.split == "benchmark" else "train"
    return _told(people.astype(np.float32), family, f"{pair.dataset}/{pair.name}", split)


def _told(people: Array, family: str, source: str, split: str) -> Scene:
    """The scene with its events, label and captions."""
    scene = Scene(people, family, (source,), split, describe(people, family))
    side = scene.events.get("side", {}).get("a")
    frames = scene.positions.shape[1]
    scene.played = [Beat(SHOWS[family], 0, frames, relation="while", sides=(side, None))]
    return write_words(np.random.default_rng(zlib.crc32(source.encode())), scene, sides=False)


def _as_seen(family: str, people: Array) -> tuple[str, Array]:
    """The family that the motion shows and the people in their roles.

    Some "approaching" and "departing" clips have both walk (meet, part), and some name as the actor the one
    who stands; a caption must be true of what is seen.
    """
    if family not in ("approach", "depart"):
        return family, people
    path = people[:, :, 0][..., [0, 2]]
    walked = np.linalg.norm(path[:, -1] - path[:, 0], axis=-1)
    if walked.min() > 0.4 and walked.min() > 0.45 * walked.max():
        return ("meet" if family == "approach" else "part"), people
    return family, people[::-1] if walked[1] > walked[0] else people


def _settle(positions: Array) -> Array:
    """Puts one person's feet on the floor and plants them where they stand.

    A Kinect's floor drifts by centimetres. Nobody here jumps, so a slowly varying shift first puts the lower foot on
    the floor; then the feet's speed shows when they stand.
    """
    lowest = positions[:, _TOES, 1].min(axis=1)
    lowest = np.minimum(lowest, positions[:, _ANKLES, 1].min(axis=1) - ANKLE)
    positions = positions - gaussian_filter1d(lowest, 4.0, mode="nearest")[:, None, None] * np.array([0.0, 1.0, 0.0])
    return plant_feet(positions, np.repeat(_stands(positions), 2, axis=1))


def _stands(positions: Array) -> NDArray[np.bool_]:
    """(T, 2) whether the left and the right foot stand: slow and not lifted; the slower one, if none is."""
    ankles = gaussian_filter1d(positions[:, _ANKLES], 1.0, axis=0, mode="nearest")
    speed = np.linalg.norm(np.gradient(ankles, axis=0)[..., [0, 2]], axis=-1) * FPS
    low = ankles[..., 1] < ANKLE + 0.15
    standing = (speed < 0.6) & low
    none = ~standing.any(axis=1)
    slower = speed.argmin(axis=1)
    standing[none, slower[none]] = (speed.min(axis=1) < 1.2)[none]
    standing = np.pad(standing, ((3, 3), (0, 0)), mode="edge")
    standing = binary_closing(standing, np.ones((4, 1)))
    return binary_opening(standing, np.ones((4, 1)))[3:-3]


def _hands(people: Array) -> tuple[str, str]:
    """The sides of the two hands, one of each person, that come nearest to each other."""
    gaps = {
        (own, other): np.linalg.norm(np.subtract(*_wrists(people, (own, other))), axis=-1).min()
        for own in (_RIGHT, _LEFT)
        for other in (_RIGHT, _LEFT)
    }
    return min(gaps, key=lambda sides: gaps[sides])


def _wrists(people: Array, sides: tuple[str, str]) -> tuple[Array, Array]:
    """(T, 3) the wrist of each person on its side."""
    first, second = (person[:, SMPL22.index(f"{side}_wrist")] for person, side in zip(people, sides, strict=True))
    return first, second


def _meet(people: Array, family: str) -> Array:
    """Brings hands together where they nearly meet, by moving first the people, then the arms."""
    if family not in _TOUCH:
        return people
    apart = _TOUCH[family]
    sides = _hands(people)
    one, other = _wrists(people, sides)
    gap = np.linalg.norm(one - other, axis=-1)
    if gap.min() > 0.45:
        return people
    near = gap < max(gap.min() + 0.12, apart)
    between = (other - one)[near].mean(axis=0) * np.array([1.0, 0.0, 1.0])
    distance = float(np.linalg.norm(between))
    # Depth noise and assumed proportions misplace people by about a hand's width: move each by half of it.
    shift = between * (1 - apart / max(distance, 1e-6)) / 2
    shift *= min(1.0, 0.15 / max(float(np.linalg.norm(shift)), 1e-9))
    people = np.stack([people[0] + shift, people[1] - shift])
    one, other = _wrists(people, sides)
    centre, axis = (one + other) / 2, other - one
    axis = unit(axis)
    weight = _fade(near, frames=10)[:, None]
    goals = (centre - axis * apart / 2, centre + axis * apart / 2)
    return np.stack(
        [
            _reach(person, side, (1 - weight) * wrist + weight * goal)
            for person, side, wrist, goal in zip(people, sides, (one, other), goals, strict=True)
        ]
    )


def _fade(mask: NDArray[np.bool_], *, frames: int) -> Array:
    """1 inside the mask, falling smoothly to 0 over ``frames`` outside it."""
    index = np.arange(len(mask))
    distance = np.abs(index[:, None] - index[mask][None]).min(axis=1) if mask.any() else np.full(len(mask), frames)
    return 0.5 + 0.5 * np.cos(np.pi * np.clip(distance / frames, 0, 1))


def _reach(positions: Array, side: str, goal: Array) -> Array:
    """One person's wrist at ``goal`` (T, 3)."""
    shoulder, elbow, wrist = (SMPL22.index(f"{side}_{part}") for part in ("shoulder", "elbow", "wrist"))
    pole = positions[:, elbow] - (positions[:, shoulder] + positions[:, wrist]) / 2 + np.array([0.0, -0.02, 0.0])
    result = positions.copy()
    result[:, elbow], result[:, wrist] = solve_two_bones(
        positions[:, shoulder], positions[:, elbow], positions[:, wrist], goal, pole
    )
    return result


def _fault(people: Array, family: str, error: float) -> str | None:
    """The reason why a fitted clip is not good enough to learn from, or ``None``."""
    if people.shape[1] < 24:
        return "shorter than 0.8 s"
    if error > 0.09:
        return "fit further than 90 mm from the joints"
    if (np.abs(np.diff(people, axis=1)) * FPS).max() > 14:
        return "a joint moves faster than 14 m/s"
    if max(foot_skate(person) for person in people) > 0.4:
        return "feet slide faster than 0.4 m/s"
    lean = people[:, :, SMPL22.index("neck")] - people[:, :, 0]
    if (lean[..., 1] / np.linalg.norm(lean, axis=-1)).min() < 0.5:
        return "a body leans over by more than 60°"
    if family in _MEANT_TO_FACE:
        towards = (people[1, :, 0] - people[0, :, 0]) * np.array([1.0, 0.0, 1.0])
        towards = unit(towards)
        cos = [np.mean(np.sum(facing(people[0]) * towards, -1)), np.mean(np.sum(facing(people[1]) * -towards, -1))]
        if min(cos) < 0.5:
            return "the two do not face each other"
    if family in _TOUCH and _hand_gap(people).min() > _TOUCH[family] + 0.05:
        return "the hands do not meet"
    if family == "handshake" and _hands(people) != (_RIGHT, _RIGHT):
        return "other hands than the right meet"
    if family == "point" and _off_target(people) > 40:
        return "the hand points elsewhere"
    return None


def _hand_gap(people: Array) -> Array:
    """(T,) metres between the two wrists that come nearest."""
    return np.linalg.norm(np.subtract(*_wrists(people, _hands(people))), axis=-1)


def _off_target(people: Array) -> float:
    """Degrees over the floor between where the raised arm of the actor points and where the other stands."""
    side = _striking_side(people, "wrist", up=True) or _RIGHT
    shoulder, wrist = (people[0, :, SMPL22.index(f"{side}_{part}")] for part in ("shoulder", "wrist"))
    frame = int((wrist - shoulder)[:, 1].argmax())
    arm = (wrist - shoulder)[frame, [0, 2]]
    target = (people[1, frame, 0] - shoulder[frame])[[0, 2]]
    cos = arm @ target / max(float(np.linalg.norm(arm) * np.linalg.norm(target)), 1e-9)
    return float(np.degrees(np.arccos(np.clip(cos, -1, 1))))


def describe(people: Array, family: str) -> dict[str, Any]:
    """The events of a scene that the motion shows.

    Args:
        people: (2, T, 22, 3) metres.
    """
    events: dict[str, Any] = {}
    if family in _MEANT_TO_FACE:
        events["facing"] = True
    if family in ("approach", "meet", "depart", "part"):
        events["distance"] = "approach" if family in ("approach", "meet") else "part"
    if family in ("kick", "punch", "push", "point"):
        side = _striking_side(people, "foot" if family == "kick" else "wrist", up=family == "point")
        if side is None and family == "push":
            side = "both"
        if side is not None:
            events["side"] = {"a": side}
    if family in _TOUCH:
        sides = _hands(people)
        touching = np.flatnonzero(_hand_gap(people) < _TOUCH[family] + 0.05)
        if len(touching):
            joints = {role: f"{side}_wrist" for role, side in zip("ab", sides, strict=True)}
            events["contact"] = [{**joints, "start": int(touching[0]), "end": int(touching[-1])}]
        events["side"] = {"a": sides[0]}
    return events


def _striking_side(people: Array, part: str, *, up: bool = False) -> str | None:
    """The actor's hand or foot that goes furthest to the other, or highest; ``None`` without a lead."""
    towards = (people[1, :, 0] - people[0, :, 0]) * np.array([1.0, 0.0, 1.0])
    towards = unit(towards)
    direction = np.array([0.0, 1.0, 0.0]) if up else towards
    reach = {
        side: np.max(np.sum((people[0, :, SMPL22.index(f"{side}_{part}")] - people[0, :, 0]) * direction, axis=-1))
        for side in (_LEFT, _RIGHT)
    }
    if abs(reach[_LEFT] - reach[_RIGHT]) < 0.12:
        return None
    return max(reach, key=lambda side: reach[side])
