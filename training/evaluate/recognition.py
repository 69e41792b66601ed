"""The thesis' Table 5.2 on recorded actors: ``python -m training.evaluate.recognition --data DIR --out FILE``.

How well the virtual agent's recogniser names a gesture when it has seen three seconds of it, one, or one and two that
a predictor adds (Chopin, section 5.5.3). For each input a recogniser of its own is trained, as in the thesis, on the
training lists of SBU and K3HI and judged on their test lists. Both predictors of the page are tried.
"""

from __future__ import annotations

import argparse
import json
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from models.agent.recogniser import OBSERVED, PREDICTED, sampled
from motion.formats.files import write_text
from motion.transforms import mirrored
from training.core.shell import add_options, exit_code
from training.corpus.sbu import CLASSES as SBU_CLASSES
from training.corpus.strict_pairs import StrictPair, strict_pairs
from training.evaluate.reactions import DATASETS, interval
from training.trainers.recogniser import GESTURES, Settings, Trainer
from webdemo.inference.pipelines.predict_frame import to_last_pose
from webdemo.inference.pipelines.predictor import PredictorPipeline

Array = NDArray[np.floating]
Complete = Callable[[Array], Array]
"""(N, 90, 22, 3) recorded seconds → the three seconds that the recogniser sees."""

LATEST = 12
"""Frames after a clip's start at which a training window may begin; a test window begins with its clip."""
PAPER = {"3 s recorded": 63.6, "1 s recorded": 47.7, "1 s recorded, 2 s predicted": 60.2}
"""Percent in the thesis' Table 5.2: its own six gestures and idle, one Kinect, 264 test clips."""


def known(people: Array) -> Array:
    """The first second, its last pose held."""
    return np.concatenate(
        [people[:, :OBSERVED], np.repeat(people[:, OBSERVED - 1 : OBSERVED], PREDICTED, 1)], 1
    )


def predicted(predictor: PredictorPipeline) -> Complete:
    """The first second and two that a predictor makes of it."""

    def complete(people: Array) -> Array:
        first = people[:, :OBSERVED]
        return np.concatenate([first, predictor.predict(first, PREDICTED)], axis=1)

    return complete


def inputs(weights: Path) -> dict[str, Complete]:
    """The rows of the table."""
    found: dict[str, Complete] = {"3 s recorded": lambda people: people, "1 s recorded": known}
    for name in ("motion-mlp", "mawgan"):
        found[f"1 s recorded, 2 s predicted by {name}"] = predicted(PredictorPipeline(weights / name))
    return found


def gesture_of(pair: StrictPair) -> int:
    """The place of a clip's gesture in :data:`~training.trainers.recogniser.GESTURES`."""
    family = SBU_CLASSES[pair.name.split("/")[1]] if pair.dataset == "sbu" else pair.label
    return next(place for place, (_, families) in enumerate(GESTURES.values()) if family in families)


def windows(pairs: Sequence[StrictPair], starts: Sequence[int]) -> Array:
    """(N, 90, 22, 3) of the actors from each start on, the last pose held where a clip ends."""
    moments = np.arange(OBSERVED + PREDICTED)
    return np.stack([
        pair.positions[0][np.minimum(start + moments, pair.positions.shape[1] - 1)]
        for pair, start in zip(pairs, starts, strict=True)
    ]).astype(np.float64)  # fmt: skip


def as_seen(people: Array, complete: Complete) -> Tensor:
    """(N, 30, 22, 3) in the frame of the last observed pose."""
    local = to_last_pose(complete(people), OBSERVED - 1)[0]
    return sampled(torch.from_numpy(np.ascontiguousarray(local)).float())


def data_of(pairs: Sequence[StrictPair], complete: Complete, *, seed: int) -> tuple[Tensor, Tensor]:
    """Training windows, three a clip, and their mirror images, with their gestures."""
    rng = np.random.default_rng(seed)
    many = [pair for pair in pairs for _ in range(3)]
    people = windows(many, [int(rng.integers(0, LATEST)) for _ in many])
    labels = torch.tensor([gesture_of(pair) for pair in many])
    both = torch.cat([as_seen(people, complete), as_seen(mirrored(people), complete)])
    return both, labels.repeat(2)


def score(
    train: Sequence[StrictPair], test: Sequence[StrictPair], complete: Complete, *, seeds: int, steps: int
) -> dict[str, list[float]]:
    """Shares of the test clips of each data set, and of both, whose gesture is named; one value a seed."""
    found: dict[str, list[float]] = {}
    labels = torch.tensor([gesture_of(pair) for pair in test])
    seen = as_seen(windows(test, [0] * len(test)), complete)
    for seed in range(seeds):
        settings = Settings(batch=48, steps=steps, warmup=20, seed=seed)
        with tempfile.TemporaryDirectory() as folder:
            trainer = Trainer(data_of(train, complete, seed=seed), settings, Path(folder))
            for _ in range(steps):
                trainer.train_step()
        with torch.no_grad():
            right = (trainer.ema(seen).argmax(1) == labels).numpy()
        for key, name in {**DATASETS, "": "both"}.items():
            rows = [place for place, pair in enumerate(test) if not key or pair.dataset == key]
            found.setdefault(name, []).append(float(right[rows].mean()))
    return found


def table(scores: dict[str, dict[str, list[float]]], counts: dict[str, int]) -> str:
    """Markdown: percent ± half a 95 % interval over the seeds."""
    heads = " | ".join(f"{name}, {count} clips" for name, count in counts.items())
    lines = [f"| Seen | {heads} | the thesis, on its own clips |", "|---|" + "---:|" * (len(counts) + 1)]
    for name, values in scores.items():
        cells = []
        for data in counts:
            mean, half = interval(100 * np.array(values[data]))
            cells.append(f"{mean:.1f} ± {half:.1f}")
        paper = PAPER[name.partition(" by ")[0]]
        lines.append(f"| {name} | {' | '.join(cells)} | {paper} |")
    return "\n".join(lines) + "\n"


def main(argv: list[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    parser = argparse.ArgumentParser(prog="python -m training.evaluate.recognition", description=__doc__)
    add_options(parser, "pairs", "cache", "weights", "out")
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--steps", type=int, default=300, help="of each recogniser")
    options = parser.parse_args(argv)

    def job() -> None:
        pairs = strict_pairs(options.data, options.cache)
        train, test = ([pair for pair in pairs if pair.test is wanted] for wanted in (False, True))
        counts = {name: sum(pair.dataset == key for pair in test) for key, name in DATASETS.items()}
        counts["both"] = len(test)
        scores: dict[str, dict[str, list[float]]] = {}
        for name, complete in inputs(options.weights).items():
            scores[name] = score(train, test, complete, seeds=options.seeds, steps=options.steps)
            print(name, scores[name], flush=True)
            write_text(options.out, json.dumps(scores, indent=1))
        print(table(scores, counts))

    return exit_code(job)


if __name__ == "__main__":
    raise SystemExit(main())
