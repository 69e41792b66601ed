"""Predictions of what dancers do next: ``python -m training.evaluate.dancers --takes DIR``.

Parts of recorded takes of two dancers (a folder of ``NAME_a.bvh`` and ``NAME_b.bvh``, such as the salsa takes of CMU
MoCap): a second is given, and every method of prediction continues it by two. Parts whose past no method takes, since a
joint jumps there, are left out. Of the salsa takes, corpora hold out 05 and 14 (``--only 05 14``); a network that was
trained on such a corpus has seen the others.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from motion import FPS, Duet, InputError, stacked_positions
from training.core.shell import exit_code
from training.evaluate.long_reactions import takes
from webdemo.inference import Engine, PredictRequest, methods

Array = NDArray[np.floating]

PAST = 30
"""Frames that are given."""
HORIZONS = (6, 15, 30, 60)
"""Predicted frames after which the joints are compared."""
BETWEEN = 180
"""Frames from the beginning of a part of a take to that of the next."""


def errors(engine: Engine, takes: Sequence[Array]) -> dict[str, Array]:
    """Errors (N, :data:`HORIZONS`) in millimetres on parts of recorded takes, by method; of several futures also
    the nearest's.

    Args:
        engine: runs the methods.
        takes: (2, T, 22, 3) metres at 30 fps each.
    """
    whole = PAST + max(HORIZONS)
    parts = [take[:, i : i + whole] for take in takes for i in range(0, take.shape[1] - whole + 1, BETWEEN)]
    found: dict[str, list[Array]] = {}
    for part in parts:
        try:
            asked = PredictRequest(
                motion=Duet.from_positions(part, fps=FPS), marker=PAST / FPS, seconds=max(HORIZONS) / FPS
            )
        except InputError:
            continue
        for model in methods.methods("predict"):
            *_, result = engine.run(replace(asked, model=model.name))
            made = np.stack([stacked_positions(duet)[:, PAST:] for duet in result.duets])
            off = 1000 * np.linalg.norm(made - part[:, PAST:], axis=-1).mean(axis=(1, 3))
            at = off[:, [h - 1 for h in HORIZONS]]
            found.setdefault(model.label, []).append(at.mean(0))
            if len(off) > 1:
                nearest = f"{model.label}, the nearest of {len(off)}"
                found.setdefault(nearest, []).append(at[off.mean(1).argmin()])
    return {name: np.array(rows) for name, rows in found.items()}


def table(found: dict[str, Array]) -> str:
    """The mean :func:`errors` as Markdown."""
    count = len(next(iter(found.values())))
    heads = " | ".join(f"{h / FPS:g} s" for h in HORIZONS)
    lines = [f"| {count} parts, mm | {heads} |", "|---|" + "---:|" * len(HORIZONS)]
    lines += [f"| {name} | {' | '.join(f'{m:.0f}' for m in rows.mean(0))} |" for name, rows in found.items()]
    return "\n".join(lines)


def main(argv: list[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    parser = argparse.ArgumentParser(prog="python -m training.evaluate.dancers", description=__doc__)
    parser.add_argument("--takes", type=Path, required=True, help="folder of NAME_a.bvh and NAME_b.bvh")
    parser.add_argument("--only", nargs="+", default=(), metavar="NAME", help="only these takes")
    options = parser.parse_args(argv)
    return exit_code(lambda: print(table(errors(Engine(), takes(options.takes, options.only)))))


if __name__ == "__main__":
    raise SystemExit(main())
