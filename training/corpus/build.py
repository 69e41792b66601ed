"""Builds the corpus: draws scenes of each kind, checks each, writes them."""

from __future__ import annotations

import json
import logging
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from motion import InputError
from motion.formats.files import replacing, write_text

from .beats.formation import DANCERS, formation
from .beats.script import compose
from .checks import fault
from .compose import FPS
from .library import Library
from .scene import Scene
from .sources import load_sources

logger = logging.getLogger(__name__)
TEST_SHARE = 0.08
TRIES = 30


@dataclass(frozen=True)
class Kind:
    """A kind of composed scene.

    Attributes:
        make: makes one scene with its label and captions.
        needs: source actions without which it cannot be made.
        weight: its share of the corpus relative to the other kinds.
    """

    make: Callable[[np.random.Generator, Library], Scene]
    needs: tuple[str, ...]
    weight: float


KINDS = {
    "beats": Kind(compose, ("walk", "walk-back", "idle", "wave", "bow"), 65.0),
    "formation": Kind(formation, DANCERS, 1.0),
}


@dataclass
class Tally:
    """Counts of a build: frames by kind, and rejected scenes by kind and reason."""

    frames: Counter[str] = field(default_factory=Counter)
    scenes: Counter[str] = field(default_factory=Counter)
    rejected: Counter[tuple[str, str]] = field(default_factory=Counter)

    def lines(self) -> list[str]:
        """One line a family."""
        lines = [
            f"{name}: {self.scenes[name]} scenes, {self.frames[name] / FPS / 60:.1f} min"
            for name in sorted(self.frames)
        ]
        return lines + [f"rejected {count}: {name}: {why}" for (name, why), count in self.rejected.most_common()]


def draw(rng: np.random.Generator, library: Library, kinds: dict[str, Kind], frames: int, tally: Tally) -> list[Scene]:
    """Checked scenes of ``frames`` frames in all, spread over the kinds by their weights.

    A kind whose scenes fail :data:`TRIES` times in a row is left out from then on, with a warning.
    """
    left = {name: kind for name, kind in kinds.items() if library.has(*kind.needs)}
    own: Counter[str] = Counter()
    failures: Counter[str] = Counter()
    scenes: list[Scene] = []
    while left and sum(own.values()) < frames:
        name = min(left, key=lambda key: own[key] / left[key].weight)
        try:
            scene = left[name].make(rng, library)
            why = fault(scene)
        except LookupError as error:
            why = str(error)
        if why:
            tally.rejected[name, why] += 1
            failures[name] += 1
            if failures[name] >= TRIES:
                logger.warning("%s is left out of the %s split: %s", name, library.split, why)
                del left[name]
            continue
        failures[name] = 0
        own[name] += scene.positions.shape[1]
        tally.frames[name] += scene.positions.shape[1]
        tally.scenes[name] += 1
        scenes.append(scene)
    return scenes


def build(
    data_dir: str | Path, *, hours: float = 5.0, seed: int = 0, recorded: bool = True, cache: Path | None = None
) -> tuple[list[Scene], Tally]:
    """All scenes of a corpus.

    Args:
        data_dir: the unpacked or packed data sets; see :func:`training.corpus.sources.load_sources`.
        hours: composed motion, of which 8 % is the test split.
        seed: the same seed, data and code give the same corpus.
        recorded: whether the recorded pairs and the real duets join where their data are there.
        cache: where the skeletons fitted to the recorded pairs are kept from one build to the next.

    Raises:
        InputError: where the data are not there.
    """
    if not 0 < hours <= 200:
        raise InputError(f"{hours} hours cannot be built: give a number above 0 and up to 200.")
    clips = load_sources(data_dir)
    tally, scenes = Tally(), []
    for number, (split, share) in enumerate((("train", 1 - TEST_SHARE), ("test", TEST_SHARE))):
        rng = np.random.default_rng([seed, number])
        frames = int(hours * share * 3600 * FPS)
        scenes += draw(rng, Library(clips, split), KINDS, frames, tally)
    if recorded:
        scenes += _recorded(data_dir, tally, cache)
    return scenes, tally


def _recorded(data_dir: str | Path, tally: Tally, cache: Path | None) -> list[Scene]:
    """The recorded pairs, without the benchmark's test sets, and the real duets."""
    from .duets import load_duets
    from .pairs import load_pairs

    left_out: Counter[str] = Counter()
    kept = load_duets(data_dir, left_out)
    try:
        kept += [scene for scene in load_pairs(data_dir, cache) if scene.split != "benchmark"]
    except InputError as error:
        logger.warning("No recorded pairs: %s", error)
    for scene in kept:
        tally.frames[f"recorded {scene.family}"] += scene.positions.shape[1]
        tally.scenes[f"recorded {scene.family}"] += 1
    for why, count in left_out.items():
        tally.rejected["real duets", why] += count
    return kept


def save(scenes: Sequence[Scene], folder: Path) -> None:
    """Writes ``motions.npy`` (frames, 2, 22, 3) float32 metres and ``index.json``, each whole or not at all.

    Float16 would round positions 4 to 8 m from the origin to 4 mm, which shows as jitter.
    """
    if not scenes:
        raise InputError("There is no scene to write: ask for more hours.")
    index, start = [], 0
    for scene in scenes:
        frames = int(scene.positions.shape[1])
        if scene.label is None and not scene.captions:
            raise ValueError(f"a scene of {scene.family} was not described")
        index.append(
            {
                "start": start,
                "frames": frames,
                "family": scene.family,
                "captions": scene.captions,
                "sources": list(scene.sources),
                "split": scene.split,
                "events": scene.events,
                "alone": list(scene.alone),
                "beats": scene.beats,
                "label": scene.label.row() if scene.label else None,
            }
        )
        start += frames
    with replacing(folder / "motions.npy") as temporary, temporary.open("wb") as file:
        header = {"descr": "<f4", "fortran_order": False, "shape": (start, 2, 22, 3)}
        np.lib.format.write_array_header_1_0(file, header)
        for scene in scenes:
            file.write(np.ascontiguousarray(scene.positions.swapaxes(0, 1), dtype="<f4").tobytes())
    write_text(folder / "index.json", json.dumps(index, default=_plain))


def _plain(value: object) -> object:
    if isinstance(value, np.generic):
        return value.item()
    raise TypeError(f"{type(value).__name__} cannot be written to the index.")
