"""``python -m training.corpus --data DIR --out DIR``: builds the corpus from the data folder."""

from __future__ import annotations

import argparse
import logging
from pathlib import Path

from training.core.shell import add_options, exit_code

from .build import build, counted, save


def main(arguments: list[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    parser = argparse.ArgumentParser(prog="python -m training.corpus", description=__doc__)
    parser.add_argument("--data", type=Path, required=True, help="folder with the motion data sets")
    parser.add_argument("--out", type=Path, required=True, help="folder for motions.npy and index.json")
    parser.add_argument("--hours", type=float, default=5.0, help="hours of composed motion (5)")
    add_options(parser, "seed")
    parser.add_argument("--cache", type=Path, help="folder that keeps the fitted pairs for the next build")
    options = parser.parse_args(arguments)
    logging.basicConfig(level=logging.WARNING, format="%(message)s")

    def job() -> None:
        scenes, rejected = build(options.data, hours=options.hours, seed=options.seed, cache=options.cache)
        save(scenes, options.out)
        print(*counted(scenes, rejected), f"{len(scenes)} scenes -> {options.out}", sep="\n")

    return exit_code(job)


if __name__ == "__main__":
    raise SystemExit(main())
