"""Builds the corpus: ``python -m training.corpus --data DIR --out DIR``.

Composes scenes of beats, adds the recorded duets, checks each scene and writes them.
"""

from __future__ import annotations

import argparse
import json
import logging
from collections import Counter, defaultdict
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from motion import FPS, InputError
from motion.formats.files import replacing, write_text
from training.core.shell import add_options, exit_code

from .beats.script import compose
from .checks import fault
from .cues import Scene
from .duets import load_duets
from .library import Library
from .pairs import load_pairs, scenes_of
from .sources import TEST_SHARE, load_sources

logger = logging.getLogger(__name__)
NEEDS = ("walk", "walk-back", "idle", "wave", "bow")
"""Source actions without which no scene is composed."""
TRIES = 30
"""Scenes in a row that may be turned away before no more are composed."""


def draw(rng: np.random.Generator, library: Library, frames: int, rejected: Counter[str]) -> list[Scene]:
    """Checked scenes of beats of ``frames`` frames in all; fewer, with a warning, where none passes any more.

    Args:
        rejected: counts the scenes that are turned away, by reason.
    """
    scenes: list[Scene] = []
    made = failures = 0
    while library.has(*NEEDS) and made < frames and failures < TRIES:
        try:
            scene = compose(rng, library)
            why = fault(scene)
        except LookupError as error:
            why = str(error)
        if why:
            rejected[f"beats: {why}"] += 1
            failures += 1
            if failures == TRIES:
                logger.warning("No more scenes for the %s split: %s", library.split, why)
            continue
        failures = 0
        made += scene.positions.shape[1]
        scenes.append(scene)
    return scenes


def build(
    data_dir: str | Path, *, hours: float = 5.0, seed: int = 0, cache: Path | None = None
) -> tuple[list[Scene], Counter[str]]:
    """All scenes of a corpus, and how many were turned away for each reason.

    Recorded pairs and real duets join where their data are there, without the published test lists.

    Args:
        data_dir: the unpacked or packed data sets; see :func:`training.corpus.sources.load_sources`.
        hours: composed motion, of which 8 % is the test split.
        seed: the same seed, data and code give the same corpus.
        cache: where the skeletons fitted to the recorded pairs are kept from one build to the next.

    Raises:
        InputError: where the data are not there.
    """
    if not 0 < hours <= 200:
        raise InputError(f"{hours} hours cannot be built: give a number above 0 and up to 200.")
    clips = load_sources(data_dir)
    scenes, rejected = [], Counter[str]()
    for number, (split, share) in enumerate((("train", 1 - TEST_SHARE), ("test", TEST_SHARE))):
        rng = np.random.default_rng([seed, number])
        scenes += draw(rng, Library(clips, split), int(hours * share * 3600 * FPS), rejected)
    duets = [(scene, fault(scene)) for scene in load_duets(data_dir)]
    rejected.update(f"salsa: {why}" for _, why in duets if why)
    scenes += [scene for scene, why in duets if not why]
    try:
        scenes += scenes_of(load_pairs(data_dir, cache), rejected)
    except InputError as error:
        logger.warning("No recorded pairs: %s", error)
    return scenes, rejected


def counted(scenes: Sequence[Scene], rejected: Counter[str]) -> list[str]:
    """One line for each family of scenes, and one for each reason."""
    frames: dict[str, list[int]] = defaultdict(list)
    for scene in scenes:
        frames[scene.family].append(scene.positions.shape[1])
    made = [f"{name}: {len(own)} scenes, {sum(own) / FPS / 60:.1f} min" for name, own in sorted(frames.items())]
    return made + [f"rejected {count}: {why}" for why, count in rejected.most_common()]


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
        row = {
            name: getattr(scene, name)
            for name in ("family", "captions", "sources", "split", "events", "alone", "beats")
        }
        label = scene.label.row() if scene.label else None
        index.append(row | {"start": start, "frames": frames, "label": label})
        start += frames
    with replacing(folder / "motions.npy") as temporary, temporary.open("wb") as file:
        header = {"descr": "<f4", "fortran_order": False, "shape": (start, 2, 22, 3)}
        np.lib.format.write_array_header_1_0(file, header)
        for scene in scenes:
            file.write(np.ascontiguousarray(scene.positions.swapaxes(0, 1), dtype="<f4").tobytes())
    write_text(folder / "index.json", json.dumps(index, default=np.generic.item))


def main(arguments: list[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    parser = argparse.ArgumentParser(prog="python -m training.corpus", description=__doc__)
    parser.add_argument("--data", type=Path, required=True, help="folder with the motion data sets")
    parser.add_argument("--out", type=Path, required=True, help="folder for motions.npy and index.json")
    parser.add_argument("--hours", type=float, default=5.0, help="hours of composed motion (5)")
    add_options(parser, "seed", "cache")
    options = parser.parse_args(arguments)
    logging.basicConfig(level=logging.WARNING, format="%(message)s")

    def job() -> None:
        scenes, rejected = build(options.data, hours=options.hours, seed=options.seed, cache=options.cache)
        save(scenes, options.out)
        print(*counted(scenes, rejected), f"{len(scenes)} scenes -> {options.out}", sep="\n")

    return exit_code(job)
