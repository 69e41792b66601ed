"""The papers' tables that compare trainings: ``python -m training.evaluate.paper_tables TABLE --data DIR --out DIR``.

Each table trains small networks on the listed training clips of SBU and K3HI, both at once, lets them answer the test
clips and judges that by a classifier of recorded clips (:mod:`training.evaluate.deep_gru`). ``--out`` keeps every
training and what it made, so a command that was stopped goes on where it was.

Sizes and steps are far below the papers', and the data are others: only the order of the rows can be compared.
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from motion import InputError
from motion.formats.files import replacing, write_text
from training.core.shell import add_options, exit_code
from training.corpus.strict_pairs import StrictPair, strict_pairs
from training.evaluate.reactions import interval

from .bigraphdiff import BiGraphDiffTable
from .interformer import InterFormerTable
from .regennet import ReGenNetTable
from .table import Row, Table, scores

Array = NDArray[np.floating]

TABLES: dict[str, Table] = {
    table.name: table for table in (InterFormerTable(), BiGraphDiffTable(), ReGenNetTable())
}
SCORES = {
    "accuracy": ("accuracy %", 100.0),
    "fvd": ("FVD", 1.0),
    "diversity": ("diversity %, 0 is best", 1.0),
}


def made_by(
    table: Table, row: Row, pairs: Sequence[StrictPair], out: Path, *, steps: int, seed: int
) -> tuple[list[Array], float]:
    """Clips that a row's network makes for the test clips, and milliseconds a frame; both are read if they are there.

    Trains the network first, or the rest of it.
    """
    name = next(key for key, value in table.rows.items() if value is row)
    folder = out / f"{row.run}-{seed}"
    path = folder / f"{name}.npz"
    if not path.is_file():
        trainer = table.trainer(pairs, row.run, folder, steps=steps, seed=seed)
        if trainer.step < steps:
            trainer.run_logged(minutes=1e9, every=100)
        tests = [pair for pair in pairs if pair.test]
        began = time.process_time()
        clips = table.make(trainer, row, tests, seed=seed)
        took = 1000 * (time.process_time() - began) / sum(pair.positions.shape[1] for pair in tests)
        if not all(np.isfinite(clip).all() for clip in clips):
            raise InputError(f"What {row.label} makes after {steps} steps diverges: train longer, --steps.")
        arrays = {f"clip{place}": clip.astype(np.float32) for place, clip in enumerate(clips)}
        with replacing(path) as temporary, open(temporary, "wb") as file:
            np.savez_compressed(file, steps=steps, milliseconds=took, **arrays)
    with np.load(path, allow_pickle=False) as kept:
        if int(kept["steps"]) != steps:
            raise InputError(f"{path} was made after {kept['steps']} steps: give another --out, or those.")
        count = sum(key.startswith("clip") for key in kept)
        return [kept[f"clip{place}"] for place in range(count)], float(kept["milliseconds"])


def markdown(
    table: Table, found: Mapping[str, Mapping[str, Mapping[str, Sequence[float]]]], times: Mapping[str, float]
) -> str:
    """The table: mean ± half a 95 % interval over trainings and classifiers; the paper's figures stand apart."""
    heads = [f"{data}: {head}" for data in found for head, _ in SCORES.values()]
    lines = [
        f"| {' | '.join(['Row', *heads, 'ms a frame', *(f'paper: {head}' for head in table.heads)])} |",
        "|---" + "|---:" * (len(heads) + 1 + len(table.heads)) + "|",
    ]
    for name, row in {"recorded": Row("recorded", ""), **table.rows}.items():
        cells = []
        for rows in found.values():
            for key, (_, factor) in SCORES.items():
                mean, half = interval(factor * np.array(rows[name][key])) if name in rows else (np.nan, 0)
                cells.append("–" if np.isnan(mean) else f"{mean:.1f} ± {half:.1f}")
        if all(cell == "–" for cell in cells):
            continue
        cells.append(f"{times[name]:.2f}" if name in times else "–")
        cells += [row.paper.get(head, "–") for head in table.heads]
        lines.append(f"| {row.label} | {' | '.join(cells)} |")
    return "\n".join(lines) + "\n"


def main(argv: list[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    parser = argparse.ArgumentParser(prog="python -m training.evaluate.paper_tables", description=__doc__)
    parser.add_argument("table", choices=TABLES)
    add_options(parser, "pairs", "cache")
    parser.add_argument("--out", type=Path, required=True, help="folder of the trainings and scores")
    parser.add_argument("--rows", nargs="+", help="names of rows (all)")
    parser.add_argument("--steps", type=int, help="of each training (by table)")
    parser.add_argument("--seeds", type=int, default=2, help="trainings of each network")
    parser.add_argument("--classifiers", type=int, default=2, help="each with a seed of its own")
    options = parser.parse_args(argv)
    return exit_code(lambda: _run(options))


def _run(options: argparse.Namespace) -> None:
    table = TABLES[options.table]
    wanted = options.rows or list(table.rows)
    if unknown := sorted(set(wanted) - set(table.rows)):
        raise InputError(f"{table.name} has no row {unknown[0]!r}: its rows are {', '.join(table.rows)}.")
    pairs = strict_pairs(options.data, options.cache)
    steps, out = options.steps or table.steps, options.out / table.name
    made: dict[str, list[list[Array]]] = {}
    times: dict[str, float] = {}
    for seed in range(options.seeds):
        for name in wanted:
            clips, took = made_by(table, table.rows[name], pairs, out, steps=steps, seed=seed)
            made.setdefault(name, []).append(clips)
            times[name] = min(times.get(name, np.inf), took)
            print(f"{name}, seed {seed}: made", flush=True)
    found = scores(table, pairs, made, classifiers=options.classifiers, say=print)
    shown: dict[str, Any] = {"steps": steps, "seeds": options.seeds, "scores": found, "milliseconds": times}
    write_text(out / "scores.json", json.dumps(shown, indent=1) + "\n")
    page = (
        f"{table.title}. {table.about} Steps: {steps}; trainings of each network: {options.seeds}; "
        f"classifiers: {options.classifiers}.\n\n{markdown(table, found, times)}"
    )
    write_text(out / "table.md", page)
    print(page)
