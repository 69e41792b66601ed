"""Stories: beats that follow each other, as ``stories.txt`` lists them."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path

Pair = tuple[str, str]
"""The cues of A and B in one beat."""


@cache
def stories() -> tuple[tuple[Pair, ...], ...]:
    """All stories, each a pair of cues a beat, in the order of the alphabet."""
    text = Path(__file__).with_name("stories.txt").read_text(encoding="utf-8")
    found: set[str] = set()
    for line in re.sub(r"\n +", " ", text).splitlines():
        beat, _, later = line.partition(" ; ")
        if line.startswith("#"):
            continue
        if later:
            found |= {beat, *(f"{beat} ; {rest}" for rest in later.split(" | "))}
            continue
        own, _, answers = beat.partition(" / ")
        found |= {own if answer in ("", own) else f"{own} / {answer}" for answer in answers.split(" | ")}
    return tuple(map(pattern, sorted(found)))


def pattern(text: str) -> tuple[Pair, ...]:
    """ "walk-up / stand-still ; hug" -> (("walk-up", "stand-still"), ("hug", "hug"))."""
    beats = []
    for beat in text.split(" ; "):
        one, _, other = beat.partition(" / ")
        beats.append((one, other or one))
    return tuple(beats)
