"""The interface of the blind studies as the page uses it; the server keeps them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Protocol

from webdemo.study import Stimulus, StudyResult


@dataclass(frozen=True, kw_only=True)
class NewStudy:
    """A study that is to be made.

    Attributes:
        question: that people answer for every pair.
        title: the owner's name for it; the question by default.
        sets: what is compared, by name.
        checks: attention checks for every person.
        pairs_each: pairs that a person is shown, without the checks; 0 for all.
        shows_sentence: whether the sentence of a pair stands above it.
        shows_result: whether a person sees the result after the last pair.
    """

    question: str
    title: str = ""
    sets: Mapping[str, Sequence[Stimulus]] = field(repr=False)
    checks: int = 2
    pairs_each: int = 0
    shows_sentence: bool = True
    shows_result: bool = False


@dataclass(frozen=True, kw_only=True)
class StudyEntry:
    """A study as its owner sees it.

    Attributes:
        id: by which its owner opens it.
        key: of the link by which people vote.
        title: of the study.
        question: that people answer.
        sets: names of what is compared.
        pairs: how many, without attention checks.
        checks: attention checks for every person.
        closed: nobody can vote any more.
        created: seconds since 1970.
        raters: people who have voted on a pair or more.
        votes: answers so far, with checks and skips.
    """

    id: str
    key: str
    title: str
    question: str
    sets: tuple[str, ...]
    pairs: int
    checks: int
    closed: bool
    created: float
    raters: int
    votes: int


class StudiesLike(Protocol):
    """Blind studies. Every method raises InputError with a sentence where it cannot."""

    def create(self, owner: str, study: NewStudy, *, address: str = "") -> StudyEntry:
        """Makes a study of copies of the motions; ``address`` is that of a person known by a cookie alone."""

    def mine(self, owner: str) -> Sequence[StudyEntry]:
        """The owner's studies, newest first."""

    def result(self, study: str, owner: str, person: str = "") -> StudyResult:
        """The count of all answers; hidden from an owner who is voting and has not finished."""

    def close(self, study: str, owner: str, *, closed: bool) -> None:
        """Ends the voting, or opens it again."""

    def delete(self, study: str, owner: str) -> None:
        """Deletes a study with its votes."""

    def export(self, study: str, owner: str, file: Path, person: str = "") -> int:
        """Writes all votes as .csv; returns how many. Hidden as :meth:`result` is."""
