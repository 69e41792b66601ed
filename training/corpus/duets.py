"""Real duets as scenes: CMU's salsa takes (subjects 60 and 61), two people of one recording in one world, cut into
windows. A turn under a raised arm is measured and told; the rest of a window is a dance.
"""

from __future__ import annotations

import zlib
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import numpy as np
from scipy.ndimage import binary_opening, uniform_filter1d

from motion import FPS, InputError
from motion.retarget import retarget_together
from motion.skeleton import SMPL22
from motion.transforms import canonicalize, heading
from motion.vectors import Array, runs

from .cues import Beat, Scene
from .sources import read_upright, unpacked
from .telling import describe

SALSA = "cmu-salsa"
"""The folder of the takes."""
HELD_OUT = ("05", "14")
"""Takes whose windows are all for testing."""
TAIL = 0.1
"""Share of every other take, at its end, that is for testing."""
SECONDS = (2.2, 3.3, 5.0, 7.0, 10.0)
"""Lengths of windows; each begins half its length after the one before."""
LED = 0.32
"""Metres between two wrists while one dancer turns under them."""
LIVELY = 0.3
"""Mean speed of the joints in metres a second, over a second, from which a person dances; half of the time two salsa
dancers are both faster than 0.5."""
TURN = np.radians(250)
"""How far a dancer turns under a raised arm, at least."""
BRIEF = 24
"""Frames below which the dance between two turns is no beat of its own."""
_WRISTS = [SMPL22.index("left_wrist"), SMPL22.index("right_wrist")]
_NECK = SMPL22.index("neck")
_SECOND = int(FPS)


def load_duets(root: str | Path) -> list[Scene]:
    """All windows of the duets below a data folder, described; none where there are no duets.

    Args:
        root: holds the folder :data:`SALSA`, unpacked or as an archive.
    """
    return [scene for name, people in read_takes(Path(root)) for scene in windows(name, people)]


def read_takes(root: Path) -> Iterator[tuple[str, Array]]:
    """The takes that are there, ``NAME_a.bvh`` beside ``NAME_b.bvh``: NAME, and (2, T, 22, 3) metres in one world."""
    with unpacked(root / SALSA) as files:
        for path in files:
            other = path.with_name(path.name.replace("_a.bvh", "_b.bvh"))
            if other != path and other in files:
                with suppress(InputError):
                    people = retarget_together([read_upright(path), read_upright(other)], fps=FPS)
                    yield path.stem.removesuffix("_a"), np.stack([one.positions for one in people]).astype(np.float64)


def windows(take: str, both: Array) -> Iterator[Scene]:
    """The scenes of a take of two people (2, T, 22, 3), of all lengths of :data:`SECONDS`, from when they dance."""
    first, last = danced(both)
    tail, own = last - round(TAIL * (last - first)), f"{SALSA}/{take}"
    parts = [(first, tail, "train", own), (tail, last, "test", f"{own}-end")]
    for begin, end, split, name in [(first, last, "test", own)] if take in HELD_OUT else parts:
        for seconds in SECONDS:
            length = round(seconds * FPS)
            for start in range(begin, end - length + 1, length // 2):
                people = both[:, start : start + length]
                rng = np.random.default_rng([zlib.crc32(name.encode()), length, start])
                placed = canonicalize(people).astype(np.float32)
                yield describe(rng, Scene(placed, "salsa", (name,), split, played=dance_beats(people)))


def danced(people: Array) -> tuple[int, int]:
    """First and last (exclusive) frame between which both dance, from a second after they set out."""
    speed = np.linalg.norm(np.diff(people, axis=1), axis=-1).mean(axis=-1) * FPS
    both = uniform_filter1d(speed, _SECOND, axis=1, mode="nearest").min(axis=0) > LIVELY
    frames = np.flatnonzero(binary_opening(both, np.ones(_SECOND)))
    return (int(frames[0]) + _SECOND, int(frames[-1]) + 2) if len(frames) else (0, 0)


def dance_beats(people: Array) -> list[Beat]:
    """The beats of two who dance: a dance, and between its parts one who turns the other under a raised arm."""
    beats, done = list[Beat](), 0
    for patient, start, stop in [*twirls(people), (None, people.shape[1], 0)]:
        if start - done >= BRIEF or (patient is None and not beats):
            beats.append(Beat(("dance", "dance"), done, start, relation="while"))
        if patient is not None and start >= done:
            acts = ("twirl", "") if patient else ("", "twirl")
            beats.append(Beat(acts, start, stop, first=1 - patient, relation="while"))
            done = stop
    return beats


def twirls(people: Array) -> list[tuple[int, int, int]]:
    """(who turns, first frame, last frame) of turns by :data:`TURN` or more under hands that are joined and raised."""
    a, b = people[0][:, _WRISTS], people[1][:, _WRISTS]
    gaps = np.linalg.norm(a[:, :, None] - b[:, None], axis=-1)  # of each wrist of a from each of b
    led = gaps.min(axis=(1, 2)) < LED
    own, other = np.unravel_index(gaps.reshape(len(gaps), -1).argmin(axis=1), (2, 2))
    rows = np.arange(len(gaps))
    height = (a[rows, own, 1] + b[rows, other, 1]) / 2
    angles = [np.unwrap(heading(person)) for person in people]
    turns = []
    for patient in (0, 1):
        raised = led & (height > people[patient, :, _NECK, 1])
        rate = uniform_filter1d(np.gradient(angles[patient]) * FPS, 5, mode="nearest")
        for sign in (1.0, -1.0):
            for start, stop in runs(sign * rate > np.radians(45)):
                turned = abs(angles[patient][stop - 1] - angles[patient][start])
                led_by = abs(angles[1 - patient][stop - 1] - angles[1 - patient][start])
                if turned >= TURN and led_by < turned / 2 and raised[start:stop].mean() > 0.3:
                    turns.append((patient, start, stop))
    return sorted(turns, key=lambda one: one[1])
