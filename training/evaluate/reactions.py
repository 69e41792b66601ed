"""Reactions judged by a classifier: ``python -m training.evaluate.reactions --data DIR --out scores.json``.

The thesis' table (Chopin, Tables 3.2–3.3) on SBU and K3HI: classification accuracy, FVD and diversity of the
reacting person, for recorded motion, zero velocity and the reaction models of the engine. The classifiers
(:mod:`training.evaluate.deep_gru`) are trained on recorded reactions of the published training lists and judge those
to the actors of the test lists, which no model was trained on. Three baselines of :mod:`training.evaluate.baselines`
know the same recorded pairs.

Methods whose name ends in *class told* get the sentence of the clip's class (:data:`SENTENCES`), the others no words.

With ``--strict`` the clips are those of :mod:`training.corpus.strict_pairs`: all of the lists, in the data sets' own
classes.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.stats import t as student

from motion import Duet, InputError
from motion.formats.files import write_text
from motion.metrics import summary
from training.core.shell import add_options, exit_code
from training.corpus.pairs import load_pairs
from training.corpus.strict_pairs import strict_pairs
from training.evaluate.baselines import Baseline, conditional_vae, nearest, plain_transformer
from training.evaluate.deep_gru import accuracy, deep_features, fit, frechet_distance, measured
from training.evaluate.judge.reactions import METHODS, installed, react
from training.evaluate.paper_tables.clips import SENTENCES
from webdemo.inference import Engine

Array = NDArray[np.floating]

CLASS_TOLD = {
    f"{name}, class told": chosen for name, chosen in METHODS.items() if chosen["model"] == "regennet"
}
"""Request fields of ReGenNet with the sentence of a clip's class, at the page's guidance scale."""
DATASETS = {"sbu": "SBU", "k3hi": "K3HI"}
STRIDE = 2
"""The classifier sees every second frame, 15 a second, as SBU was recorded."""
SHORTEST = 31
"""Frames: the models react to a second or more."""
READOUTS = (
    ("facing", "Facing °"),
    ("distance", "Distance m"),
    ("contact_seconds", "Contact s"),
    ("contact_due", "Contact where due %"),
    ("response_delay", "Delay s"),
    ("foot_skate", "Foot skate cm/s"),
    ("penetration", "Penetration cm"),
)
"""Keys and heads of the read-outs in the table."""


@dataclass(frozen=True)
class Reaction:
    """A recorded pair of people (2, T, 22, 3) of one class."""

    people: Array
    label: int

    def clip(self) -> Array:
        """The classifier's view: person b in the actor's frame, (T / 2, 66)."""
        return seen(self.people[1])


def seen(person: Array) -> Array:
    """A person (T, 22, 3) as the classifier sees them."""
    return person[::STRIDE].reshape(-1, 66)


def recorded(
    data: Path, cache: Path | None, dataset: str
) -> tuple[list[Reaction], list[Reaction], list[str]]:
    """Training and test pairs of a data set, and its classes."""
    scenes = [
        scene
        for scene in load_pairs(data, cache)
        if scene.sources[0].startswith(dataset) and scene.positions.shape[1] >= SHORTEST
    ]
    trained = [scene for scene in scenes if scene.split == "train"]
    classes = sorted({scene.family for scene in trained})
    kinds: dict[bool, list[Reaction]] = {True: [], False: []}
    for scene in scenes:
        if scene.family in classes:
            kinds[scene.split == "train"].append(Reaction(scene.positions, classes.index(scene.family)))
    if not kinds[False]:
        raise InputError(f"{data} holds no test clips of {DATASETS[dataset]}: give the whole release.")
    return kinds[True], kinds[False], classes


def strictly(
    data: Path, cache: Path | None, dataset: str
) -> tuple[list[Reaction], list[Reaction], list[str]]:
    """Every listed training and test pair of a data set, and its classes."""
    pairs = [pair for pair in strict_pairs(data, cache) if pair.dataset == dataset]
    classes = sorted({pair.label for pair in pairs})
    kinds: dict[bool, list[Reaction]] = {True: [], False: []}
    for pair in pairs:
        kinds[pair.test].append(Reaction(pair.positions, classes.index(pair.label)))
    return kinds[False], kinds[True], classes


def long_enough(people: Array) -> Array:
    """The pair (2, T, 22, 3) with its last poses held where it is shorter than a model's second."""
    missing = max(0, SHORTEST - people.shape[1])
    return np.concatenate([people, np.repeat(people[:, -1:], missing, axis=1)], axis=1)


