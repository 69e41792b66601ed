"""The pairs of SBU and K3HI by the protocol of Chopin's thesis: every listed clip, in the data sets' own classes."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from motion.formats.files import replacing
from motion.transforms import canonicalize
from training.corpus.kinect import KinectPair, fit_pair, read_pairs

Array = NDArray[np.floating]

CACHE = "strict-pairs-1.npz"
WALKING = "walking"
"""SBU's approaching and departing are one class in the thesis (section 3.4.1)."""


@dataclass(frozen=True, eq=False)
class StrictPair:
    """A listed clip.

    Attributes:
        positions: (2, T, 22, 3) metres at 30 fps, the actor first, canonical to the actor.
        label: the class, of the data set.
        dataset: "sbu" or "k3hi".
        test: True in the test list.
        name: of the clip.
    """

    positions: Array = field(repr=False)
    label: str
    dataset: str
    test: bool
    name: str


def strict_pairs(data: str | Path, cache: str | Path | None = None) -> list[StrictPair]:
    """All listed clips, fitted once (about five minutes) and then read from a cache.

    Args:
        data: the folder that holds ``sbu`` and ``k3hi``, unpacked or as archives.
        cache: folder of the cache file; by default ``data``.

    Raises:
        InputError: if the data are not there.
    """
    path = Path(cache or data) / CACHE
    if not path.is_file():
        pairs = list(_fitted_of(read_pairs(data)))
        arrays = {f"positions{number}": pair.positions for number, pair in enumerate(pairs)}
        kept = {key: np.array([getattr(pair, key) for pair in pairs]) for key in ("label", "dataset", "test", "name")}
        with replacing(path) as temporary, open(temporary, "wb") as file:
            np.savez_compressed(file, **arrays, **kept)
    with np.load(path, allow_pickle=False) as stored:
        return [
            StrictPair(stored[f"positions{number}"], str(label), str(dataset), bool(test), str(name))
            for number, (label, dataset, test, name) in enumerate(
                zip(*(stored[key] for key in ("label", "dataset", "test", "name")), strict=True)
            )
        ]


def _fitted_of(pairs: Iterable[KinectPair]) -> Iterator[StrictPair]:
    """The listed ones, on bodies."""
    for pair in pairs:
        if pair.split != "unlisted":
            people = canonicalize(fit_pair(pair)[0]).astype(np.float32)
            yield StrictPair(people, label_of(pair), pair.dataset, pair.split == "benchmark", pair.name)


def label_of(pair: KinectPair) -> str:
    """The class of a clip in the thesis."""
    walks = pair.dataset == "sbu" and pair.family in ("approach", "depart")
    return WALKING if walks else pair.family
