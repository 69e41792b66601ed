"""Blind studies of two runs: what voters see, and how their votes are counted."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from motion import Duet, InputError, stacked_positions
from motion.transforms import resample, turn
from motion.vectors import FLAT, heading_of

FIRST, SECOND, TIE = "first", "second", "tie"
MOST_PAIRS = 100
FPS = 30.0
"""Frames a second at which every motion of a study is shown: a different rate would tell its origin."""


@dataclass(frozen=True)
class Pair:
    """Two motions side by side, and the sentence of both; voters see none where they have different ones."""

    first: Duet = field(repr=False)
    second: Duet = field(repr=False)
    caption: str = ""


@dataclass(frozen=True)
class StudyEntry:
    """A study as its owner sees it: ``key`` is in its link, ``wins`` are votes for each of its ``runs``."""

    id: str
    key: str
    question: str
    runs: tuple[str, str]
    pairs: int
    wins: tuple[int, int] = (0, 0)
    ties: int = 0
    voters: int = 0


def paired(first: Sequence[tuple[str, Duet]], second: Sequence[tuple[str, Duet]]) -> list[Pair]:
    """Sentences and motions of two runs beside each other, in their order, as far as both have one.

    Raises:
        InputError: for none or too many, or motions that cannot be compared.
    """
    pairs = [
        Pair(ours, theirs, said if said == also else "")
        for (said, ours), (also, theirs) in zip(first, second, strict=False)
    ]
    if not 0 < len(pairs) <= MOST_PAIRS:
        raise InputError(f"A study has 1 to {MOST_PAIRS} pairs of motions, not {len(pairs)}: choose other runs.")
    if any(pair.first.skeleton.joint_names != pair.second.skeleton.joint_names for pair in pairs):
        raise InputError("These runs have different joints, so they cannot be compared: choose others.")
    return pairs


def as_shown(motion: Duet) -> Duet:
    """A motion without what would tell its origin: at :data:`FPS`, in the middle, turned the same way, no names.

    The first frame decides where the middle is; the two people stand along the Z axis in it.
    """
    people = np.stack([resample(person, motion.fps, FPS) for person in stacked_positions(motion)])
    start = people[:, 0, 0]
    line = start[1] - start[0]
    people = turn(people - start.mean(axis=0) * FLAT, -float(heading_of(line)))
    return Duet.from_positions(people, fps=FPS, skeleton=motion.skeleton)
