"""What the stage is told by the acts that a sentence is read as, as one beat."""

from __future__ import annotations

from collections.abc import Mapping

from acts import read
from acts.shapes import Gesture
from acts.staging.beginnings import placed
from acts.staging.places import Standing
from acts.staging.score import Change, Lift, Move, Score, Strike, Touch
from acts.staging.stage import score_of


def score(words: str) -> Score:
    return score_of(read(words).acts)


def moves(words: str) -> tuple[Move, ...]:
    return score(words).moves


def contact(words: str) -> Touch | None:
    return score(words).touch


def hold(words: str) -> str:
    return score(words).hold


def twirls(words: str) -> str:
    return score(words).twirls


def lift(words: str) -> Lift | None:
    return score(words).lift


def strike(words: str) -> Strike | None:
    return score(words).strike


def gestures(words: str) -> Mapping[str, Gesture]:
    return score(words).gestures


def changes(words: str) -> Mapping[str, tuple[Change, ...]]:
    return score(words).changes


def leaps(words: str) -> Mapping[str, int]:
    return {who: figure.times for who, figure in score(words).figures.items() if figure.figure == "jumps"}


def figures(words: str) -> Mapping[str, tuple[str, int]]:
    return {who: (figure.figure, figure.times) for who, figure in score(words).figures.items()}


def beginning(words: str) -> Standing | None:
    return placed(score(words))


def idle(words: str) -> frozenset[str]:
    return score(words).idle


def gesturing(words: str) -> frozenset[str]:
    return score(words).gesturing


def is_planned(words: str) -> bool:
    return score(words).is_planned
