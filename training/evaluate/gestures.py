"""``python -m training.evaluate.gestures --corpus DIR``: scores the agent's recogniser, gesture by gesture."""

from __future__ import annotations

import argparse
import json
from collections.abc import Mapping
from pathlib import Path

from models.agent.recogniser import load_folder
from motion.formats.files import write_text
from training.core.shell import add_options, exit_code
from training.trainers.recogniser import Settings, answered, cut, scores
from webdemo.inference.engine import WEIGHTS
from webdemo.inference.pipelines.agent import Eye
from webdemo.inference.pipelines.predictor import PredictorPipeline


def table(by_gesture: Mapping[str, float], windows: Mapping[str, int]) -> str:
    """The shares of single looks that are named correctly as a Markdown table, the worst gesture first."""
    rows = [
        f"| {name} | {100 * share:.0f} % | {windows[name]} |"
        for name, share in sorted(by_gesture.items(), key=lambda item: item[1])
    ]
    return "\n".join(["| Gesture | Named correctly | Looks |", "|---|---|---|", *rows])


def main(argv: list[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    parser = argparse.ArgumentParser(description="Score the virtual agent's recogniser on the test split.")
    add_options(parser, "corpus")
    parser.add_argument("--weights", type=Path, default=WEIGHTS / "agent", help="the recogniser's folder")
    parser.add_argument("--predictor", type=Path, default=WEIGHTS / "motion-mlp", help="a predictor's folder")
    parser.add_argument("--windows", type=int, default=8, help="looks at each scene (8)")
    parser.add_argument(
        "--answered", type=int, default=300, help="test scenes on which the agent decides (300)"
    )
    parser.add_argument("--out", type=Path, help="JSON file for all figures")
    options = parser.parse_args(argv)
    return exit_code(lambda: _run(options))


def _run(options: argparse.Namespace) -> None:
    model, _ = load_folder(options.weights)
    predictor = PredictorPipeline(options.predictor)
    windows, labels = cut(options.corpus, Settings(windows=options.windows), "test", predictor)
    found = scores(model, windows, labels)
    decided = answered(options.corpus, Eye(options.weights, predictor), options.answered)
    counts = {name: int((labels == i).sum()) for i, name in enumerate(model.config.labels)}
    print(table(found["by gesture"], counts))
    single = {name: found[name] for name in ("windows", "named", "among three", "balanced")}
    print(json.dumps({"single looks": single, "all looks": decided}))
    if options.out:
        write_text(options.out, json.dumps(found | {"looks": counts, "all looks": decided}))


if __name__ == "__main__":
    raise SystemExit(main())