def baselines(
    train: Sequence[Reaction], test: Sequence[Reaction], seeds: int, *, steps: int = 400
) -> dict[str, list[list[Array]]]:
    """Per baseline and seed, a person b for each test clip. The nearest reaction has no seed."""
    known = [reaction.people for reaction in train]

    def all_of(react: Baseline) -> list[Array]:
        return [react(reaction.people) for reaction in test]

    return {
        "Nearest recorded reaction": [all_of(nearest(known))],
        "Plain Transformer": [
            all_of(plain_transformer(known, seed=seed, steps=steps)) for seed in range(seeds)
        ],
        "Conditional VAE": [all_of(conditional_vae(known, seed=seed, steps=steps)) for seed in range(seeds)],
    }


def zero_velocity(reaction: Reaction, _: int) -> Array:
    """Person b as they stand at first."""
    return np.repeat(reaction.people[1, :1], reaction.people.shape[1], axis=0)


def score(
    train: Sequence[Reaction], test: Sequence[Reaction], made: dict[str, list[list[Array]]], *, seeds: int
) -> dict[str, dict[str, list[float]]]:
    """Accuracy, FVD and :func:`diversity_score` of every method, one value a classifier and sampling seed.

    ``made``: per method, per sampling seed, a person b for each test clip.
    """
    labels = [reaction.label for reaction in test]
    truth = [reaction.clip() for reaction in test]
    known = [reaction.clip() for reaction in train]
    rows: dict[str, dict[str, list[float]]] = {}

    def add(method: str, **values: float) -> None:
        for name, value in values.items():
            rows.setdefault(method, {}).setdefault(name, []).append(round(value, 4))

    for seed in range(seeds):
        network = fit(known, [reaction.label for reaction in train], seed=seed)
        real = deep_features(network, truth)
        add(
            "Recorded",
            accuracy=accuracy(network, truth, labels),
            fvd=frechet_distance(deep_features(network, known), real),
            diversity=0.0,
        )
        for method, samples in made.items():
            for people in samples:
                clips = [seen(person) for person in people]
                add(method, **measured(network, clips, labels, real))
    return rows


def readouts(test: Sequence[Reaction], people: Sequence[Array]) -> dict[str, float | None]:
    """The page's read-outs, each the mean over the test clips that have it.

    ``response_delay`` is a median, since a single distant chance match would distort a mean. ``contact_due`` is the
    percentage of the clips with recorded contact in which these people touch, too. None if no clip has a value.
    """
    recorded, found = (
        [
            summary(Duet.from_positions(np.stack([reaction.people[0], person]), fps=30.0))
            for reaction, person in zip(test, made, strict=True)
        ]
        for made in ([reaction.people[1] for reaction in test], people)
    )
    for true, one in zip(recorded, found, strict=True):
        one["contact_due"] = 100.0 * (one["contact_seconds"] > 0) if true["contact_seconds"] > 0 else None
    rounded: dict[str, float | None] = {}
    for key, _ in READOUTS:
        values = [one[key] for one in found if one[key] is not None]
        middle = np.median if key == "response_delay" else np.mean
        rounded[key] = round(float(middle(values)), 4) if values else None
    return rounded


