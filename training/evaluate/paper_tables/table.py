"""A table of small trainings: its rows, the clips that each row makes, and their scores."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from training.core.loop import Loop
from training.corpus.strict_pairs import StrictPair
from training.evaluate.deep_gru import DeepGRU, deep_features, fit, measured

Array = NDArray[np.floating]

DATASETS = {"sbu": "SBU", "k3hi": "K3HI"}


@dataclass(frozen=True)
class Row:
    """A row of a table.

    Attributes:
        label: as shown.
        run: the training whose network the row uses; rows may share one.
        paper: the paper's figures, by the head of their column.
        sampling: what differs when the network is used.
    """

    label: str
    run: str
    paper: Mapping[str, str] = field(default_factory=dict)
    sampling: Mapping[str, Any] = field(default_factory=dict)


class Table(ABC):
    """Trainings, samples and figures of one table.

    Attributes:
        name: of the command's argument.
        title: says which tables of which paper these are.
        about: the sizes of the networks, for the reader.
        runs: settings that differ from the whole network's, by the name of a training.
        rows: by name.
        heads: columns of the paper's figures.
        steps: of each training, by default.
    """

    name: str
    title: str
    about: str
    runs: Mapping[str, Mapping[str, Any]]
    rows: Mapping[str, Row]
    heads: Sequence[str]
    steps: int

    @abstractmethod
    def trainer(self, pairs: Sequence[StrictPair], run: str, out: Path, *, steps: int, seed: int) -> Loop:
        """The training of a run, which resumes from ``out``."""

    @abstractmethod
    def make(self, trainer: Loop, row: Row, pairs: Sequence[StrictPair], *, seed: int) -> list[Array]:
        """Clips of a trained network for the test clips, (T, F) each as :meth:`seen` gives them."""

    @abstractmethod
    def seen(self, people: Array) -> Array:
        """A recorded pair (2, T, 22, 3) as the classifier sees it: (T', F)."""


def judges(
    table: Table, train: Sequence[StrictPair], classes: Sequence[str], count: int, *, epochs: int
) -> list[DeepGRU]:
    """Classifiers of recorded training clips, each of another seed."""
    clips = [table.seen(pair.positions) for pair in train]
    labels = [classes.index(pair.label) for pair in train]
    return [fit(clips, labels, seed=seed, epochs=epochs) for seed in range(count)]


def scores(
    table: Table,
    pairs: Sequence[StrictPair],
    made: Mapping[str, Sequence[Sequence[Array]]],
    *,
    classifiers: int,
    epochs: int = 80,
    say: Callable[[str], None] = lambda line: None,
) -> dict[str, dict[str, dict[str, list[float]]]]:
    """Accuracy, FVD and diversity by data set and row, a value a classifier and training.

    Args:
        made: by row, for each training, a clip for every test pair in their order.
        say: is told of progress.
    """
    found: dict[str, dict[str, dict[str, list[float]]]] = {}
    tests = [pair for pair in pairs if pair.test]
    for key, name in DATASETS.items():
        train = [pair for pair in pairs if pair.dataset == key and not pair.test]
        places = [place for place, pair in enumerate(tests) if pair.dataset == key]
        if not train or len(places) < 2:
            continue
        classes = sorted({pair.label for pair in train})
        labels = [classes.index(tests[place].label) for place in places]
        truth = [table.seen(tests[place].positions) for place in places]
        rows: dict[str, dict[str, list[float]]] = {}
        for network in judges(table, train, classes, classifiers, epochs=epochs):
            real = deep_features(network, truth)
            every = {"recorded": [truth]} | {
                row: [[clips[place] for place in places] for clips in samples]
                for row, samples in made.items()
            }
            for row, samples in every.items():
                for clips in samples:
                    for score, value in measured(network, clips, labels, real).items():
                        rows.setdefault(row, {}).setdefault(score, []).append(value)
            say(f"{name}: judged")
        found[name] = rows
    return found
