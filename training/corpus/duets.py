"""Real duets as scenes: two people of one recording in one world, cut into windows, with what they do when.

The sets are CMU's salsa takes (subjects 60 and 61) and a handshake (18 and 19), two BVH files a take. What a window
shows is measured: hands that are joined, a turn under a raised arm, people who come together and part.
"""

from __future__ import annotations

import zlib
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import groupby
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_closing, binary_opening, uniform_filter1d

from motion import InputError, stacked_positions
from motion.retarget import retarget_duet
from motion.skeleton import SMPL22
from motion.transforms import canonicalize, heading
from motion.vectors import runs

from .checks import fault
from .compose import FPS
from .cues import Beat, Scene, label
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


# ---- what two recorded people do when ------------------------------------------------------------


JOINED = 0.25
"""Metres between two wrists whose hands hold each other."""
LED = 0.32
"""Metres between two wrists while one dancer turns under them, when the hold is loose."""
LIVELY = 0.3
"""Mean speed of the joints in metres a second, over a second, from which a person dances; half of the time two salsa
dancers are both faster than 0.5."""
TURN = np.radians(250)
"""How far a dancer turns under a raised arm, at least."""
BRIEF = 24
"""Frames below which a hold, or its absence, is no act of its own."""
_WRISTS = [SMPL22.index("left_wrist"), SMPL22.index("right_wrist")]
_NECK = SMPL22.index("neck")
_SECOND = int(FPS)


def danced(people: Array) -> tuple[int, int]:
    """First and last (exclusive) frame between which both dance, from a second after they set out."""
    speed = np.linalg.norm(np.diff(people, axis=1), axis=-1).mean(axis=-1) * FPS
    both = uniform_filter1d(speed, _SECOND, axis=1, mode="nearest").min(axis=0) > LIVELY
    frames = np.flatnonzero(binary_opening(both, np.ones(_SECOND)))
    return (int(frames[0]) + _SECOND, int(frames[-1]) + 2) if len(frames) else (0, 0)


def wrist_gaps(people: Array) -> Array:
    """(T, 2, 2) metres between each wrist of a and each of b, left before right."""
    a, b = people[0][:, _WRISTS], people[1][:, _WRISTS]
    return np.linalg.norm(a[:, :, None] - b[:, None], axis=-1)


def dance_beats(people: Array) -> list[Beat]:
    """The beats of two who dance: in hold, apart, and one turning the other under a raised arm."""
    frames = people.shape[1]
    hold = _steady(wrist_gaps(people).min(axis=(1, 2)) < JOINED)
    kinds = np.where(hold, "waltz", "dance").astype(object)
    for patient, start, stop in twirls(people):
        kinds[start:stop] = f"twirl {patient}"
    beats = []
    for kind, start, stop in _stretches(_merged(kinds)):
        if kind.startswith("twirl"):
            acts = ("", "twirl") if kind.endswith("0") else ("twirl", "")
            beats.append(Beat(acts, start, stop, first=int(kind.endswith("0")), relation="while"))
        else:
            beats.append(Beat((kind, kind), start, stop, relation="while"))
    return beats or [Beat(("dance", "dance"), 0, frames, relation="while")]


def twirls(people: Array) -> list[tuple[int, int, int]]:
    """(who turns, first frame, last frame) of turns by :data:`TURN` or more under hands that are joined and raised."""
    gaps = wrist_gaps(people)
    led = gaps.min(axis=(1, 2)) < LED
    own, other = np.unravel_index(gaps.reshape(len(gaps), -1).argmin(axis=1), (2, 2))
    rows = np.arange(len(gaps))
    height = (people[0][:, _WRISTS][rows, own, 1] + people[1][:, _WRISTS][rows, other, 1]) / 2
    angles = [np.unwrap(heading(person)) for person in people]
    found = []
    for patient in (0, 1):
        raised = led & (height > people[patient, :, _NECK, 1])
        rate = uniform_filter1d(np.gradient(angles[patient]) * FPS, 5, mode="nearest")
        for sign in (1.0, -1.0):
            for start, stop in runs(sign * rate > np.radians(45)):
                turned = abs(angles[patient][stop - 1] - angles[patient][start])
                led_by = abs(angles[1 - patient][stop - 1] - angles[1 - patient][start])
                if turned >= TURN and led_by < turned / 2 and raised[start:stop].mean() > 0.3:
                    found.append((patient, start, stop))
    return sorted(found, key=lambda one: one[1])


def handshake_beats(people: Array) -> list[Beat]:
    """The beats of two who come together, shake hands and part."""
    frames = people.shape[1]
    held = np.flatnonzero(wrist_gaps(people)[:, 1, 1] < JOINED)
    if not len(held):
        return [Beat(("walk-up", "walk-up"), 0, frames, relation="while")]
    start, stop = int(held[0]), int(held[-1]) + 1
    beats = [Beat(("shake-hands", "shake-hands"), start, stop, relation="while", sides=("right", "right"))]
    if start > 8:
        beats.insert(0, Beat(("walk-up", "walk-up"), 0, start, relation="while"))
    if frames - stop > 8:
        beats.append(Beat(("part", "part"), stop, frames, relation="while"))
    return beats


def _steady(mask: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Without gaps and moments shorter than :data:`BRIEF`."""
    padded = np.pad(mask, BRIEF, mode="edge")
    line = np.ones(BRIEF)
    return np.asarray(binary_opening(binary_closing(padded, line), line)[BRIEF:-BRIEF])


def _merged(kinds: NDArray[np.object_]) -> list[str]:
    """The kind of each frame, where a hold or its absence that is too brief, as beside a turn, joins its neighbour."""
    merged = [str(kind) for kind in kinds]
    while True:
        stretches = list(_stretches(merged))
        brief = [
            one for one in enumerate(stretches) if one[1][2] - one[1][1] < BRIEF and not one[1][0].startswith("twirl")
        ]
        if not brief or len(stretches) == 1:
            return merged
        number, (_, start, stop) = min(brief, key=lambda one: one[1][2] - one[1][1])
        merged[start:stop] = [stretches[number - 1 if number else 1][0]] * (stop - start)


def _stretches(kinds: list[str]) -> Iterator[tuple[str, int, int]]:
    """(kind, first, last frame (exclusive)) of each stretch of one kind."""
    start = 0
    for kind, frames in groupby(kinds):
        stop = start + len(list(frames))
        yield kind, start, stop
        start = stop
