"""Captions that the corpus makes from the lexicon are read back as their own plan."""

from __future__ import annotations

import re
from collections.abc import Iterator

import numpy as np

from acts import Act, Plan
from acts.plan import beats
from acts.reading import read
from training.corpus.beats.stories import stories
from training.corpus.cues import Beat, label
from training.corpus.telling import Teller, Told

LENGTH = 60


def captions(seed: int, count: int) -> list[Told]:
    """A caption of each of some stories, drawn at random."""
    rng = np.random.default_rng(seed)
    found: list[Told] = []
    for number in rng.permutation(len(stories()))[:count]:
        pairs = stories()[number]
        listed = [
            Beat(pair, k * LENGTH, (k + 1) * LENGTH, relation="while" if pair[0] == pair[1] else "reply")
            for k, pair in enumerate(pairs)
        ]
        found += Teller(rng, label(listed, LENGTH * len(pairs)), "train").scene(1)
    return found


def agrees(read: Plan, told: Plan) -> bool:
    """True if a plan that was read from a caption is the one that it tells.

    The same acts by the same people, in the same order; patients, sides, parts and directions where both name them.
    An act of one person that is done together by its nature ("he hugs her") may be read as both people's.
    """
    one, other = (list(_facts(plan)) for plan in (read, told))
    return len(one) == len(other) and all(_alike(*pair) for pair in zip(one, other, strict=True))


def _facts(plan: Plan) -> Iterator[tuple[int, Act]]:
    for level, group in enumerate(beats(plan.acts)):
        for act in sorted(group, key=lambda act: (act.act, act.agents)):
            yield level, act


def _alike(read: tuple[int, Act], told: tuple[int, Act]) -> bool:
    (level, one), (wanted, other) = read, told
    named = [(getattr(one, key), getattr(other, key)) for key in ("patient", "side", "direction")]
    return (
        level == wanted
        and one.act == other.act
        and set(one.agents) == set(other.agents)
        and one.modality == other.modality
        and all(a == b for a, b in named if a is not None and b is not None)
        and (other.side is None or one.side is not None)
    )


def test_captions_say_what_people_are_doing_and_where() -> None:
    told = [one.text for one in captions(seed=3, count=300)]
    going = [text for text in told if re.search(r"\b(is|are) \w+ing\b", text)]
    assert 3 <= len(going) <= 60
    assert not [text for text in going if " then " in text], "said of one moment alone"
    assert 20 <= sum(text.startswith(("In ", "At ", "On ")) for text in told) <= 60


def test_captions_are_read_as_the_plan_that_they_tell() -> None:
    told = captions(seed=29, count=100)
    assert len(told) > 80
    missed = [one.text for one in told if not agrees(read(one.text), one.plan)]
    assert len(missed) <= 0.1 * len(told), missed
