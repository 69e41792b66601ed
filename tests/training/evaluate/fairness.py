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
from training.corpus import phrasing
from training.corpus.beats.stories import stories
from training.corpus.cues import Beat, label, steps
from training.corpus.telling import Teller

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


CUES = sorted({pair for story in stories() for pair in story})
"""What A and B do in the beats that the corpus plays."""


def captions_of(acts: tuple[str, str], split: str = "train") -> list[str]:
    """Captions of a beat of the corpus; of another draw for each beat and split."""
    rng = np.random.default_rng(zlib.crc32(f"{acts} {split}".encode()))
    sides = ("left", None) if rng.random() < 0.5 else (None, None)
    teller = Teller(rng, label([Beat(acts, 0, 60, relation="while", sides=sides)], 60), split)
    return [*teller.scene(12), *teller.alone("a", 4)]


def phrases() -> Iterator[str]:
    """All phrases of the entries that the corpus shows, with people for their slots."""
    for name in sorted({name for cues in CUES for cue in cues for group in steps(cue) for name, *_ in group}):
        for text in phrasing.phrases(name):
            plain = text.replace("{a+b}", "They").replace("{a}", "One person").replace("{b}", "the other")
            yield re.sub(r"[\[\]]|\{[^}]*\}", "", plain)
