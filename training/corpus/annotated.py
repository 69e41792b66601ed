"""InterHuman, Inter-X or HumanML3D as a corpus: ``python -m training.corpus.annotated --data DIR --out DIR``.

None is part of this project; whoever has one can train on it. What this writes is what
``python -m training.prepare`` reads, and after that every trainer. Expected are

- of InterHuman (Liang et al. 2024) ``motions_processed/person1/N.npy`` and ``person2/N.npy`` (frames, 492) and
  ``annots/N.txt`` with a sentence a line;
- of Inter-X (Xu et al. 2024) ``motions/NAME/P1.npz`` and ``P2.npz``, SMPL-X parameters, and ``texts/NAME.txt``.
  ``interaction_order.pkl``, which says who acts, is a pickle and is not opened: ``--second-acts`` names a text file
  with the names of the motions in which P2 does;
- of HumanML3D (Guo et al. 2022), which is AMASS with sentences, ``new_joint_vecs/NAME.npy`` (frames, 263) and
  ``texts/NAME.txt``. Its single people are shown two by two, each doing what their own sentence says.

Lists of names in ``split/train.txt``, ``val.txt`` and ``test.txt`` (or beside the motions) give the splits.
"""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Collection, Iterator
from pathlib import Path

import numpy as np

from motion import FPS, InputError
from motion.formats import ImportChoices, read_pair
from motion.kinematics import project_to_skeleton
from motion.metrics.sentences import kept_out
from motion.transforms import canonicalize, resample, turn
from motion.vectors import direction, floor_points
from training.core.shell import exit_code

from .build import save
from .cues import Scene

SHORTEST = 30
SPLITS = {"train.txt": "train", "val.txt": "validation", "test.txt": "test"}
_MOST_SENTENCES = 20


def motions_in(data: Path) -> list[tuple[str, tuple[Path, Path], Path]]:
    """Each motion of a data set's folder: its source, such as "interhuman/7", the files of P1 and P2, and that of its
    sentences.

    Raises:
        InputError: if the folder holds no motions of two people.
    """
    human = data / "motions_processed" if (data / "motions_processed").is_dir() else data
    motions = [
        (f"interhuman/{path.stem}", (path, human / "person2" / path.name), data / "annots" / f"{path.stem}.txt")
        for path in sorted((human / "person1").glob("*.npy"))
    ] or [
        (f"interx/{path.name}", (path / "P1.npz", path / "P2.npz"), data / "texts" / f"{path.name}.txt")
        for path in sorted(file.parent for file in (data / "motions").glob("*/P1.npz"))
    ]
    if not motions:
        raise InputError(
            f"{data} holds no motions_processed/person1/*.npy, motions/*/P1.npz or new_joint_vecs/*.npy: give the "
            "folder of InterHuman, Inter-X or HumanML3D."
        )
    return motions


def read_annotated(data: Path, second_acts: Collection[str] = ()) -> Iterator[Scene]:
    """Every motion with a sentence, on SMPL22's own bones; what cannot be read is reported and left out.

    Args:
        data: the data set's folder.
        second_acts: names of the motions whose second person acts.
    """
    splits = _splits(data)
    for source, files, text in motions_in(data):
        name = source.partition("/")[2]
        # The processed files are taken as 30 frames a second, as their authors do; the raw ones have 59.94.
        choices = ImportChoices(fps=FPS if files[0].suffix == ".npy" else None)
        people = _people(files[::-1] if name in second_acts else files, choices)
        lines = (line.strip() for line in _lines(text))
        sentences = [line for line in lines if line and not kept_out(line)][:_MOST_SENTENCES]
        if people and sentences and len(people[0]) >= SHORTEST:
            scene = canonicalize(np.stack(people))
            yield Scene(scene, "annotated", (source,), splits.get(name, "train"), captions=sentences)


def _people(files: tuple[Path, Path], choices: ImportChoices | None = None) -> list[np.ndarray] | None:
    """Two people (T, 22, 3) on SMPL22's own bones; None, and a line that says so, where a file cannot be read."""
    try:
        duet = read_pair(*files, choices=choices)
    except InputError as error:
        print(f"left out: {files[0].stem}: {error}", file=sys.stderr)
        return None
    return [project_to_skeleton(resample(person.astype(np.float64), duet.fps, FPS))[0] for person in duet.positions]


def _lines(text: Path) -> list[str]:
    return text.read_text(encoding="utf-8", errors="replace").splitlines() if text.is_file() else []


