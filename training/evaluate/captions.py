"""InterGen's measures (section 5) on captions of the test split: ``python -m training.evaluate --scenes FILE …``.

R-precision, FID, MM distance, diversity and multimodality with intervals, in the features of
:mod:`training.evaluate.extractor`. One repeat draws a new caption for every test scene, a new motion for it and new
pools. Beside the generated motion stand the recorded motions of the same captions, whose FID is that of as many
recorded training scenes to the test scenes.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import torch

from models.motion_tokens import decode
from motion import FPS, Duet, InputError
from motion.metrics.generation import (
    diversity,
    frechet_distance,
    interval,
    multimodal_distance,
    multimodality,
    r_precision,
)
from motion.vectors import Array
from training.core.shell import add_options, exit_code, write_scores
from training.core.text_features import encoded
from training.evaluate.extractor import Extractor, load_extractor
from training.prepare import Scenes, load
from webdemo.inference import Engine, GenerateRequest, Result

Task = tuple[str, int]
"""A caption, and frames at 30 fps."""
Draw = Callable[[Sequence[Task], int], list[Duet]]
"""(tasks, seed) → a duet of each task, see :func:`draw`."""

POOL = 32
MEASURES = ("R-precision top 1", "top 2", "top 3", "FID", "MM distance", "diversity", "multimodality")


def draw(engine: Engine, tasks: Sequence[Task], seed: int, **sampling: Any) -> list[Duet]:
    """A duet of each task with the seed ``seed`` + its place, by the network alone: captions are not split or planned.

    Lengths are to the next whole second.
    """
    duets = []
    for i, (caption, frames) in enumerate(tasks):
        seconds = float(np.clip(round(frames / 30), 1, 10))
        request = GenerateRequest(
            prompt=caption, seconds=seconds, seed=seed + i, split=False, planned=False, **sampling
        )
        duets += next(event.duets for event in engine.run(request) if isinstance(event, Result))
    return duets


def real_duet(scenes: Scenes, row: dict[str, Any]) -> Duet:
    """The recorded scene, decoded from its control points: as smooth as what a network can give."""
    with torch.no_grad():
        positions = decode(scenes.scene(row), scenes.layout)[0].numpy()
    return Duet.from_positions(positions, fps=FPS)


class Features:
    """Features of duets and captions by an extractor."""

    def __init__(self, extractor: Extractor) -> None:
        self.extractor = extractor

    def motion(self, duets: Sequence[Duet]) -> Array:
        """(N, D) float64."""
        rows = [self.extractor.of_positions(torch.from_numpy(duet.positions)) for duet in duets]
        return torch.stack(rows).double().numpy()

    def text(self, captions: Sequence[str]) -> Array:
        """(N, D) float64."""
        features = torch.empty(len(captions), self.extractor.settings.features)
        for places, tokens in encoded(captions):
            features[places] = self.extractor.text(tokens).detach().float()
        return features.double().numpy()


def measure(
    scenes: Scenes,
    extractor: Extractor,
    draw: Draw,
    *,
    prompts: int = 256,
    repeats: int = 3,
    samples: int = 6,
    many: int = 8,
    seed: int = 0,
) -> dict[str, dict[str, list[float]]]:
    """Every measure of real and of generated motion.

    Args:
        prompts: test scenes in a repeat, at most.
        repeats: of all measures; the real motion is measured 20 times, which costs nothing.
        samples, many: motions of each of ``many`` captions, for multimodality.

    Returns:
        {"real" | "generated": {measure: [mean, half the 95 % interval]}}

    Raises:
        InputError: if there are fewer test scenes than a pool of retrieval holds.
    """
    features, rng = Features(extractor), np.random.default_rng(seed)
    rows = scenes.split("test")
    rows = [rows[i] for i in rng.permutation(len(rows))[:prompts]]
    if len(rows) < POOL:
        raise InputError(f"{len(rows)} test scenes are fewer than the {POOL} that retrieval needs: build more hours.")
    real = features.motion([real_duet(scenes, row) for row in rows])
    train = scenes.split("train")
    others = [train[i] for i in rng.permutation(len(train))[: len(rows)]]
    other = features.motion([real_duet(scenes, row) for row in others])

    measured = {kind: {name: [] for name in MEASURES} for kind in ("real", "generated")}

    def add(kind: str, motion: Array, text: Array, **more: float) -> None:
        precision = zip(MEASURES, r_precision(motion, text, rng=rng, pool=POOL), strict=False)
        distances = {"MM distance": multimodal_distance(motion, text), "diversity": diversity(motion, rng=rng)}
        for name, value in (dict(precision) | distances | more).items():
            measured[kind][name].append(value)

    for repeat in range(max(repeats, 20)):
        tasks = [_task(scenes, row, rng) for row in rows]
        text = features.text([caption for caption, _ in tasks])
        add("real", real, text, FID=frechet_distance(other, real))
        if repeat < repeats:
            made = features.motion(draw(tasks, seed + 1000 * repeat))
            several = [task for task in tasks[:many] for _ in range(samples)]
            spread = features.motion(draw(several, seed + 1000 * repeat + 500)).reshape(many, samples, -1)
            add("generated", made, text, FID=frechet_distance(made, real), multimodality=multimodality(spread))
    return {
        kind: {name: [round(v, 4) for v in interval(values)] for name, values in own.items() if values}
        for kind, own in measured.items()
    }


def _task(scenes: Scenes, row: dict[str, Any], rng: np.random.Generator) -> Task:
    caption = row["captions"][int(rng.integers(len(row["captions"])))]
    return caption, scenes.layout.num_frames(row["tokens"])


def table(values: dict[str, dict[str, list[float]]]) -> str:
    """The measures as Markdown."""
    lines = ["| Measure (95 % interval) | Generated | Real motion |", "|---|---|---|"]
    for name in MEASURES:
        lines.append(f"| {name} | {_cell(values['generated'][name])} | {_cell(values['real'].get(name))} |")
    return "\n".join(lines) + "\n"


def _cell(value: list[float] | None) -> str:
    if value is None:
        return "–"
    return f"{value[0]:.3f} ± {value[1]:.3f}" if value[1] else f"{value[0]:.3f}"


def main(argv: list[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    parser = argparse.ArgumentParser(
        prog="python -m training.evaluate", description="Measure a generator on captions of the test split."
    )
    add_options(parser, "scenes", "out", "table", "seed", "steps", "guidance", "damping", "weights")
    parser.add_argument("--extractor", type=Path, required=True, help="of training.evaluate.extractor")
    parser.add_argument("--repeats", type=int, default=3, help="of all measures (3)")
    parser.add_argument("--prompts", type=int, default=256, help="test scenes in a repeat, at most (256)")
    options = parser.parse_args(argv)

    def job() -> None:
        scenes, extractor = load(options.scenes), load_extractor(options.extractor)
        engine = Engine(options.weights)
        sampling = {name: getattr(options, name) for name in ("steps", "guidance", "damping")}

        def drawn(tasks: Sequence[Task], seed: int) -> list[Duet]:
            print(f"{len(tasks)} captions, seed {seed}", file=sys.stderr, flush=True)
            return draw(engine, tasks, seed, **sampling)

        sizes = {name: getattr(options, name) for name in ("prompts", "repeats", "seed")}
        values = measure(scenes, extractor, drawn, **sizes)
        write_scores(options, values, table(values))

    return exit_code(job)


if __name__ == "__main__":
    raise SystemExit(main())
