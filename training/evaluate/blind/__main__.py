"""Blind comparison by people: ``python -m training.evaluate.blind``.

``make`` draws sheets of pairs, one motion of each model for the same sentence and seed, above each other as 1 and 2 in
an order drawn by chance; ``recorded`` draws the lab's motions beside recorded duets of the same act; ``choose`` writes
down which one is better, before any name is known; ``reveal`` opens the key once every pair has been chosen.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from training.core.shell import exit_code

from .pairs import KEY, choose, make, reveal, save_result, verdict


def main(argv: list[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    options = _parser().parse_args(argv)

    def job() -> None:
        if options.step == "make":
            made = make(options.old, options.new, options.out, count=options.count, seed=options.seed)
            print(f"{made} pairs in {options.out}; choose before you open {KEY}.")
        elif options.step == "recorded":
            from .recorded import make_recorded

            made = make_recorded(options.data, options.out, count=options.count, seed=options.seed)
            print(f"{made} pairs in {options.out}; choose before you open {KEY}.")
        elif options.step == "choose":
            print(f"{choose(options.folder, options.picks)} pairs have no choice yet.")
        else:
            found = reveal(options.folder)
            save_result(options.folder, found)
            print(verdict(found))

    return exit_code(job)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m training.evaluate.blind", description=__doc__)
    steps = parser.add_subparsers(dest="step", required=True)
    making = steps.add_parser("make", help="draw the sheets of two models")
    making.add_argument("--old", type=Path, required=True, help="motions of the one model")
    making.add_argument("--new", type=Path, required=True, help="motions of the other")
    beside = steps.add_parser("recorded", help="draw the sheets of recorded duets and the lab's motions")
    beside.add_argument("--data", type=Path, required=True, help="folder of the recordings")
    for step, count in ((making, 60), (beside, 40)):
        step.add_argument("--out", type=Path, required=True, help="folder for the sheets")
        step.add_argument("--count", type=int, default=count, help=f"pairs ({count})")
        step.add_argument("--seed", type=int, default=0)
    choosing = steps.add_parser("choose", help="write choices down")
    choosing.add_argument("folder", type=Path)
    choosing.add_argument("picks", nargs="+", help="such as 7=1 8=2 9=tie")
    revealing = steps.add_parser("reveal", help="open the key and count")
    revealing.add_argument("folder", type=Path)
    return parser


if __name__ == "__main__":
    sys.exit(main())