_SOMEBODY = re.compile(r"((an?|the|this|one) )?(person|(wo)?man|figure|human|individual|guy|someone|s?he)\b", re.I)
_WHOLE = frozenset(("0.0", "nan"))
"""Beginning and end, in a file of sentences, of one that is about the whole clip."""
_APART = np.arange(1.0, 6.0, 0.25)
"""Metres between two single people at the beginning, of which the first is taken that never brings them closer than
:data:`_ROOM`."""
_ROOM = 0.8
_OPEN = 0.6
"""Radians by which two single people may face past each other at the beginning, to either side."""


def read_singles(data: Path) -> Iterator[Scene]:
    """The single people of HumanML3D two by two, each clip once as a and once as b, cut to the shorter one.

    Args:
        data: the data set's folder.
    """
    splits, dice = _splits(data), np.random.default_rng(0)
    by_split: dict[str, list[Path]] = {}
    for path in sorted((data / "new_joint_vecs").glob("*.npy")):
        by_split.setdefault(splits.get(path.stem, "train"), []).append(path)
    for split, paths in sorted(by_split.items()):
        order = dice.permutation(len(paths))
        for first, second in zip(order, np.roll(order, 1), strict=True):
            files = paths[first], paths[second]
            told = [_told(data / "texts" / f"{path.stem}.txt", name) for path, name in zip(files, "AB", strict=True)]
            people = _people(files) if all(told) else None
            if not people:
                continue
            a, b = map(canonicalize, people)
            scene = _apart(a, turn(b, np.pi + dice.uniform(-_OPEN, _OPEN)), dice.uniform(-_OPEN, _OPEN))
            if scene is not None and scene.shape[1] >= SHORTEST:
                both = [f"{one}, and {other}" for one, other in zip(*told, strict=False)]
                sources = tuple(f"humanml3d/{path.stem}" for path in files)
                yield Scene(scene, "annotated", sources, split, captions=both, alone=(told[0], told[1]))


def _told(text: Path, name: str) -> list[str]:
    """The sentences on all of a clip that begin with somebody, with the name of the person who does it here."""
    sentences = []
    for line in _lines(text):
        words, *when = line.strip().split("#")
        somebody = _SOMEBODY.match(words)
        if somebody and set(when[1:]) <= _WHOLE:
            sentences.append(f"person {name}{words[somebody.end() :].rstrip('. ')}")
    return sentences[:_MOST_SENTENCES]


def _apart(a: np.ndarray, b: np.ndarray, aside: float) -> np.ndarray | None:
    """(2, T, 22, 3): b's (T, 22, 3) moved away from a's, ``aside`` radians beside where a faces; None where they meet
    at any distance."""
    frames = min(len(a), len(b))
    for metres in _APART:
        moved = b[:frames] + metres * floor_points(direction(aside))
        gaps = np.linalg.norm((moved - a[:frames])[:, 0, [0, 2]], axis=-1)
        if gaps.min() >= _ROOM:
            return np.stack([a[:frames], moved])
    return None


def _splits(data: Path) -> dict[str, str]:
    """The split of each motion that a list names."""
    splits: dict[str, str] = {}
    for folder in (data, data / "split", data / "splits"):
        for file, split in SPLITS.items():
            if (folder / file).is_file():
                splits |= dict.fromkeys((folder / file).read_text(encoding="utf-8").split(), split)
    return splits


def main(argv: list[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    parser = argparse.ArgumentParser(prog="python -m training.corpus.annotated", description=__doc__)
    parser.add_argument("--data", type=Path, required=True, help="folder of InterHuman, Inter-X or HumanML3D")
    parser.add_argument("--out", type=Path, required=True, help="folder of the corpus")
    parser.add_argument("--second-acts", type=Path, help="text file of the motions in which the second person acts")
    options = parser.parse_args(argv)

    def job() -> None:
        names = options.second_acts.read_text(encoding="utf-8").split() if options.second_acts else ()
        single = (options.data / "new_joint_vecs").is_dir()
        scenes = list(read_singles(options.data) if single else read_annotated(options.data, set(names)))
        options.out.mkdir(parents=True, exist_ok=True)
        save(scenes, options.out)
        seconds = sum(scene.positions.shape[1] for scene in scenes) / FPS
        print(f"{len(scenes)} motions, {seconds / 3600:.2f} hours")

    return exit_code(job)


if __name__ == "__main__":
    raise SystemExit(main())
