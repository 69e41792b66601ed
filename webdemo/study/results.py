"""Results of a study: wins of each set, agreement between people, and inattentive voters."""

from __future__ import annotations

import csv
from collections import Counter, defaultdict
from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from pathlib import Path
from typing import Any

from motion.formats.spreadsheet import safe_cell

from .pairs import Pair
from .statistics import krippendorff_alpha, pairwise_agreement, sign_test, wilson_interval

FIRST, SECOND, TIE, SKIP = ANSWERS = ("first", "second", "tie", "skip")
PASS_SHARE = 2 / 3
"""Share of the attention checks that a rater was shown which must be right for the votes to count."""


@dataclass(frozen=True)
class Vote:
    """One person's answer to one pair.

    Attributes:
        rater: number of the person, from 1.
        pair: number of the pair.
        answer: one of :data:`ANSWERS`; first and second are those of the pair, wherever they were shown.
        swapped: the second one was shown on the left.
        seconds: between the pair's being sent and the answer.
        at: when, in seconds since 1970.
    """

    rater: int
    pair: int
    answer: str
    swapped: bool = False
    seconds: float = 0.0
    at: float = 0.0

    @property
    def side(self) -> str:
        """The pressed answer: left, right, tie or skip."""
        if self.answer not in (FIRST, SECOND):
            return self.answer
        return "right" if (self.answer == SECOND) != self.swapped else "left"


@dataclass(frozen=True)
class Comparison:
    """One set against another.

    Attributes:
        sets: their names.
        wins: votes for the first.
        losses: votes for the second.
        ties: votes for neither.
        skips: answers withheld.
    """

    sets: tuple[str, str]
    wins: int
    losses: int
    ties: int
    skips: int

    @property
    def share(self) -> float | None:
        """Wins among the votes for either; None without any."""
        decided = self.wins + self.losses
        return self.wins / decided if decided else None

    @property
    def interval(self) -> tuple[float, float]:
        """The Wilson interval of :attr:`share` at 95 %."""
        return wilson_interval(self.wins, self.wins + self.losses)

    @property
    def p_value(self) -> float:
        """Of the exact sign test."""
        return sign_test(self.wins, self.wins + self.losses)


@dataclass(frozen=True)
class StudyResult:
    """The state of a study.

    Attributes:
        comparisons: every set against every other.
        raters: people whose votes count.
        excluded: people whose votes do not, since they failed the attention checks.
        votes: answers that count, without checks and skips.
        alpha: Krippendorff's alpha for nominal data over the pairs; None where it is not defined.
        agreement: share of pairs of raters who gave a pair the same answer; None where no pair has two votes.
    """

    comparisons: tuple[Comparison, ...]
    raters: int
    excluded: int
    votes: int
    alpha: float | None
    agreement: float | None

    def to_dict(self) -> dict[str, Any]:
        """Plain numbers, for JSON."""
        return {
            "raters": self.raters, "excluded": self.excluded, "votes": self.votes,
            "krippendorff_alpha": self.alpha, "pairwise_agreement": self.agreement,
            "comparisons": [
                {"first": each.sets[0], "second": each.sets[1], "wins": each.wins, "losses": each.losses,
                 "ties": each.ties, "skips": each.skips, "share": each.share, "low": each.interval[0],
                 "high": each.interval[1], "p_value": each.p_value}
                for each in self.comparisons
            ],
        }  # fmt: skip


def inattentive(pairs: Sequence[Pair], votes: Sequence[Vote]) -> set[int]:
    """The raters who failed too many of the attention checks that they were shown."""
    right: defaultdict[int, list[bool]] = defaultdict(list)
    for vote in votes:
        if known := pairs[vote.pair].known:
            right[vote.rater].append(vote.answer == known)
    return {rater for rater, each in right.items() if sum(each) < PASS_SHARE * len(each)}


def tally(sets: Sequence[str], pairs: Sequence[Pair], votes: Sequence[Vote]) -> StudyResult:
    """Counts votes.

    Args:
        sets: names of the sets.
        pairs: all pairs of the study, attention checks among them.
        votes: all answers.
    """
    out = inattentive(pairs, votes)
    counted = [vote for vote in votes if vote.rater not in out and not pairs[vote.pair].known]
    found: defaultdict[tuple[int, int], Counter[str]] = defaultdict(Counter)
    units: defaultdict[int, list[Hashable]] = defaultdict(list)
    for vote in counted:
        found[pairs[vote.pair].sets][vote.answer] += 1
        if vote.answer != SKIP:
            units[vote.pair].append(vote.answer)
    shown = {pair.sets for pair in pairs if not pair.known}
    values = list(units.values())
    return StudyResult(
        comparisons=tuple(
            Comparison((sets[i], sets[j]), *(found[i, j][answer] for answer in ANSWERS))
            for i, j in combinations(range(len(sets)), 2)
            if (i, j) in shown
        ),
        raters=len({vote.rater for vote in votes} - out),
        excluded=len(out),
        votes=sum(map(len, values)),
        alpha=krippendorff_alpha(values),
        agreement=pairwise_agreement(values),
    )


HEADS = (
    "rater", "pair", "sentence", "first", "second", "left", "right", "pressed", "chosen", "attention_check",
    "check_passed", "rater_counts", "seconds", "time",
)  # fmt: skip


def write_votes(sets: Sequence[str], pairs: Sequence[Pair], votes: Sequence[Vote], path: Path) -> None:
    """Writes a row a vote as .csv; raters are numbers.

    Cells that a spreadsheet would compute begin with an apostrophe.
    """
    out = inattentive(pairs, votes)
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, HEADS)
        writer.writeheader()
        for vote in votes:
            writer.writerow({name: safe_cell(value) for name, value in _row(sets, pairs, vote, out).items()})


def _row(sets: Sequence[str], pairs: Sequence[Pair], vote: Vote, out: set[int]) -> Mapping[str, Any]:
    pair = pairs[vote.pair]
    names = [sets[number] for number in pair.sets]
    if pair.known:
        names = [name if side == pair.known else f"{name}, shuffled"
                 for name, side in zip(names, (FIRST, SECOND), strict=True)]  # fmt: skip
    left, right = reversed(names) if vote.swapped else names
    chosen = {FIRST: names[0], SECOND: names[1]}.get(vote.answer, vote.answer)
    return {
        "rater": vote.rater, "pair": vote.pair + 1, "sentence": pair.caption, "first": names[0],
        "second": names[1], "left": left, "right": right, "pressed": vote.side, "chosen": chosen,
        "attention_check": "yes" if pair.known else "no",
        "check_passed": ("yes" if vote.answer == pair.known else "no") if pair.known else "",
        "rater_counts": "no" if vote.rater in out else "yes", "seconds": f"{vote.seconds:.1f}",
        "time": f"{vote.at:.0f}",
    }  # fmt: skip
