"""Ablations of the predictors: ``python -m training.evaluate.prediction_ablation --data DIR …``.

Tables 2.6 and 2.7 of Chopin's thesis for PredictiveMA-WGAN on CMU MoCap. Every row is a run of its own, with
the same steps, batch and seed at the lean settings of :mod:`training.trainers.mawgan`. A row that is trained already
is not trained again, so that the command can be stopped and goes on.
"""

from __future__ import annotations

import argparse
from functools import lru_cache
from pathlib import Path
from typing import Any

from training.core.shell import add_options, exit_code
from training.corpus import cmu
from training.evaluate.prediction import ZERO, Table, evaluate, put_into
from training.evaluate.prediction_scores import average
from training.trainers.mawgan import LEAN, Settings, Trainer
from training.trainers.prediction.windows import Windows, open_windows

_WITHOUT = {"skeleton": 0.0, "bone": 0.0, "position": 0.0}
ROWS: dict[str, tuple[str, dict[str, Any]]] = {
    "a-r": ("La + Lr", _WITHOUT),
    "a-r-s": ("La + Lr + Ls", _WITHOUT | {"skeleton": 10.0}),
    "a-r-b": ("La + Lr + Lb", _WITHOUT | {"bone": 10.0}),
    "a-r-s-b": ("La + Lr + Ls + Lb, the thesis' loss", {"position": 0.0}),
    "lean": ("and the distance of joints", {}),
    "r-s-b": ("the same without La", {"adversarial": 0.0}),
    "no-length": ("the same, as long as the past", {"length": False}),
    "no-linear": ("the same, convolutions alone", {"linear": False}),
    "past-15": ("15 frames of past", {"past": 15}),
    "past-10": ("10 frames of past", {"past": 10}),
    "past-5": ("5 frames of past", {"past": 5}),
}
"""By folder: what the row is called, and what it changes of the lean settings."""
LOSSES = ("a-r", "a-r-s", "a-r-b", "a-r-s-b", "lean", "r-s-b", "no-length", "no-linear")
_NO_LIMIT = 1e9
PASTS = ("past-5", "past-10", "past-15", "lean")


@lru_cache
def _windows(data: Path, past: int, future: int) -> Windows:
    """The training windows, which are read once for all rows of one length."""
    return open_windows(Settings.windows, data, past, future)


def trained(data: Path, out: Path, row: str, steps: int) -> Path:
    """The folder of a row's predictor, which is trained where it is missing."""
    folder = out / row / "predictor"
    if not (folder / "config.json").exists():
        settings = Settings(**{**LEAN, **ROWS[row][1], "steps": steps})
        run = Trainer(_windows(data, settings.past, settings.future), settings, out / row)
        run.run_logged(minutes=_NO_LIMIT)
        run.export(folder)
    return folder


def markdown(found: dict[str, Table], steps: int) -> str:
    """Both tables, as mean errors in millimetres over the papers' actions.

    Args:
        found: by row, what :func:`training.evaluate.prediction.evaluate` gives.
        steps: of each run.
    """
    head = " | ".join(f"{h}" for h in cmu.HORIZONS)
    rule = "|---|" + "---:|" * len(cmu.HORIZONS)
    lines = [f"| losses ({steps} steps each) | {head} |", rule]
    lines += [_line("zero velocity", next(iter(found.values()))[ZERO])]
    lines += [_line(ROWS[row][0], _own(found[row])) for row in LOSSES if row in found]
    if not any(row in found for row in PASTS):
        return "\n".join(lines) + "\n"
    lines += ["", f"| past ({steps} steps each) | {head} |", rule]
    for row in PASTS:
        if row in found:
            name = ROWS[row][0] if row != "lean" else f"{Settings.past} frames of past"
            lines.append(_line(name, _own(found[row])))
    return "\n".join(lines) + "\n"


def _own(table: Table) -> Any:
    """The scores by action of the one predictor of a table."""
    (name,) = (name for name in table if name != ZERO)
    return table[name]


def _line(name: str, scores: Any) -> str:
    mean = average([score for action, score in scores.items() if action in cmu.ACTIONS])
    return f"| {name} | " + " | ".join(f"{mean.error[h - 1]:.1f}" for h in cmu.HORIZONS) + " |"


def main(argv: list[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    parser = argparse.ArgumentParser(description="Train and score variants of PredictiveMA-WGAN.")
    add_options(parser, "cmu")
    parser.add_argument("--out", type=Path, required=True, help="folder of the runs")
    parser.add_argument("--steps", type=int, default=1500, help="of each run")
    parser.add_argument("--only", nargs="+", choices=list(ROWS), default=list(ROWS), help="these rows")
    parser.add_argument("--table", type=Path, help="Markdown page that the tables are put into")
    options = parser.parse_args(argv)

    def job() -> None:
        found = {
            row: evaluate(options.data, [trained(options.data, options.out, row, options.steps)])
            for row in options.only
        }
        tables = markdown(found, options.steps)
        if options.table:
            put_into(options.table, tables, name="ablation")
        print(tables)

    return exit_code(job)


if __name__ == "__main__":
    raise SystemExit(main())
