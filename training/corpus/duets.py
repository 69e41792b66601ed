"""Real duets as scenes: two people of one recording in one world, cut into windows, with what they do when.

The sets are CMU's salsa takes (subjects 60 and 61) and a handshake (18 and 19), two BVH files a take. What a window
shows is measured: hands that are joined, a turn under a raised arm, people who come together and part.
"""

from __future__ import annotations

import zlib
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from motion import InputError, stacked_positions
from motion.retarget import retarget_duet
from motion.transforms import canonicalize

from .checks import fault
from .compose import FPS
from .cues import Beat, label
from .duet_acts import dance_beats, danced, handshake_beats
from .scene import Scene
from .sources import read_upright, unpacked
from .telling import Teller, describe

Array = NDArray[np.floating]

SETS = {"cmu-salsa": "salsa", "cmu-handshake": "real-handshake"}
"""The family of each data set's scenes, by its folder."""
HELD_OUT = ("cmu-salsa/05", "cmu-salsa/14")
"""Takes whose windows are all for testing."""
TAIL = 0.1
"""Share of every other take of dancers, at its end, that is for testing."""
SECONDS = (2.2, 3.3, 5.0, 7.0, 10.0)
"""Lengths of windows; each begins half its length after the one before."""


@dataclass(frozen=True, eq=False)
class Take:
    """A recorded duet.

    Attributes:
        name: of the data set and the take, as "cmu-salsa/05".
        people: (2, T, 22, 3) metres at 30 fps, floor at 0.
    """

    name: str
    people: Array = field(repr=False)


def load_duets(root: str | Path, tally: Counter[str] | None = None) -> list[Scene]:
    """All good windows of the real duets below a data folder, described; none where there are no duets.

    Args:
        root: holds the folders of :data:`SETS`, unpacked or as archives.
        tally: counts windows that were left out, by reason.
    """
    scenes = []
    for take in read_takes(Path(root)):
        for scene in windows(take):
            why = fault(scene)
            if why is None:
                scenes.append(scene)
            elif tally is not None:
                tally[why] += 1
    return scenes


def read_takes(root: Path) -> Iterator[Take]:
    """The takes of every set that is there: ``NAME_a.bvh`` beside ``NAME_b.bvh``.

    Where one file of each kind is all there is, they are a pair whatever their names.
    """
    for dataset in SETS:
        with unpacked(root / dataset) as files:
            a, b = ([path for path in files if path.stem.endswith(f"_{who}")] for who in "ab")
            for path in a:
                name = path.stem.removesuffix("_a")
                other = b[0] if len(a) == len(b) == 1 else path.with_name(f"{name}_b.bvh")
                if other not in b:
                    continue
                try:
                    yield Take(f"{dataset}/{name}", read_people(path, other))
                except InputError:
                    continue


def read_people(a: Path, b: Path) -> Array:
    """(2, T, 22, 3) metres at 30 fps of two files that share one world; Y is up in them, their first frame a T-pose."""
    duet = retarget_duet(read_upright(a), read_upright(b), fps=FPS)
    return stacked_positions(duet).astype(np.float64)


def windows(take: Take) -> Iterator[Scene]:
    """The scenes of a take: of dancers windows of several lengths, of others the whole take."""
    family = SETS[take.name.partition("/")[0]]
    if family != "salsa":
        yield _scene(take, family, take.people, "train", handshake_beats(take.people))
        return
    first, last = danced(take.people)
    tail = last if take.name in HELD_OUT else last - round(TAIL * (last - first))
    parts = [(first, tail, "test" if take.name in HELD_OUT else "train")]
    if tail < last:
        parts.append((tail, last, "test"))
    for begin, end, split in parts:
        for start, stop in spans(begin, end):
            people = take.people[:, start:stop]
            yield _scene(take, family, people, split, dance_beats(people), start)


def spans(begin: int, end: int) -> Iterator[tuple[int, int]]:
    """First and last (exclusive) frames of windows of all :data:`SECONDS` between two frames."""
    for seconds in SECONDS:
        length = round(seconds * FPS)
        for start in range(begin, end - length + 1, length // 2):
            yield start, start + length


def _scene(take: Take, family: str, people: Array, split: str, beats: list[Beat], start: int = 0) -> Scene:
    rng = np.random.default_rng([zlib.crc32(take.name.encode()), people.shape[1], start])
    name = take.name if split == "train" or take.name in HELD_OUT else f"{take.name}-end"
    placed = canonicalize(people).astype(np.float32)
    scene = describe(rng, Scene(placed, family, (name,), split, played=beats), sides=False)
    if family == "salsa":
        _in_short(rng, scene)
    return scene


def _in_short(rng: np.random.Generator, scene: Scene) -> None:
    """Puts captions of the whole dance beside those of its parts; no caption calls a salsa a waltz."""
    whole = Beat(("dance", "dance"), 0, scene.positions.shape[1], relation="while")
    short = Teller(rng, label([whole], scene.positions.shape[1]), scene.split)
    captions = [text for text in scene.captions if "waltz" not in text]
    scene.captions = list(dict.fromkeys([*captions[:5], *short.scene(3)]))
    alone = [[text for text in own if "waltz" not in text] for own in scene.alone]
    scene.alone = (alone[0] or short.alone("a"), alone[1] or short.alone("b"))
