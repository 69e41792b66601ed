"""Recorded pairs: the listed clips of SBU and K3HI on 22 joints, and those of the training lists as scenes."""

from __future__ import annotations

import zlib
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from motion import FPS
from motion.cleaning import foot_contacts, plant_feet
from motion.skeleton import SMPL22
from motion.smoothing import eased_marks
from motion.transforms import canonicalize, facing
from motion.vectors import FLAT, Array, unit

from .checks import slower_foot
from .compose import ARMS
from .contact import settle
from .cues import STILL, Beat, Scene
from .kinect import RELEASES, Pair, fitted, read_release
from .sources import kept
from .telling import describe

CACHE = "pairs-4.npz"
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
"""The cues of a and b that a class shows; what the other does of a blow is left open."""
_FACING = ("kick", "push", "handshake", "exchange", "punch")
"""Classes whose people face each other."""
_TOUCH = {"handshake": 0.10, "exchange": 0.18}
"""Metres between the wrists of the hands that meet."""
_NEAR = 0.12
"""Metres beyond the smallest gap between two hands up to which they are brought together."""


def load_pairs(data: str | Path, cache: str | Path | None = None) -> list[Pair]:
    """All listed clips, fitted once (about five minutes) and then read from a cache.

    Args:
        data: the folder that holds ``sbu`` and ``k3hi``, unpacked or as archives.
        cache: folder of the cache file; by default ``data``.

    Raises:
        InputError: if the data are not there.
    """
    path = Path(cache or data) / CACHE
    return kept(path, Pair, lambda: [fitted(clip) for name in RELEASES for clip in read_release(data, name)])


def scenes_of(pairs: Sequence[Pair], rejected: Counter[str]) -> list[Scene]:
    """The clips of the training lists that fit a body and show their class, with feet planted and hands that meet.

    Args:
        rejected: counts the others, by reason.
    """
    scenes = []
    for pair in pairs:
        if pair.test:
            continue
        bodies = pair.positions.astype(np.float64)
        people = np.stack([plant_feet(body, foot_contacts(body, FPS, speed=0.6)) for body in bodies])
        reason = _fault(people, pair)
        if reason:
            rejected[f"{pair.dataset} {pair.family}: {reason}"] += 1
        else:
            scenes.append(_scene(people, pair))
    return scenes


def _fault(people: Array, pair: Pair) -> str | None:
    """The reason why a clip is not good enough to learn from, or ``None``."""
    if people.shape[1] < 24:
        return "shorter than 0.8 s"
    if pair.error > 0.09:
        return "fit further than 90 mm from the joints"
    if (np.abs(np.diff(people, axis=1)) * FPS).max() > 14:
        return "a joint moves faster than 14 m/s"
    if max(slower_foot(person) for person in people) > 0.4:
        return "feet slide faster than 0.4 m/s"
    lean = people[:, :, SMPL22.index("neck")] - people[:, :, 0]
    if (lean[..., 1] / np.linalg.norm(lean, axis=-1)).min() < 0.5:
        return "a body leans over by more than 60°"
    if pair.family in _FACING:
        towards = unit((people[1, :, 0] - people[0, :, 0]) * FLAT)
        cos = [np.mean(np.sum(facing(people[0]) * towards, -1)), np.mean(np.sum(facing(people[1]) * -towards, -1))]
        if min(cos) < 0.5:
            return "the two do not face each other"
    if pair.family in _TOUCH and _hands(people)[1].min() > 0.45:
        return "the hands do not meet"
    return None


def _scene(people: Array, pair: Pair) -> Scene:
    """A clip as a scene, with its captions and where its hands touch."""
    family, people = as_seen(pair.family, people)
    events = {}
    if family in _TOUCH:
        people, events = _meet(people, _TOUCH[family])
    source, beat = f"{pair.dataset}/{pair.name}", Beat(SHOWS[family], 0, people.shape[1], relation="while")
    scene = Scene(canonicalize(people).astype(np.float32), family, (source,), "train", events, played=[beat])
    return describe(np.random.default_rng(zlib.crc32(source.encode())), scene)


def as_seen(family: str, people: Array) -> tuple[str, Array]:
    """The class that the motion shows, and the people in their roles.

    In some clips of "approaching" and "departing" both walk (meet, part), and some name as the actor the one who
    stands; a caption must be true of what is seen.
    """
    if family not in ("approach", "depart"):
        return family, people
    path = people[:, :, 0][..., [0, 2]]
    walked = np.linalg.norm(path[:, -1] - path[:, 0], axis=-1)
    if walked.min() > 0.4 and walked.min() > 0.45 * walked.max():
        return ("meet" if family == "approach" else "part"), people
    return family, people[::-1] if walked[1] > walked[0] else people


def _hands(people: Array) -> tuple[tuple[str, str], Array]:
    """The sides of the two hands, one of each person, that come nearest to each other, and the metres (T,) between."""
    gaps = {
        (own, other): np.linalg.norm(people[0][:, ARMS[own][3]] - people[1][:, ARMS[other][3]], axis=-1)
        for own in ARMS
        for other in ARMS
    }
    return min(gaps.items(), key=lambda pair: pair[1].min())


def _meet(people: Array, apart: float) -> tuple[Array, dict[str, Any]]:
    """Brings two hands together where they nearly meet; the people, and the scene's events."""
    sides, gap = _hands(people)
    near = gap < max(gap.min() + _NEAR, apart)
    # Depth noise and assumed proportions misplace people by about a hand's width: move each by half of it.
    one, other = (person[near][:, ARMS[side][3]] for person, side in zip(people, sides, strict=True))
    lacking = (other - one).mean(axis=0) * FLAT
    shift = lacking * (1 - apart / max(float(np.linalg.norm(lacking)), 1e-6)) / 2
    shift *= min(1.0, 0.15 / max(float(np.linalg.norm(shift)), 1e-9))
    weight = eased_marks(near, 10)
    people = np.stack(settle(people[0] + shift, people[1] - shift, sides, (weight, weight), apart=apart))
    touching = np.flatnonzero(_hands(people)[1] < apart + 0.05)
    if not len(touching):
        return people, {}
    joints = {role: f"{side}_wrist" for role, side in zip("ab", sides, strict=True)}
    return people, {"contact": [{**joints, "start": int(touching[0]), "end": int(touching[-1])}]}
