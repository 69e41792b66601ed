"""InterHuman or Inter-X as a corpus: ``python -m training.corpus.annotated --data DIR --out DIR``.

Neither is part of this project; whoever has one can train on it. What this writes is what
``python -m training.prepare`` reads, and after that every trainer. Expected are

- of InterHuman (Liang et al. 2024) ``motions_processed/person1/N.npy`` and ``person2/N.npy`` (frames, 492) and
  ``annots/N.txt`` with a sentence a line;
- of Inter-X (Xu et al. 2024) ``motions/NAME/P1.npz`` and ``P2.npz``, SMPL-X parameters, and ``texts/NAME.txt``.
  ``interaction_order.pkl``, which says who acts, is a pickle and is not opened: ``--second-acts`` names a text file
  with the names of the motions in which P2 does.

Lists of names in ``split/train.txt``, ``val.txt`` and ``test.txt`` (or beside the motions) give the splits.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Collection, Iterator
from pathlib import Path

import numpy as np

from motion import InputError
from motion.formats import ImportChoices, read_pair
from motion.kinematics import project_to_skeleton
from motion.transforms import canonicalize, resample
from training.core.shell import exit_code

from .build import save
from .cues import Scene

FPS = 30.0
"""The processed files are taken as 30 frames a second, as their authors' loader does; the raw ones have 59.94."""
SHORTEST = 30
SPLITS = {"train.txt": "train", "val.txt": "validation", "test.txt": "test"}
_MOST_SENTENCES = 20


def motions_in(data: Path) -> Iterator[tuple[str, tuple[Path, Path], Path]]:
    """Each motion of a data set's folder: its source, such as "interhuman/7", the files of P1 and P2, and that of its
    sentences.

    Raises:
        InputError: if the folder holds no motions of two people.
    """
    human = data / "motions_processed" if (data / "motions_processed").is_dir() else data
    first = sorted((human / "person1").glob("*.npy")) or sorted((data / "motions").glob("*/P1.npz"))
    if not first:
        raise InputError(
            f"{data} holds neither motions_processed/person1/*.npy nor motions/*/P1.npz: give the folder of "
            "InterHuman or of Inter-X."
        )
    for path in first:
        if path.suffix == ".npy":
            yield f"interhuman/{path.stem}", (path, human / "person2" / path.name), data / "annots" / f"{path.stem}.txt"
        else:
            name = path.parent.name
            yield f"interx/{name}", (path, path.with_name("P2.npz")), data / "texts" / f"{name}.txt"


def read_annotated(data: Path, second_acts: Collection[str] = ()) -> Iterator[Scene]:
    """Every motion with a sentence, on SMPL22's own bones; what cannot be read is reported and left out.

    Args:
        data: the data set's folder.
        second_acts: names of the motions whose second person acts.
    """
    splits = _splits(data)
    for source, files, text in motions_in(data):
        name = source.partition("/")[2]
        try:
            choices = ImportChoices(fps=FPS if files[0].suffix == ".npy" else None)
            duet = read_pair(*(files[::-1] if name in second_acts else files), choices=choices)
        except InputError as error:
            print(f"left out: {name}: {error}", file=sys.stderr)
            continue
        people = np.stack(
            [project_to_skeleton(resample(person.astype(np.float64), duet.fps, FPS))[0] for person in duet.positions]
        )
        lines = text.read_text(encoding="utf-8", errors="replace").splitlines() if text.is_file() else []
        sentences = [line.strip() for line in lines if line.strip()][:_MOST_SENTENCES]
        if sentences and people.shape[1] >= SHORTEST:
            yield Scene(canonicalize(people), "annotated", (source,), splits.get(name, "train"), captions=sentences)


def _splits(data: Path) -> dict[str, str]:
    """The split of each motion that a list names."""
    found: dict[str, str] = {}
    for folder in (data, data / "split", data / "splits"):
        for file, split in SPLITS.items():
            if (folder / file).is_file():
                found |= dict.fromkeys((folder / file).read_text(encoding="utf-8").split(), split)
    return found


def main(argv: list[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    parser = argparse.ArgumentParser(prog="python -m training.corpus.annotated", description=__doc__)
    parser.add_argument("--data", type=Path, required=True, help="folder of InterHuman or Inter-X")
    parser.add_argument("--out", type=Path, required=True, help="folder of the corpus")
    parser.add_argument("--second-acts", type=Path, help="text file of the motions in which the second person acts")
    options = parser.parse_args(argv)

    def job() -> None:
        names = options.second_acts.read_text(encoding="utf-8").split() if options.second_acts else ()
        scenes = list(read_annotated(options.data, set(names)))
        options.out.mkdir(parents=True, exist_ok=True)
        save(scenes, options.out)
        seconds = sum(scene.positions.shape[1] for scene in scenes) / FPS
        print(f"{len(scenes)} motions, {seconds / 3600:.2f} hours")

    return exit_code(job)


if __name__ == "__main__":
    raise SystemExit(main())
