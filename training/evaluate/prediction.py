"""Scores the page's predictions: ``python -m training.evaluate.prediction --data CORPUS``.

Whole predictions as the page makes them (frame of reference, bones, seam, feet, recursion), on windows of the
corpus' test split, root and all in the world.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from motion import FPS
from motion.cleaning import foot_contacts
from motion.formats.files import write_text
from motion.skeleton import FEET
from motion.vectors import Array
from training.core.shell import add_options, exit_code
from training.trainers.prediction import Windows
from webdemo.inference.pipelines.predictor import PredictorPipeline
from webdemo.inference.requests.predict import mean_steps

Predict = Callable[[Array], Array]
"""(N, past, J, 3) metres → (N, future, J, 3)."""

PAST, FUTURE = 30, 120
TRUTH = "what really followed"
AHEAD = (2, 5, 10, 15, 30, 60, 90, 120)
"""Predicted frames that are scored."""


@dataclass(frozen=True)
class Scores:
    """Of one method on windows.

    Attributes:
        windows: how many.
        error: (future,) mean distance of joints from the truth at each predicted frame, in millimetres.
        speed: (future,) mean distance per joint and frame (MPJS, eq. 2.13), in millimetres.
        true_speed: the same of the truth.
        seam: share of windows whose first predicted step is at most the largest step of the past.
        glide: mean speed of standing feet over the floor, in centimetres a second.
    """

    windows: int
    error: Array
    speed: Array
    true_speed: Array
    seam: float
    glide: float


def score(predict: Predict, windows: Array) -> Scores:
    """Scores a method on windows (N, PAST + FUTURE, 22, 3) in metres."""
    seen, truth = windows[:, :PAST], windows[:, PAST:]
    made = predict(seen)
    steps = mean_steps(np.concatenate([seen[:, -1:], made], axis=1))
    return Scores(
        len(windows),
        error=1000 * np.linalg.norm(made - truth, axis=-1).mean(-1).mean(0),
        speed=1000 * steps.mean(0),
        true_speed=1000 * mean_steps(windows[:, PAST - 1 :]).mean(0),
        seam=float(np.mean(steps[:, 0] <= mean_steps(seen).max(axis=1) + 1e-6)),
        glide=float(np.mean([glide(motion) for motion in made])),
    )


def glide(positions: Array) -> float:
    """Mean speed over the floor of feet that stand, in centimetres a second; 0 if none does.

    Args:
        positions: (T, 22, 3) metres.
    """
    stands = foot_contacts(positions, FPS)
    moves = np.linalg.norm(np.diff(positions[:, list(FEET)][..., [0, 2]], axis=0), axis=-1)
    both = stands[1:] & stands[:-1]
    return float(100 * FPS * moves[both].mean()) if both.any() else 0.0


def markdown(results: dict[str, Scores]) -> str:
    """The scores by method as a table."""
    speeds = {name: scores.speed / scores.true_speed for name, scores in results.items()}
    methods = [name for name in results if name != TRUTH]
    head = " | ".join(f"{frame / FPS:.2g} s" for frame in AHEAD)
    lines = [f"| {results[TRUTH].windows} windows | {head} |", "|---|" + "---:|" * len(AHEAD)]
    for name in methods:
        lines.append(f"| {name}, mm | {' | '.join(f'{results[name].error[f - 1]:.0f}' for f in AHEAD)} |")
    for name in methods:
        if speeds[name].any():
            ratios = " | ".join(f"{speeds[name][f - 1]:.2f}" for f in AHEAD)
            lines.append(f"| {name}, speed over the truth's | {ratios} |")
    lines += ["", f"|  | {' | '.join(results)} |", "|---|" + "---:|" * len(results)]
    for label, values in (
        ("slowest and fastest step over the truth's", [f"{s.min():.2f} to {s.max():.2f}" for s in speeds.values()]),
        ("first step within the past's largest", [f"{scores.seam:.1%}" for scores in results.values()]),
        ("standing feet glide, cm/s", [f"{scores.glide:.1f}" for scores in results.values()]),
    ):
        lines.append(f"| {label} | {' | '.join(values)} |")
    return "\n".join(lines) + "\n"


def main(argv: list[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    parser = argparse.ArgumentParser(description="Score the page's predictions on the corpus' test split.")
    add_options(parser, "corpus", "weights", "table")
    parser.add_argument("--model", action="append", help="name of a model; motion-mlp by default")
    parser.add_argument("--windows", type=int, default=200, help="how many are drawn")
    options = parser.parse_args(argv)

    def job() -> None:
        source = Windows(options.data, PAST, FUTURE, split="test")
        windows = source.draw(options.windows, np.random.default_rng(0)).astype(np.float64)
        truth = windows[:, PAST:]
        scores = {TRUTH: score(lambda _: truth, windows)}
        for name in ("still", *(options.model or ["motion-mlp"])):
            predictor = PredictorPipeline(None if name == "still" else options.weights / name)
            scores[name] = score(lambda past, own=predictor: own.predict(past, FUTURE), windows)
        table = markdown(scores)
        if options.table:
            write_text(options.table, table)
        print(table)

    return exit_code(job)


if __name__ == "__main__":
    raise SystemExit(main())