def interval(values: Sequence[float]) -> tuple[float, float]:
    """Mean, and half the width of its 95 % interval by Student's t."""
    few = len(values)
    half = student.ppf(0.975, few - 1) * np.std(values, ddof=1) / np.sqrt(few) if few > 1 else 0.0
    return float(np.mean(values)), float(half)


def table(scores: dict[str, Any]) -> str:
    """Markdown of all scores."""
    lines = []
    for dataset, found in scores.items():
        lines += [
            f"## {DATASETS[dataset]}: {found['train']} training and {found['test']} test clips, "
            f"{len(found['classes'])} classes",
            "",
            "| Method | Accuracy % | FVD | Diversity %, 0 is best | "
            f"{' | '.join(head for _, head in READOUTS)} |",
            f"|---|---|---|---{'|---' * len(READOUTS)}|",
        ]
        for method, values in found["scores"].items():
            cells = []
            for name, factor in (("accuracy", 100), ("fvd", 1), ("diversity", 1)):
                mean, half = interval(np.array(values[name]) * factor)
                cells.append(f"{mean:.1f} ± {half:.1f}")
            shown = [found["readouts"][method][key] for key, _ in READOUTS]
            cells += ["–" if value is None else f"{value:.2f}" for value in shown]
            lines.append(f"| {method} | {' | '.join(cells)} |")
        lines.append("")
    return "\n".join(lines)


def main(argv: list[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    offered = METHODS | CLASS_TOLD
    parser = argparse.ArgumentParser(description="Judge reactions by a classifier of recorded ones.")
    add_options(parser, "pairs", "cache", "out", "table", "weights")
    parser.add_argument("--datasets", nargs="+", choices=list(DATASETS), default=list(DATASETS))
    parser.add_argument("--methods", nargs="*", choices=list(offered), default=installed(offered))
    parser.add_argument("--strict", action="store_true", help="the thesis' lists and classes, unfiltered")
    parser.add_argument("--seeds", type=int, default=3, help="classifiers, each with a seed of its own")
    parser.add_argument("--samples", type=int, default=3, help="reactions to every actor")
    options = parser.parse_args(argv)
    return exit_code(lambda: _run(options))


def _run(options: argparse.Namespace) -> None:
    engine, scores = Engine(options.weights), {}
    for dataset in options.datasets:
        read = strictly if options.strict else recorded
        train, test, classes = read(options.data, options.cache, dataset)
        made = {"Zero velocity": [[zero_velocity(reaction, 0) for reaction in test]]}
        made |= baselines(train, test, options.samples)
        for method in options.methods:
            made[method] = []
            for seed in range(options.samples):
                print(f"{dataset}: {method}, seed {seed}", file=sys.stderr, flush=True)
                made[method].append([reacted(engine, one, classes, seed, method) for one in test])
        shown = {"Recorded": [reaction.people[1] for reaction in test]}
        shown |= {method: samples[0] for method, samples in made.items()}
        scores[dataset] = {
            "train": len(train),
            "test": len(test),
            "classes": classes,
            "scores": score(train, test, made, seeds=options.seeds),
            "readouts": {method: readouts(test, people) for method, people in shown.items()},
        }
        write_text(options.out, json.dumps(scores, indent=1))
    print(table(scores))
    if options.table:
        write_text(options.table, table(scores))


def reacted(engine: Engine, pair: Reaction, classes: Sequence[str], seed: int, method: str) -> Array:
    """Person b (T, 22, 3) as a method makes them for a recorded pair, one of these ``classes``."""
    whole = Duet.from_positions(long_enough(pair.people), fps=30.0)
    prompt = SENTENCES[classes[pair.label]] if method in CLASS_TOLD else ""
    made = react(engine, whole, seed, (METHODS | CLASS_TOLD)[method], prompt=prompt)
    return np.asarray(made.b.positions)[: pair.people.shape[1]]


if __name__ == "__main__":
    raise SystemExit(main())
