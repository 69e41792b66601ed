"""The table of prediction: ``python -m training.evaluate.prediction --data DIR --table docs/prediction.md``.

CMU MoCap as the papers cut it (:mod:`training.corpus.cmu`), on *every* window of the test clips: zero velocity, and
each folder of a trained predictor that is named with ``--predictor``.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch

from models.predictors import Predictor, load_predictor
from motion import InputError
from motion.formats.files import write_text
from training.core.shell import add_options, exit_code
from training.corpus import cmu
from training.corpus.cmu import Array
from webdemo.inference.requests.predict import mean_steps

Predict = Callable[[Array], Array]
"""(N, past, J, 3) metres → (N, future, J, 3)."""
ZERO = "zero velocity"


@dataclass(frozen=True)
class Scores:
    """Of one method on the windows of one action.

    Attributes:
        windows: how many.
        error: (future,) mean distance of joints from the truth at each predicted frame, in millimetres, as the
            papers' tables have it.
        rms: (future,) the thesis' eq. 2.12: root mean square of the distances over joints and all frames so
            far, in millimetres.
        speed: (future,) mean distance per joint and frame (MPJS, eq. 2.13), in millimetres.
        true_speed: the same of the truth.
        seam: share of windows whose first predicted step is at most the largest step of the past.
    """

    windows: int
    error: Array
    rms: Array
    speed: Array
    true_speed: Array
    seam: float


def score(predict: Predict, windows: Array, past: int, *, batch: int = 512) -> Scores:
    """Scores a method on windows (N, past + future, J, 3) in metres."""
    errors, squares, speeds, true_speeds, seams = [], [], [], [], []
    for start in range(0, len(windows), batch):
        part = windows[start : start + batch]
        seen, truth = part[:, :past], part[:, past:]
        made = predict(seen)
        distances = np.linalg.norm(made - truth, axis=-1)
        errors.append(distances.mean(-1))
        so_far = np.arange(1, distances.shape[1] + 1)
        squares.append(np.sqrt(np.square(distances).mean(-1).cumsum(-1) / so_far))
        speeds.append(mean_steps(np.concatenate([seen[:, -1:], made], axis=1)))
        true_speeds.append(mean_steps(part[:, past - 1 :]))
        seams.append(speeds[-1][:, 0] <= mean_steps(seen).max(axis=1) + 1e-6)
    means = (1000 * np.concatenate(x).mean(0) for x in (errors, squares, speeds, true_speeds))
    return Scores(len(windows), *means, float(np.concatenate(seams).mean()))


def zero_velocity(future: int) -> Predict:
    """The last pose, held (Martinez et al.; thesis, section 2.5.3)."""
    return lambda past: np.repeat(past[:, -1:], future, axis=1)


def average(scores: list[Scores]) -> Scores:
    """The mean over actions, each with the same weight, as in the papers' tables."""
    return Scores(
        sum(s.windows for s in scores),
        *(np.mean([getattr(s, name) for s in scores], axis=0) for name in ("error", "rms", "speed", "true_speed")),
        float(np.mean([s.seam for s in scores])),
    )


Table = dict[str, dict[str, Scores]]
"""Scores by method, then by action."""


def of_predictor(predictor: Predictor) -> Predict:
    """A predictor as a function of arrays; beyond its own length it goes on recursively."""

    def predict(past: Array) -> Array:
        tensor = torch.from_numpy(np.ascontiguousarray(past, dtype=np.float32))
        return predictor.recursive(tensor, cmu.FUTURE).numpy()

    return predict


def evaluate(data: Path, predictors: list[Path]) -> Table:
    """Scores of zero velocity and every predictor on all test windows.

    Raises:
        InputError: if data or weights are missing, or a predictor is for another skeleton.
    """
    methods = {ZERO: zero_velocity(cmu.FUTURE)}
    for folder in predictors:
        predictor = load_predictor(folder)
        if predictor.joints != 17 or predictor.past > cmu.PAST:
            raise InputError(
                f"{folder.name} takes {predictor.past} frames of {predictor.joints} joints: name a predictor "
                f"of CMU's 17 joints and at most {cmu.PAST} frames."
            )
        methods[folder.name] = of_predictor(predictor)
    found: Table = {name: {} for name in methods}
    for action, clips in cmu.read_actions(data, "test").items():
        windows = cmu.windows(clips)
        for name, predict in methods.items():
            found[name][action] = score(predict, windows, cmu.PAST)
    return found


