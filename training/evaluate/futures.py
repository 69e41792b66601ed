"""Futures of two people against what really followed: ``python -m training.evaluate.futures --data DIR``.

The recorded pairs of the test lists of SBU and K3HI, which no training saw: the first second is given, the rest is
predicted. Both people's futures, which know of each other, stand beside those of each person predicted alone.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from motion import FPS, Duet
from motion.transforms import heading
from motion.vectors import wrapped
from training.core.shell import add_options, exit_code
from training.corpus.pairs import load_pairs
from training.corpus.scene import Scene
from webdemo.inference import Engine, PredictRequest
from webdemo.inference.story import Beat, SceneRequest

Array = NDArray[np.floating]
Foretell = Callable[[Duet, str], list[Array]]

PAST, FUTURE, LEAST = 30, 30, 10
"""Frames that are given, that are predicted, and that must have followed."""
SAMPLES = 3


def distances(positions: Array) -> Array:
    """(T,) metres between the two pelvises over the floor, from (2, T, 22, 3) metres."""
    return np.linalg.norm((positions[0] - positions[1])[:, 0][:, [0, 2]], axis=-1)


def facings(positions: Array) -> Array:
    """(2, T) radians by which each person faces past the other, from (2, T, 22, 3) metres."""
    towards = (positions[::-1] - positions)[:, :, 0]
    return np.stack([heading(p) for p in positions]) - np.arctan2(towards[..., 0], towards[..., 2])


def errors(made: Array, truth: Array) -> tuple[float, float]:
    """Mean errors of the distance in centimetres and of the facing in degrees; (2, T, 22, 3) metres each."""
    turned = wrapped(facings(made) - facings(truth))
    return (
        100 * float(np.abs(distances(made) - distances(truth)).mean()),
        float(np.degrees(np.abs(turned)).mean()),
    )


def held_out(scenes: Sequence[Scene]) -> list[Scene]:
    """The scenes of the test lists that are long enough."""
    return [s for s in scenes if s.split == "benchmark" and s.positions.shape[1] >= PAST + LEAST]


def methods(engine: Engine, steps: int) -> dict[str, Foretell]:
    """The methods that are compared, by name: past and sentence → futures (2, FUTURE, 22, 3)."""

    def both(past: Duet, words: str) -> list[Array]:
        beats = (Beat(words, seconds=FUTURE / FPS),)
        *_, result = engine.run(SceneRequest(beats=beats, motion=past, samples=SAMPLES, steps=steps))
        return [duet.positions[:, PAST:] for duet in result.duets]

    def alone(past: Duet, model: str) -> list[Array]:
        people = []
        for clip in past.people:
            *_, result = engine.run(PredictRequest(motion=clip, seconds=FUTURE / FPS, model=model))
            people.append(result.duets[0].positions[PAST:])
        return [np.stack(people)]

    return {
        "both together, without words": lambda past, _: both(past, ""),
        "both together, with a sentence": both,
        "each alone (motion-mlp)": lambda past, _: alone(past, "motion-mlp"),
        "each alone (stands still)": lambda past, _: alone(past, "still"),
    }


def table(found: dict[str, Array]) -> str:
    """The mean errors (N, 2) of each method as Markdown, with the standard error of the mean."""
    count = len(next(iter(found.values())))
    lines = [f"| {count} recorded pairs | distance, cm | facing, degrees |", "|---|---:|---:|"]
    for name, values in found.items():
        cells = " | ".join(
            f"{m:.1f} ± {s:.1f}" for m, s in zip(values.mean(0), values.std(0) / count**0.5, strict=True)
        )
        lines.append(f"| {name} | {cells} |")
    return "\n".join(lines)


def main(argv: list[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    parser = argparse.ArgumentParser(prog="python -m training.evaluate.futures", description=__doc__)
    parser.add_argument("--data", type=Path, required=True, help="folder of the data sets sbu and k3hi")
    parser.add_argument("--cache", type=Path, help="folder that keeps what was read")
    add_options(parser, "weights", "steps")
    options = parser.parse_args(argv)

    def job() -> None:
        scenes = held_out(load_pairs(options.data, options.cache))
        found: dict[str, Array] = {}
        for name, predict in methods(Engine(options.weights), options.steps).items():
            rows = []
            for scene in scenes:
                past = Duet.from_positions(scene.positions[:, :PAST], fps=FPS)
                truth = scene.positions[:, PAST : PAST + FUTURE]
                futures = predict(past, scene.captions[0])
                rows.append(np.mean([errors(f[:, : truth.shape[1]], truth) for f in futures], axis=0))
            found[name] = np.array(rows)
        print(table(found))

    return exit_code(job)


if __name__ == "__main__":
    raise SystemExit(main())
