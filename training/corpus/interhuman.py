"""InterHuman as a corpus: ``python -m training.corpus.interhuman --data DIR --out DIR``.

The data set (Liang et al. 2024) is not part of this project; whoever has it can train on it. Expected are
``motions_processed/person1/N.npy`` and ``person2/N.npy`` (frames, 492), ``annots/N.txt`` with a sentence a line, and
lists of N in ``split/train.txt``, ``split/val.txt`` and ``split/test.txt``. What this writes is what
``python -m training.prepare`` reads, and after that every trainer.
"""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np

from motion import InputError
from motion.formats import ImportChoices, read_pair
from motion.kinematics import project_to_skeleton
from motion.transforms import canonicalize, resample
from training.core.shell import exit_code

from .build import save
from .scene import Scene

FPS = 30.0
"""The processed files are taken as 30 frames a second, as their authors' loader does; the raw ones have 59.94."""
SHORTEST = 30
SPLITS = {"train.txt": "train", "val.txt": "validation", "test.txt": "test"}
_MOST_SENTENCES = 20


def read_interhuman(data: Path, *, fps: float = FPS) -> Iterator[Scene]:
    """Every motion with a sentence, on SMPL22's own bones; what cannot be read is reported and left out.

    Args:
        data: the data set's folder.
        fps: frames a second of its files.

    Raises:
        InputError: if the folder holds no motions of two people.
    """
    motions = data / "motions_processed" if (data / "motions_processed").is_dir() else data
    first, second = motions / "person1", motions / "person2"
    names = sorted((path.stem for path in first.glob("*.npy")), key=_number)
    if not names:
        raise InputError(f"{data} holds no motions_processed/person1/*.npy: give InterHuman's folder.")
    splits = _splits(data)
    for name in names:
        sentences = _sentences(data / "annots" / f"{name}.txt")
        try:
            duet = read_pair(first / f"{name}.npy", second / f"{name}.npy", choices=ImportChoices(fps=fps))
        except InputError as error:
            print(f"left out: {error}", file=sys.stderr)
            continue
        people = np.stack([
            project_to_skeleton(resample(person.astype(np.float64), fps, FPS))[0] for person in duet.positions
        ])  # fmt: skip
        if sentences and people.shape[1] >= SHORTEST:
            split = splits.get(name, "train")
            source = (f"interhuman/{name}",)
            yield Scene(canonicalize(people), "interhuman", source, split, captions=sentences)


def _number(name: str) -> tuple[int, str]:
    digits = re.match(r"\d+", name)
    return (int(digits[0]) if digits else sys.maxsize, name)


def _splits(data: Path) -> Mapping[str, str]:
    """The split of each motion that a list names."""
    found: dict[str, str] = {}
    for folder in (data, data / "split"):
        for file, split in SPLITS.items():
            if (folder / file).is_file():
                found |= dict.fromkeys((folder / file).read_text(encoding="utf-8").split(), split)
    return found


def _sentences(path: Path) -> list[str]:
    """The sentences of a motion; none where it has no file."""
    if not path.is_file():
        return []
    lines = (line.strip() for line in path.read_text(encoding="utf-8", errors="replace").splitlines())
    return [line for line in lines if line][:_MOST_SENTENCES]


def main(argv: list[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    parser = argparse.ArgumentParser(prog="python -m training.corpus.interhuman", description=__doc__)
    parser.add_argument("--data", type=Path, required=True, help="InterHuman's folder")
    parser.add_argument("--out", type=Path, required=True, help="folder of the corpus")
    parser.add_argument("--fps", type=float, default=FPS, help="frames a second of the files (30)")
    options = parser.parse_args(argv)

    def job() -> None:
        scenes = list(read_interhuman(options.data, fps=options.fps))
        options.out.mkdir(parents=True, exist_ok=True)
        save(scenes, options.out)
        seconds = sum(scene.positions.shape[1] for scene in scenes) / FPS
        print(f"{len(scenes)} motions, {seconds / 3600:.2f} hours")

    return exit_code(job)


if __name__ == "__main__":
    raise SystemExit(main())
