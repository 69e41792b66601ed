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

from motion import InputError
from motion.transforms import heading, heading_matrix
from motion.vectors import Array
from training.core.shell import exit_code


def poses(positions: Array) -> Array:
    """Positions (2, T, 22, 3) about each pelvis, seen from the way that each faces."""
    turned = heading_matrix(-heading(positions))
    return np.einsum("...ij,...kj->...ki", turned, positions - positions[..., :1, :])


def apart(first: Array, second: Array) -> float:
    """Mean distance in centimetres of the joints of two motions (2, T, 22, 3) of poses, over what they both last."""
    frames = min(first.shape[1], second.shape[1])
    return 100 * float(np.linalg.norm(first[:, :frames] - second[:, :frames], axis=-1).mean())


def listening(motions: Sequence[Sequence[Array]]) -> tuple[float, float]:
    """Medians in centimetres over pairs of seeds of one sentence, and over pairs of sentences of one seed.

    Args:
        motions: positions (2, T, 22, 3) of each sentence and seed.

    Raises:
        InputError: if there are no such pairs.
    """
    held = [[poses(motion) for motion in each] for each in motions]
    seeds = [apart(*pair) for each in held for pair in itertools.combinations(each, 2)]
    sentences = [
        apart(first, second)
        for one, other in itertools.combinations(held, 2)
        for first, second in zip(one, other, strict=False)
    ]
    if not seeds or not sentences:
        raise InputError("There are no two seeds of two sentences: score with --seeds 2.")
    return float(np.median(seeds)), float(np.median(sentences))


def main(argv: list[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    parser = argparse.ArgumentParser(prog="python -m training.evaluate.listening", description=__doc__)
    parser.add_argument("motions", type=Path, help="a folder of NAME-SEED.npy")
    options = parser.parse_args(argv)

    def job() -> None:
        files = sorted(options.motions.rglob("*.npy"))
        if len({path.parent for path in files}) > 1:
            raise InputError(f"{options.motions} holds motions of several settings: name one of its folders.")
        kept: dict[str, list[Array]] = defaultdict(list)
        for path in files:
            kept[path.stem.rpartition("-")[0]].append(np.load(path, allow_pickle=False).astype(np.float64))
        seeds, sentences = listening(list(kept.values()))
        print(
            f"Poses of two seeds of a sentence are {seeds:.1f} cm apart, of two sentences of a seed {sentences:.1f} cm."
        )

    return exit_code(job)


if __name__ == "__main__":
    raise SystemExit(main())
