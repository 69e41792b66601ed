"""The sentences, what a motion of each must show, and captions that come too near to one of them."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from motion import Duet

from .joints import Motion
from .language import check

SENTENCES = Path(__file__).with_name("sentences.json")
ALIKE = 0.9
"""Share of words (Dice's coefficient) from which a caption is one of the sentences in other words."""
_EMPTY = frozenset({"a", "an", "the", "and", "then"})


@dataclass(frozen=True)
class Judgement:
    """The verdict of one sentence's rule on one motion.

    Attributes:
        passed: whether every condition is fulfilled.
        parts: (condition, whether it is fulfilled); of the two ways to cast the people the better one.
    """

    passed: bool
    parts: tuple[tuple[str, bool], ...]

    @property
    def share(self) -> float:
        """Conditions fulfilled, 0 to 1."""
        return sum(fulfilled for _, fulfilled in self.parts) / len(self.parts)


@dataclass(frozen=True)
class Sentence:
    """One sentence.

    Attributes:
        id: a short name.
        words: the sentence.
        seconds: length of the motion that is asked for.
        tags: what is hard about it, such as "two_beats" or "refuse".
        named: whether the words say who is who ("person A", "the first person", "B"); where they do not,
            either person may do what either one does.
        ordered: whether the motion played backwards must fail.
        rule: conditions of :mod:`.language`, all of which must be fulfilled.
        source: who wrote the words, where it was not this project.
    """

    id: str
    words: str
    seconds: float
    tags: tuple[str, ...]
    named: bool
    ordered: bool
    rule: tuple[str, ...]
    source: str = ""

    def judge(self, motion: Motion | Duet) -> Judgement:
        """The rule's judgement of a motion of SMPL's 22 joints."""
        if isinstance(motion, Duet):
            motion = Motion(motion.positions, motion.fps)
        found = [self._cast(motion)]
        if not self.named and not found[0].passed:
            found.append(self._cast(motion.swapped()))
        return max(found, key=lambda judgement: judgement.share)

    def _cast(self, motion: Motion) -> Judgement:
        parts = tuple((rule, check(rule, motion)) for rule in self.rule)
        return Judgement(all(fulfilled for _, fulfilled in parts), parts)


@cache
def load_sentences(path: Path = SENTENCES) -> tuple[Sentence, ...]:
    """All sentences, in the order of the file."""
    rows = json.loads(path.read_text(encoding="utf-8"))
    return tuple(Sentence(**row | {"tags": tuple(row["tags"]), "rule": tuple(row["rule"])}) for row in rows)


# ---- captions ------------------------------------------------------------------------------------------
def _words(text: str) -> frozenset[str]:
    """The words of a sentence without articles, "and" and "then"."""
    return frozenset(re.findall(r"[a-z0-9']+", text.lower())) - _EMPTY


@cache
def _known() -> tuple[frozenset[str], ...]:
    return tuple(_words(sentence.words) for sentence in load_sentences())


def kept_out(caption: str) -> str | None:
    """The sentence that a caption repeats, or None.

    A caption repeats a sentence where they share nine tenths of their words, articles, "and", "then", case,
    order and punctuation aside.
    """
    words = _words(caption)
    for sentence, known in zip(load_sentences(), _known(), strict=True):
        if 2 * len(words & known) >= ALIKE * (len(words) + len(known)):
            return sentence.words
    return None


def without_sentences(captions: Iterable[str]) -> list[str]:
    """The captions that may be trained on: those that repeat none of the sentences."""
    return [caption for caption in captions if kept_out(caption) is None]
