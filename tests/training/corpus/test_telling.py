"""Captions that the corpus makes from the lexicon are read back as their own plan."""

from __future__ import annotations

import numpy as np

from acts.reading import read
from training.corpus.beats.stories import stories
from training.corpus.cues import Beat, label
from training.corpus.telling import Teller, Told, agrees

LENGTH = 60


def captions(seed: int, count: int) -> list[Told]:
    """A caption of each of some stories, drawn at random."""
    rng = np.random.default_rng(seed)
    found: list[Told] = []
    for number in rng.permutation(len(stories()))[:count]:
        pairs = stories()[number]
        beats = [
            Beat(pair, k * LENGTH, (k + 1) * LENGTH, relation="while" if pair[0] == pair[1] else "reply")
            for k, pair in enumerate(pairs)
        ]
        found += Teller(rng, label(beats, LENGTH * len(pairs)), "train").scene(1)
    return found


def test_captions_are_read_as_the_plan_that_they_tell() -> None:
    told = captions(seed=29, count=100)
    assert len(told) > 80
    missed = [one.text for one in told if not agrees(read(one.text), one.plan)]
    assert len(missed) <= 0.1 * len(told), missed
