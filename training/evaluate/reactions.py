"""Reactions judged by a classifier: ``python -m training.evaluate.reactions --data DIR --out scores.json``.

The thesis' table (Chopin, Tables 3.2–3.3) on SBU and K3HI: classification accuracy, FVD and diversity of the
reacting person, for recorded motion, zero velocity and the reaction models of the engine. The classifiers
(:mod:`training.evaluate.deep_gru`) are trained on recorded reactions of the published training lists and judge those
to the actors of the test lists, which no model was trained on. All of the lists' clips count, in the data sets' own
classes. The nearest recorded reaction knows the training lists' pairs and nothing of the test lists.

Methods whose name ends in *class told* get the sentence of the clip's class (:data:`SENTENCES`), the others no words.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from motion import Clip, Duet, InputError
from motion.metrics import summary
from motion.metrics.generation import frechet_distance, interval
from motion.vectors import Array
from training.core.shell import add_options, exit_code, write_scores
from training.corpus.pairs import Pair, load_pairs
from training.evaluate.deep_gru import accuracy, deep_features, fit, measured
from webdemo.inference import Engine, ReactRequest, Result
from webdemo.inference.methods import method as known_method
from webdemo.inference.pipelines.nearest import Bank

_OFFLINE = {"model": "regennet", "mode": "offline", "steps": 5, "damping": 0.0}
_ONLINE = {"model": "regennet", "mode": "online", "steps": 5}
_PERSON_TO_PERSON = {"model": "intergen", "mode": "offline"}
METHODS: dict[str, dict[str, Any]] = {
    "ReGenNet, online": _ONLINE,
    "ReGenNet, offline": _OFFLINE,
    "ReGenNet, online, first pose given": _ONLINE | {"first_pose": True},
    "ReGenNet, offline, first pose given": _OFFLINE | {"first_pose": True},
    "InterFormer": {"model": "interformer"},
    "InterFormer, first pose given": {"model": "interformer", "first_pose": True},
    "Nearest recorded reaction": {"model": "nearest", "first_pose": True},
    "InterGen, person to person": _PERSON_TO_PERSON | {"steps": 20, "guidance": 1.0, "damping": 0.0},
    "Virtual agent": {"model": "agent", "steps": 20, "damping": 0.0},
}
"""Request fields by method, without damping. ``first_pose``: the recorded one is given; ``told``: the words are
:data:`SENTENCES` of the clip's class, and else there are none."""
SENTENCES = {
    "approach": "One person walks up to the other.",
    "depart": "One person walks away from the other.",
    "exchange": "Two people exchange something.",
    "handshake": "Two people shake hands.",
    "kick": "One person kicks the other.",
    "point": "One person points at the other.",
    "punch": "One person punches the other.",
    "push": "One person pushes the other.",
    "walking": "One person walks and the other stands still.",
}
"""What the actor, named first, and the reactor do, by class."""
METHODS |= {f"{name}, class told": own | {"told": True} for name, own in METHODS.items() if own["model"] == "regennet"}
DATASETS = {"sbu": "SBU", "k3hi": "K3HI"}
WALKING = "walking"
"""SBU's approaching and departing are one class in the thesis (section 3.4.1)."""
STRIDE = 2
"""The classifier sees every second frame, 15 a second, as SBU was recorded."""
SHORTEST = 31
"""Frames: the models react to a second or more."""
READOUTS = (
    ("facing", "Facing °"),
    ("distance", "Distance m"),
    ("contact_seconds", "Contact s"),
    ("contact_due", "Contact where due %"),
    ("foot_skate", "Foot skate cm/s"),
    ("jerk", "Jerk m/s³"),
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


def label_of(pair: Pair) -> str:
    """The class of a clip in the thesis."""
    return WALKING if pair.dataset == "sbu" and pair.family in ("approach", "depart") else pair.family


def recorded(pairs: Sequence[Pair]) -> tuple[list[Reaction], list[Reaction], list[str]]:
    """The training and the test pairs of a data set, and its classes."""
    classes = sorted({label_of(pair) for pair in pairs})
    kinds: dict[bool, list[Reaction]] = {True: [], False: []}
    for pair in pairs:
        kinds[pair.test].append(Reaction(pair.positions, classes.index(label_of(pair))))
    if not kinds[True]:
        raise InputError("There are no test clips: give the whole release.")
    return kinds[False], kinds[True], classes


def long_enough(people: Array) -> Array:
    """The pair (2, T, 22, 3) with its last poses held where it is shorter than a model's second."""
    missing = max(0, SHORTEST - people.shape[1])
    return np.concatenate([people, np.repeat(people[:, -1:], missing, axis=1)], axis=1)


def drafted(bank: Bank, people: Array) -> Array:
    """The reactor (T, 22, 3) of the nearest recorded pair in these people's tempo, as InterGen gets it to finish."""
    number, moments = bank.answers(people[0], people[1, 0])[0]
    return bank.reactor(number, moments, people[0], people[1, 0])


def zero_velocity(reaction: Reaction) -> Array:
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

    ``contact_due`` is the percentage of the clips with recorded contact in which these people touch, too. None if no
    clip has a value.
    """
    recorded, reacted = (
        [
            summary(Duet.from_positions(np.stack([reaction.people[0], person]), fps=30.0))
            for reaction, person in zip(test, made, strict=True)
        ]
        for made in ([reaction.people[1] for reaction in test], people)
    )
    for true, one in zip(recorded, reacted, strict=True):
        one["contact_due"] = 100.0 * (one["contact_seconds"] > 0) if true["contact_seconds"] > 0 else np.nan
    rounded: dict[str, float | None] = {}
    for key, _ in READOUTS:
        values = [one[key] for one in reacted if not np.isnan(one[key])]
        rounded[key] = round(float(np.mean(values)), 4) if values else None
    return rounded


def table(scores: dict[str, Any]) -> str:
    """Markdown of all scores."""
    lines = []
    for dataset, readings in scores.items():
        lines += [
            f"## {DATASETS[dataset]}: {readings['train']} training and {readings['test']} test clips, "
            f"{len(readings['classes'])} classes",
            "",
            f"| Method | Accuracy % | FVD | Diversity %, 0 is best | {' | '.join(head for _, head in READOUTS)} |",
            f"|---|---|---|---{'|---' * len(READOUTS)}|",
        ]
        for method, values in readings["scores"].items():
            cells = []
            for name, factor in (("accuracy", 100), ("fvd", 1), ("diversity", 1)):
                mean, half = interval([factor * value for value in values[name]])
                cells.append(f"{mean:.1f} ± {half:.1f}")
            shown = [readings["readouts"][method][key] for key, _ in READOUTS]
            cells += ["–" if value is None else f"{value:.2f}" for value in shown]
            lines.append(f"| {method} | {' | '.join(cells)} |")
        lines.append("")
    return "\n".join(lines)


def main(argv: list[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    parser = argparse.ArgumentParser(description="Judge reactions by a classifier of recorded ones.")
    add_options(parser, "pairs", "cache", "out", "table", "weights")
    parser.add_argument("--datasets", nargs="+", choices=list(DATASETS), default=list(DATASETS))
    parser.add_argument("--methods", nargs="*", choices=list(METHODS), help="those whose weights are there")
    parser.add_argument("--seeds", type=int, default=3, help="classifiers, each with a seed of its own")
    parser.add_argument("--samples", type=int, default=3, help="reactions to every actor")
    options = parser.parse_args(argv)
    return exit_code(lambda: _run(options))


def _run(options: argparse.Namespace) -> None:
    engine, scores, pairs = Engine(options.weights), {}, load_pairs(options.data, options.cache)
    installed = [name for name, chosen in METHODS.items() if _is_installed(chosen["model"], options.weights)]
    methods = installed if options.methods is None else options.methods
    for dataset in options.datasets:
        train, test, classes = recorded([pair for pair in pairs if pair.dataset == dataset])
        made = {"Zero velocity": [[zero_velocity(reaction) for reaction in test]]}
        bank = Bank([reaction.people for reaction in train])
        made["Nearest recorded reaction, not finished"] = [[drafted(bank, one.people) for one in test]]
        if "Nearest recorded reaction" in methods:
            nearest: Any = engine.pipeline("nearest")
            nearest.bank = bank
        for method in methods:
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
        write_scores(options, scores, table(scores))


def _is_installed(name: str, weights: Path) -> bool:
    """True for a method whose weights are in a folder, with those of the methods that it needs."""
    return all(known_method(each).installed(weights) for each in (name, *known_method(name).needs))


def reacted(engine: Engine, pair: Reaction, classes: Sequence[str], seed: int, method: str) -> Array:
    """Person b (T, 22, 3) as a method makes them for a recorded pair, one of these ``classes``.

    Of the recorded person b only the first pose is used, by methods that take one.
    """
    fields, people = dict(METHODS[method]), long_enough(pair.people)
    pose = people[1, 0] if fields.pop("first_pose", False) else None
    prompt = SENTENCES[classes[pair.label]] if fields.pop("told", False) else ""
    request = ReactRequest(actor=Clip(people[0], 30.0), prompt=prompt, seed=seed, first_pose=pose, **fields)
    made = next(event for event in engine.run(request) if isinstance(event, Result)).duets[0]
    return np.asarray(made.people[1].positions)[: pair.people.shape[1]]


if __name__ == "__main__":
    raise SystemExit(main())
