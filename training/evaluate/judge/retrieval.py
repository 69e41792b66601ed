"""InterGen's measures (section 5): R-precision, FID, MM distance, diversity and multimodality with intervals.

One repeat draws a new sentence for every test scene, a new motion for it and new pools. Beside the
generated motion stand the recorded motions of the same sentences, whose FID is that of as many recorded
training scenes to the test scenes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray

from models.text import MiniLM
from motion import Duet, InputError
from motion.metrics.generation import (
    diversity,
    frechet_distance,
    interval,
    multimodal_distance,
    multimodality,
    r_precision,
)
from training.evaluate.extractor import Extractor
from training.prepare import Scenes

from .prompts import real_duet
from .rules import Task

Array = NDArray[np.floating]
Draw = Callable[[Sequence[Task], int], Iterator[tuple[int, Duet]]]
"""(tasks, seed) → (index of the task, its duet), see :func:`training.evaluate.judge.draw.draw`."""

POOL = 32
MEASURES = ("R-precision top 1", "top 2", "top 3", "FID", "MM distance", "diversity", "multimodality")


class Features:
    """Features of duets and sentences by an extractor."""

    def __init__(self, extractor: Extractor) -> None:
        self.extractor, self.encoder = extractor, MiniLM()

    def motion(self, duets: Sequence[Duet]) -> Array:
        """(N, D) float64."""
        rows = [self.extractor.of_positions(torch.from_numpy(duet.positions)) for duet in duets]
        return torch.stack(rows).double().numpy()

    def text(self, captions: Sequence[str]) -> Array:
        """(N, D) float64."""
        with torch.no_grad():
            parts = [
                self.extractor.text(self.encoder(captions[i : i + 64])) for i in range(0, len(captions), 64)
            ]
        return torch.cat(parts).double().numpy()


def measure(
    scenes: Scenes,
    extractor: Extractor,
    draw: Draw | None,
    *,
    prompts: int = 256,
    repeats: int = 3,
    samples: int = 6,
    many: int = 8,
    seed: int = 0,
) -> dict[str, dict[str, list[float]]]:
    """Every measure of real and, with ``draw``, of generated motion.

    Args:
        prompts: test scenes in a repeat, at most.
        repeats: of all measures; the real motion is measured 20 times, which costs nothing.
        samples, many: motions of each of ``many`` sentences, for multimodality.

    Returns:
        {"real" | "generated": {measure: [mean, half the 95 % interval]}}

    Raises:
        InputError: if there are fewer test scenes than a pool of retrieval holds.
    """
    features, rng = Features(extractor), np.random.default_rng(seed)
    rows = scenes.split("test")
    rows = [rows[i] for i in rng.permutation(len(rows))[:prompts]]
    if len(rows) < POOL:
        raise InputError(f"{len(rows)} test scenes are fewer than the {POOL} of retrieval: build more hours.")
    real = features.motion([real_duet(scenes, row) for row in rows])
    train = scenes.split("train")
    others = [train[i] for i in rng.permutation(len(train))[: len(rows)]]
    other = features.motion([real_duet(scenes, row) for row in others])

    found: dict[str, list[list[float]]] = {"real": [], "generated": []}
    for repeat in range(max(repeats, 20)):
        tasks = [_task(scenes, row, rng) for row in rows]
        text = features.text([task.caption for task in tasks])
        found["real"].append([*_scores(real, text, rng), frechet_distance(other, real), np.nan])
        if draw is None or repeat >= repeats:
            continue
        drawn = dict(draw(tasks, seed + 1000 * repeat))
        made = features.motion([drawn[i] for i in range(len(tasks))])
        several = [task for task in tasks[:many] for _ in range(samples)]
        again = dict(draw(several, seed + 1000 * repeat + 500))
        spread = features.motion([again[i] for i in range(len(several))]).reshape(many, samples, -1)
        found["generated"].append(
            [*_scores(made, text, rng), frechet_distance(made, real), multimodality(spread)]
        )
    result: dict[str, dict[str, list[float]]] = {}
    for kind, lines in found.items():
        if lines:
            r1, r2, r3, mm, spread, fid, multi = zip(*lines, strict=True)
            columns = (r1, r2, r3, fid, mm, spread, multi)
            result[kind] = {
                name: [round(v, 4) for v in interval(column)]
                for name, column in zip(MEASURES, columns, strict=True)
                if not np.isnan(column[0])
            }
    return result


def _task(scenes: Scenes, row: dict[str, Any], rng: np.random.Generator) -> Task:
    caption = row["captions"][int(rng.integers(len(row["captions"])))]
    return Task(caption, row["family"], row["events"] or {}, scenes.layout.num_frames(row["tokens"]))


def _scores(motion: Array, text: Array, rng: np.random.Generator) -> list[float]:
    return [
        *r_precision(motion, text, rng=rng, pool=POOL),
        multimodal_distance(motion, text),
        diversity(motion, rng=rng),
    ]


def table(found: dict[str, dict[str, list[float]]]) -> str:
    """The measures as Markdown."""
    made = found.get("generated")
    lines = ["| Measure (95 % interval) | Generated | Real motion |", "|---|---|---|"]
    for name in MEASURES:
        cells = [_cell(kind.get(name)) if kind else "–" for kind in (made, found["real"])]
        lines.append(f"| {name} | {cells[0]} | {cells[1]} |")
    return "\n".join(lines) + "\n"


def _cell(value: list[float] | None) -> str:
    if value is None:
        return "–"
    return f"{value[0]:.3f} ± {value[1]:.3f}" if value[1] else f"{value[0]:.3f}"
