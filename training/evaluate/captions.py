"""InterGen's measures (section 5) on captions of the test split: ``python -m training.evaluate --scenes FILE …``.

R-precision, FID, MM distance, diversity and multimodality with intervals, in the features of
:mod:`training.evaluate.extractor`. One repeat draws a new caption for every test scene, a new motion for it and new
pools. Beside the generated motion stand the recorded motions of the same captions, whose FID is that of as many
recorded training scenes to the test scenes.
"""

from __future__ import annotations

import argparse
import sys
from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray

from models.diffusion import denoise, make_scheduler, sample_noise
from models.intergen.words import join_conditions
from models.motion_tokens import decode
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
from training.core.shell import add_options, exit_code, write_scores
from training.evaluate.extractor import Extractor, load_extractor
from training.prepare import Scenes, load
from webdemo.inference.finish.cleanup import clean_person
from webdemo.inference.finish.damping import Damping
from webdemo.inference.method import WEIGHTS
from webdemo.inference.pipelines.intergen import InterGenPipeline

Array = NDArray[np.floating]
Task = tuple[str, int]
"""A caption, and frames at 30 fps."""
Draw = Callable[[Sequence[Task], int], Iterator[tuple[int, Duet]]]
"""(tasks, seed) → (index of the task, its duet), see :func:`draw`."""

BATCH = 12
"""Captions of one length that share a network pass."""
POOL = 32
MEASURES = ("R-precision top 1", "top 2", "top 3", "FID", "MM distance", "diversity", "multimodality")


@dataclass(frozen=True, kw_only=True)
class Sampling:
    """Sampling settings; the names are those of :class:`webdemo.inference.GenerateRequest`."""

    steps: int = 25
    guidance: float = 4.3
    damping: float = 0.7


def draw(
    generator: InterGenPipeline, tasks: Sequence[Task], sampling: Sampling, seed: int
) -> Iterator[tuple[int, Duet]]:
    """(index of the task, its duet), with the seed ``seed`` + index.

    The network alone: DDIM, damping and the clean-up, without a plan. Lengths are to the next whole second.

    Raises:
        InputError: if a motion is not finite.
    """
    model = generator.model
    lengths: dict[int, list[int]] = defaultdict(list)
    for i, (_, frames) in enumerate(tasks):
        lengths[int(np.clip(30 * round(frames / 30), 30, 300))].append(i)
    for frames, places in lengths.items():
        for start in range(0, len(places), BATCH):
            group = places[start : start + BATCH]
            shape = (model.layout.num_tokens(frames), 2 * model.layout.token_features)
            noise = torch.cat([sample_noise(seed + i, 1, shape) for i in group])
            condition = join_conditions([generator.condition(tasks[i][0])[0] for i in group])
            scheduler = make_scheduler("ddim", sampling.steps, spacing="top")
            damping = Damping(
                model,
                sampling.damping,
                frames=frames,
                timesteps=scheduler.timesteps.tolist(),
                touches=model.touches(condition),
            )

            def predict(x: torch.Tensor, t: torch.Tensor, told: Any = condition) -> torch.Tensor:
                return model.denoiser.guided(x, t, told, scale=sampling.guidance)

            sample = denoise(predict, noise, scheduler, correct=damping)
            with torch.no_grad():
                positions = model.positions(sample)[0][:, :, :frames].numpy()
            if not np.isfinite(positions).all():
                raise InputError("The motion diverged: lower the guidance scale or take more steps.")
            for i, pair in zip(group, positions, strict=True):
                yield i, Duet.from_positions(np.stack([clean_person(one) for one in pair]), fps=30.0)


def real_duet(scenes: Scenes, row: dict[str, Any]) -> Duet:
    """The recorded scene, decoded from its control points: as smooth as what a network can give."""
    with torch.no_grad():
        positions = decode(scenes.scene(row), scenes.layout)[0].numpy()
    return Duet.from_positions(positions, fps=30.0)


class Features:
    """Features of duets and captions by an extractor."""

    def __init__(self, extractor: Extractor) -> None:
        self.extractor, self.encoder = extractor, MiniLM()

    def motion(self, duets: Sequence[Duet]) -> Array:
        """(N, D) float64."""
        rows = [self.extractor.of_positions(torch.from_numpy(duet.positions)) for duet in duets]
        return torch.stack(rows).double().numpy()

    def text(self, captions: Sequence[str]) -> Array:
        """(N, D) float64."""
        with torch.no_grad():
            parts = [self.extractor.text(self.encoder(captions[i : i + 64])) for i in range(0, len(captions), 64)]
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
        raise InputError(f"{len(rows)} test scenes are fewer than the {POOL} of retrieval: build more hours.")
    real = features.motion([real_duet(scenes, row) for row in rows])
    train = scenes.split("train")
    others = [train[i] for i in rng.permutation(len(train))[: len(rows)]]
    other = features.motion([real_duet(scenes, row) for row in others])

    found: dict[str, list[list[float]]] = {"real": [], "generated": []}
    for repeat in range(max(repeats, 20)):
        tasks = [_task(scenes, row, rng) for row in rows]
        text = features.text([caption for caption, _ in tasks])
        found["real"].append([*_scores(real, text, rng), frechet_distance(other, real), np.nan])
        if draw is None or repeat >= repeats:
            continue
        drawn = dict(draw(tasks, seed + 1000 * repeat))
        made = features.motion([drawn[i] for i in range(len(tasks))])
        several = [task for task in tasks[:many] for _ in range(samples)]
        again = dict(draw(several, seed + 1000 * repeat + 500))
        spread = features.motion([again[i] for i in range(len(several))]).reshape(many, samples, -1)
        found["generated"].append([*_scores(made, text, rng), frechet_distance(made, real), multimodality(spread)])
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
    return caption, scenes.layout.num_frames(row["tokens"])


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


def main(argv: list[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    parser = argparse.ArgumentParser(
        prog="python -m training.evaluate", description="Measure a generator on captions of the test split."
    )
    add_options(parser, "scenes", "out", "table", "seed", "steps", "guidance", "damping")
    parser.add_argument("--extractor", type=Path, required=True, help="of training.evaluate.extractor")
    parser.add_argument("--weights", type=Path, default=WEIGHTS / "intergen", help="its folder")
    parser.add_argument("--repeats", type=int, default=3, help="of all measures (3)")
    parser.add_argument("--prompts", type=int, default=256, help="test scenes in a repeat, at most (256)")
    parser.add_argument("--real-only", action="store_true", help="only the recorded motion; needs no weights")
    options = parser.parse_args(argv)

    def job() -> None:
        scenes, extractor = load(options.scenes), load_extractor(options.extractor)
        generator = None if options.real_only else InterGenPipeline(options.weights)
        sampling = Sampling(steps=options.steps, guidance=options.guidance, damping=options.damping)

        def drawn(tasks: Sequence[Task], seed: int) -> Iterator[tuple[int, Duet]]:
            assert generator is not None
            print(f"{len(tasks)} captions, seed {seed}", file=sys.stderr, flush=True)
            return draw(generator, tasks, sampling, seed)

        found = measure(
            scenes,
            extractor,
            drawn if generator else None,
            prompts=options.prompts,
            repeats=options.repeats,
            seed=options.seed,
        )
        write_scores(options, found, table(found))

    return exit_code(job)


if __name__ == "__main__":
    raise SystemExit(main())
