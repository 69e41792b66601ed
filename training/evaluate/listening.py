"""A measure of whether a network listens: how far its poses move with the sentence, and how far with the seed.

A network that hardly listens gives two sentences of one seed almost the same motion, and one that is a single actor
gives two seeds of one sentence almost the same. ``python -m training.evaluate.listening MOTIONS`` measures
the motions that ``python -m webdemo score --motions MOTIONS`` kept.
"""

from __future__ import annotations

import argparse
import itertools
from collections import defaultdict
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from motion import InputError
from motion.transforms import heading, heading_matrix
from training.core.shell import exit_code

Array = NDArray[np.floating]


def poses(positions: Array) -> Array:
    """Positions (2, T, 22, 3) about each pelvis, seen from the way that each faces."""
    turned = heading_matrix(-heading(positions))
    return np.einsum("...ij,...kj->...ki", turned, positions - positions[..., :1, :])


def apart(first: Array, second: Array) -> float:
    """Mean distance in centimetres of the joints of two motions (2, T, 22, 3) of poses, over what they both last."""
    frames = min(first.shape[1], second.shape[1])
    return 100 * float(np.linalg.norm(first[:, :frames] - second[:, :frames], axis=-1).mean())


def listening(motions: Sequence[Sequence[Array]]) -> dict[str, float | None]:
    """Medians over pairs: "seeds" of one sentence and "sentences" of one seed, in centimetres; None without pairs.

    Args:
        motions: positions (2, T, 22, 3) of each sentence and seed.
    """
    held = [[poses(motion) for motion in each] for each in motions]
    seeds = [apart(*pair) for each in held for pair in itertools.combinations(each, 2)]
    sentences = [
        apart(first, second)
        for one, other in itertools.combinations(held, 2)
        for first, second in zip(one, other, strict=False)
    ]
    pairs = {"seeds": seeds, "sentences": sentences}
    return {name: float(np.median(found)) if found else None for name, found in pairs.items()}


def said(found: dict[str, float | None]) -> str:
    """The figures of :func:`listening` in a sentence, or nothing."""
    seeds, sentences = found["seeds"], found["sentences"]
    if not seeds or sentences is None:
        return ""
    return (
        f" Poses of two seeds of a sentence are {seeds:.1f} cm apart, of two sentences of a seed {sentences:.1f} cm, "
        f"{sentences / seeds:.1f} times as far."
    )


def main(argv: list[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    parser = argparse.ArgumentParser(prog="python -m training.evaluate.listening", description=__doc__)
    parser.add_argument("motions", type=Path, help="a folder of NAME-SEED.npy")
    options = parser.parse_args(argv)

    def job() -> None:
        kept: dict[str, list[Array]] = defaultdict(list)
        for path in sorted(options.motions.rglob("*.npy")):
            kept[path.stem.rpartition("-")[0]].append(np.load(path, allow_pickle=False).astype(np.float64))
        text = said(listening(list(kept.values())))
        if not text:
            raise InputError(f"{options.motions} holds no two seeds of two sentences: score with --seeds 2.")
        print(text.strip())

    return exit_code(job)


if __name__ == "__main__":
    raise SystemExit(main())