def markdown(found: Table) -> str:
    """The scores as a page of tables."""
    actions = list(found[ZERO])
    benchmark = [action for action in actions if action in cmu.ACTIONS]
    means = {name: average([scores[a] for a in benchmark]) for name, scores in found.items()}
    head = " | ".join(f"{h}" for h in cmu.HORIZONS)
    lines = [f"| action (windows) | method | {head} |", "|---|---|" + "---:|" * len(cmu.HORIZONS)]
    for action in actions:
        for i, (name, scores) in enumerate(found.items()):
            label = f"{action} ({scores[action].windows})" if i == 0 else ""
            lines.append(f"| {label} | {name} | {_errors(scores[action].error)} |")
    for i, (name, mean) in enumerate(means.items()):
        label = f"**average of {len(benchmark)}** ({mean.windows})" if i == 0 else ""
        lines.append(f"| {label} | {name} | {_errors(mean.error)} |")
    for i, (name, mean) in enumerate(means.items()):
        label = "**the same by eq. 2.12**" if i == 0 else ""
        lines.append(f"| {label} | {name} | {_errors(mean.rms)} |")
    lines += ["", f"| on average | {' | '.join(found)} |", "|---|" + "---:|" * len(found)]
    zero = means[ZERO]
    for h in (10, 25):
        ratios = [f"{m.error[h - 1] / zero.error[h - 1]:.2f}" for m in means.values()]
        lines.append(f"| error at {h} frames over that of zero velocity | {' | '.join(ratios)} |")
        ratios = [f"{m.rms[h - 1] / zero.rms[h - 1]:.2f}" for m in means.values()]
        lines.append(f"| the same by eq. 2.12 | {' | '.join(ratios)} |")
    share = [m.speed / m.true_speed for m in means.values()]
    for label, place in (("first", 0), ("10th", 9), ("25th", 24)):
        values = " | ".join(f"{s[place]:.2f}" for s in share)
        lines.append(f"| speed over the truth's, {label} step | {values} |")
    ranges = " | ".join(f"{s.min():.2f} to {s.max():.2f}" for s in share)
    lines.append(f"| the same, slowest and fastest of all steps | {ranges} |")
    seams = " | ".join(f"{m.seam:.1%}" for m in means.values())
    lines.append(f"| windows whose first step is within the past's largest | {seams} |")
    return "\n".join(lines) + "\n"


def _errors(errors: Array) -> str:
    return " | ".join(f"{errors[h - 1]:.1f}" for h in cmu.HORIZONS)


def put_into(page: Path, table: str, *, name: str = "table") -> None:
    """Writes a table between its marks in a page; creates the page if it does not exist.

    Args:
        page: of Markdown.
        table: its Markdown.
        name: of the marks, ``<!-- name -->`` and ``<!-- end of name -->``.
    """
    begin, end = f"<!-- {name} -->\n", f"<!-- end of {name} -->\n"
    text = page.read_text() if page.exists() else begin + end
    before, mark, rest = text.partition(begin)
    _, found, after = rest.partition(end)
    if not (mark and found):
        raise InputError(f"{page} lacks the lines {begin.strip()} and {end.strip()}: add them.")
    write_text(page, before + begin + "\n" + table + "\n" + end + after)


def main(argv: list[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    parser = argparse.ArgumentParser(description="Score predictors on CMU MoCap.")
    add_options(parser, "cmu")
    parser.add_argument("--predictor", type=Path, action="append", default=[], help="a predictor's folder")
    parser.add_argument("--table", type=Path, help="Markdown page that the table is put into")
    options = parser.parse_args(argv)

    def job() -> None:
        table = markdown(evaluate(options.data, options.predictor))
        if options.table:
            put_into(options.table, table)
        print(table)

    return exit_code(job)


if __name__ == "__main__":
    raise SystemExit(main())
