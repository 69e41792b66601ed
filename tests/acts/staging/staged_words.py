"""What the stage is told by the acts that a sentence is read as, as one beat."""

from __future__ import annotations

from collections.abc import Mapping

from acts import read
from acts.staging.beginnings import placed
from acts.staging.places import Standing
from acts.staging.score import Score
from acts.staging.stage import score_of


def score(words: str) -> Score:
    return score_of(read(words).acts)


def figures(words: str) -> Mapping[str, tuple[str, int]]:
    return {who: (figure.figure, figure.times) for who, figure in score(words).figures.items()}


def beginning(words: str) -> Standing | None:
    return placed(score(words))
