"""Fairness of the rules of sentences, shown on puppets; and the captions of the corpus, which repeat no sentence."""

from __future__ import annotations

import re
import zlib
from collections.abc import Iterator, Mapping
from functools import cache

import numpy as np

from motion.metrics.sentences import Sentence
from motion.metrics.sentences.joints import Motion
from motion.transforms import mirrored
from training.corpus.captions import Phrasebook
from training.corpus.grammar import expand
from training.corpus.phrases import ACTIONS, ENTRIES

from .puppets import play


class Puppets:
    """Sentences with their scripts, which puppets play.

    Args:
        sentences: by their ids.
        scripts: stage directions, see :mod:`.puppets`, by the same ids.
    """

    def __init__(self, sentences: Mapping[str, Sentence], scripts: Mapping[str, str]) -> None:
        self.sentences, self.scripts = sentences, scripts
        self.motion = cache(self._motion)

    def _motion(self, name: str) -> Motion:
        return Motion(play(self.scripts[name], self.sentences[name].seconds))

    def assert_fair(self, name: str) -> None:
        """Asserts that a rule passes when its words are done, and fails on everything nearby.

        That is: two who only stand, the wrong person where people are named, the wrong order and the other hand.
        """
        sentence, motion = self.sentences[name], self.motion(name)
        found = sentence.judge(motion)
        assert found.passed, [rule for rule, fulfilled in found.parts if not fulfilled]
        for gap in (0.7, 1.5, 3.0):
            assert not sentence.judge(Motion(play(f"gap {gap}", sentence.seconds))).passed, f"{gap} m apart"
        assert sentence.judge(motion.swapped()).passed is not sentence.named, "people exchanged"
        if sentence.ordered:
            assert not sentence.judge(motion.reversed()).passed, "played backwards"
        if "side" in sentence.tags:
            assert not sentence.judge(Motion(mirrored(motion.positions))).passed, "the other hand"

    def passing_others(self, names: list[str], others: int, stride: int) -> list[tuple[str, str]]:
        """(sentence, other sentence) whose puppets pass its rule, of so many others for each sentence."""
        return [
            (name, other)
            for i, name in enumerate(names)
            for other in (names[(i + stride * k) % len(names)] for k in range(1, others + 1))
            if self.sentences[name].judge(self.motion(other)).passed
        ]


def captions_of(family: str, split: str = "train") -> list[str]:
    """Captions of a family of the corpus; of another draw for each family and split."""
    rng = np.random.default_rng(zlib.crc32(f"{family} {split}".encode()))
    acts = sorted(ACTIONS)
    slots = {key: str(rng.choice(acts)) for key in ("act_a", "act_b", "first", "second")}
    return Phrasebook(family).sample(rng, slots, n=40, split=split)


def phrases() -> Iterator[str]:
    """All sentences and keywords of the phrase book, with people for its marks."""
    people = {"{A}": "one person", "{B}": "the other"}
    for entry in ENTRIES.values():
        for pattern in (*entry.nouns, *entry.sentences, *entry.both, *entry.a, *entry.b):
            for text in expand(pattern):
                for mark, word in people.items():
                    text = text.replace(mark, word)
                yield re.sub(r"\*|\{[^}]*\}", "", text)
