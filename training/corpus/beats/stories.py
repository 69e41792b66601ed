"""Stories: beats that follow each other, as ``stories.txt`` lists them."""

from __future__ import annotations

from functools import cache
from pathlib import Path

Pair = tuple[str, str]
"""The cues of A and B in one beat."""


@cache
def stories() -> tuple[tuple[Pair, ...], ...]:
    """All stories, each a pair of cues a beat."""
    lines = Path(__file__).with_name("stories.txt").read_text(encoding="utf-8").splitlines()
    return tuple(pattern(line) for line in lines if line.strip() and not line.startswith("#"))


def pattern(text: str) -> tuple[Pair, ...]:
    """ "walk-up / stand-still ; hug" -> (("walk-up", "stand-still"), ("hug", "hug")).

    A cue by itself is done by both; " / " parts what A and what B does, " ; " one beat from the next.
    """
    beats = []
    for beat in text.split(" ; "):
        one, _, other = (part.strip() for part in beat.partition(" / "))
        beats.append((one, other or one))
    return tuple(beats)
