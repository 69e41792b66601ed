"""Reads the phrases and sentences; see the heads of the files for their notation."""

from __future__ import annotations

import re
from collections import defaultdict
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

FOLDER = Path(__file__).parent
Pair = tuple[str, str]


@dataclass
class Phrases:
    """Words for one act.

    Attributes:
        does: verb phrases of one person.
        both: of the two together, in the plural.
        echo: of who does as the other did.
        nouns: keywords.
    """

    does: list[str] = field(default_factory=list)
    both: list[str] = field(default_factory=list)
    echo: list[str] = field(default_factory=list)
    nouns: list[str] = field(default_factory=list)


@cache
def phrases() -> dict[str, Phrases]:
    """The phrases of ``acts.txt`` by act."""
    found: dict[str, Phrases] = {}
    kinds = {"&": "both", "^": "echo", "=": "nouns", "*": "does"}
    for line in _lines(FOLDER / "acts.txt"):
        if line.startswith("== "):
            entry = found.setdefault(line[3:], Phrases())
            continue
        kind = kinds.get(line[0], "does")
        getattr(entry, kind).append(line if kind == "does" else line[2:])
    return found


@cache
def sentences() -> dict[tuple[Pair, ...], list[str]]:
    """Sentences by the beats they tell, each (act of A, act of B); "*" stands for any act."""
    found: dict[tuple[Pair, ...], list[str]] = defaultdict(list)
    for path in sorted((FOLDER / "sentences").glob("*.txt")):
        keys: list[tuple[Pair, ...]] = []
        for line in _lines(path):
            if line.startswith("== "):
                keys = [pattern(part) for part in line[3:].split(" | ")]
                continue
            for key in keys:
                found[key].append(line)
    return dict(found)


ANSWERS = {"push": "stumble", "hand-over": "take", "tap": "turn-to", "throw-to": "catch", "punch-at": "recoil",
           "kick-at": "step-back", "help-up": "get-up", "whisper": "listen", "hug": "hug", "walk-past": "walk-past",
           "chase": "run-away", "follow": "walk-away"}  # fmt: skip
"""What the other does where a sentence only says that somebody does this."""


def pattern(text: str) -> tuple[Pair, ...]:
    """ "walk-up / stand ; hug" -> (("walk-up", "stand"), ("hug", "hug")).

    An act by itself is done by both; " / " parts what A and what B does, " ; " one beat from the next.
    """
    beats = []
    for beat in text.split(";"):
        one, _, other = (part.strip() for part in beat.partition("/"))
        pair = (one, other or one)
        if pair[0] == "stand":
            pair = (ANSWERS.get(pair[1], "stand"), pair[1])
        elif pair[1] == "stand":
            pair = (pair[0], ANSWERS.get(pair[0], "stand"))
        beats.append(pair)
    return tuple(beats)


def _lines(path: Path) -> list[str]:
    return [
        line.strip()
        for line in path.read_text(encoding="utf-8").splitlines()
        if line.strip() and not line.startswith("# ")
    ]


def count() -> tuple[int, int]:
    """(sentences written by hand, verb phrases)."""
    written = {line for lines in sentences().values() for line in lines}
    return len(written), sum(len(p.does) + len(p.both) + len(p.echo) for p in phrases().values())


_OPTION = re.compile(r"\[([^\[\]]*)\]")


def options(text: str, keep: bool) -> str:
    """With or without what stands in brackets."""
    return _OPTION.sub(r"\1" if keep else "", text)
