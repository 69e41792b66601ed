"""Nouns → kinds of things that have a shape, and what an act does with its thing."""

from __future__ import annotations

import re
import tomllib
from functools import lru_cache
from pathlib import Path
from typing import Literal

from acts.plan import Act
from motion.things import FIXTURES

_Passed = Literal["gives", "takes", "throws", "catches", "rolls", "kicks", "bounces"]
_Held = Literal["carries", "holds", "lifts", "puts", "drops", "plays", "fights", "uses"]
_Stands = Literal["sits", "passes", "faces", "opens", "closes"]
Does = Literal["", _Passed, _Held, _Stands]
"""What is done with a thing: the values that an entry's ``thing`` may have."""
SEATS = ("chair", "bench", "bed")
"""Kinds of things on which people sit."""
Prop = Literal["", "ball", "book", "cup", "guitar", "phone", "ring", "stick", "sword"]
"""Kinds of things that go without saying: the values that an entry's ``prop`` may have."""

_WORD = re.compile(r"[a-z]+(?:'s)?")


@lru_cache(maxsize=1)
def _tables() -> tuple[dict[str, str], frozenset[str]]:
    found = tomllib.loads(Path(__file__).with_name("nouns.toml").read_text(encoding="utf-8"))
    kinds = {noun: kind for kind, nouns in found["nouns"].items() for noun in nouns}
    return kinds, frozenset(found["places"]["floor"])


def kind_of(noun: str) -> str:
    """The kind of thing that a noun names, such as "cup" for "a mug" or "mugs"; "" if it has no shape."""
    for word, kind in reversed(nouns_in(noun)):  # "paper bag" is a bag
        if word:
            return kind
    return ""


def nouns_in(text: str) -> list[tuple[str, str]]:
    """The nouns of a text that have a shape, in order, each with its kind."""
    kinds, _ = _tables()
    return [(word, kinds[word]) for word in map(_singular, _WORD.findall(text.lower())) if word in kinds]


def on_floor(text: str) -> bool:
    """True if a text names the floor or something like it."""
    _, floor = _tables()
    return any(_singular(word) in floor for word in _WORD.findall(text.lower()))


def is_fixture(noun: str | None) -> bool:
    """True for a noun of what stands where it is, such as a window, so that people go to it and face it."""
    return bool(noun) and kind_of(noun or "") in FIXTURES


def thing_of(act: Act, words: str) -> tuple[str, str]:
    """The thing of an act, as its noun and its kind; ("", "") where the words name nothing that has a shape.

    Args:
        act: of a plan.
        words: the text that it was read from.
    """
    if act.thing:
        kind = kind_of(act.thing)
        return (act.thing, kind) if kind else ("", "")
    return next(iter(nouns_in(words)), ("", ""))


def _singular(word: str) -> str:
    kinds, floor = _tables()
    word = word.removesuffix("'s")
    for end, instead in (("", ""), ("ves", "fe"), ("ies", "y"), ("es", ""), ("s", "")):
        if word.endswith(end) and (bare := word[: len(word) - len(end)] + instead) in kinds.keys() | floor:
            return bare
    return word
