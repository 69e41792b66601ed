"""Blind studies: copies of the motions of two runs in a folder, and votes on pairs of them."""

from __future__ import annotations

import csv
import hashlib
import json
import random
import secrets
import shutil
import time
from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple, cast

from sqlalchemy import ColumnElement, func, select
from sqlalchemy.exc import IntegrityError
from sqlalchemy.orm import Session

from motion import Duet, InputError, formats
from motion.formats.files import safe_cell
from webdemo.server.accounts.visitors import digest
from webdemo.server.audit import audit
from webdemo.study import FIRST, SECOND, TIE, Pair, StudyEntry, as_shown

from .database import Study, Vote, locked, owned, sentences
from .storage import Storage, sweep

LONGEST_QUESTION, LONGEST_NAME = 300, 100
MOST_VOTES = 20_000
"""Votes of a study: a stranger with ever new cookies could send any number."""
COLUMNS = ("voter", "pair", "sentence", "left", "right", "chosen", "time")
_PRESSED = {"1": FIRST, "2": SECOND, "=": TIE}
"""Keys and their answers where the first run is on the left."""


class Next(NamedTuple):
    """The progress of a voter, and the number and the motions of the next pair, left and right; None after the last."""

    done: int
    total: int
    number: int | None = None
    pair: Pair | None = None


class Studies:
    """Keeps studies. The owner reaches them by their ids, voters by their keys.

    Args:
        storage: knows their rows, counts what people store, and makes room.
        folder: holds a folder of motions a study.
    """

    def __init__(self, storage: Storage, folder: Path) -> None:
        self.storage, self.database, self.folder = storage, storage.database, folder

    def recover(self) -> None:
        """Removes what an earlier process left half-written."""
        sweep(self.database, Study, self.folder)

    # ---- the owner -------------------------------------------------------------------------------

    @sentences()
    def create(
        self, owner: str, question: str, runs: tuple[str, str], pairs: Sequence[Pair], *, address: str = ""
    ) -> StudyEntry:
        """Makes a study of copies of the motions, so that it outlives the runs.

        Where the owner's room is used up, runs of theirs make way (:meth:`.storage.Storage.make_room`).

        Raises:
            InputError: if there is no question, or no room.
        """
        question = " ".join(question.split())
        if not owner:
            raise InputError("There is no history here to make a study in: sign in or allow cookies first.")
        if not 0 < len(question) <= LONGEST_QUESTION:
            raise InputError(f"The question has {len(question)} characters: write 1 to {LONGEST_QUESTION}.")
        motions = [as_shown(motion) for pair in pairs for motion in (pair.first, pair.second)]
        row = Study(id=secrets.token_hex(12), owner=owner, key=secrets.token_urlsafe(18), question=question)
        row.runs, row.created = json.dumps([name[:LONGEST_NAME] for name in runs]), time.time()
        row.captions = json.dumps([pair.caption for pair in pairs])
        row.address = digest(address) if address else ""
        with self.database.session() as session:
            self.storage.check(session, owner, row.address, sum(m.positions.nbytes for m in motions))
        folder, kept = self.folder / row.id, False
        try:
            folder.mkdir(mode=0o700, parents=True)
            for number, motion in enumerate(motions):
                formats.write(motion, folder / f"{number}.npz")
            row.size = sum(path.stat().st_size for path in folder.iterdir()) + len(row.captions)
            with self.database.session.begin() as session:
                locked(session)
                gone = self.storage.make_room(session, owner, row.address, row.size)
                session.add(row)
            kept = True
        except OSError as error:
            raise InputError(f"The study could not be written ({error.strerror}): free some room.") from None
        finally:
            if not kept:
                shutil.rmtree(folder, ignore_errors=True)
        self.storage.drop(gone)
        return _entry(row, [])

    @sentences()
    def mine(self, owner: str) -> Sequence[StudyEntry]:
        """The owner's studies with the count of their votes, newest first."""
        mine = select(Study).where(owned(Study, owner)).order_by(Study.created.desc())
        with self.database.session() as session:
            return [_entry(row, _votes(session, row)) for row in session.scalars(mine).all()]

    @sentences()
    def delete(self, study: str, owner: str) -> None:
        """Deletes a study with its votes and its motions."""
        with self.database.session.begin() as session:
            session.delete(_find(session, Study.id == study, owned(Study, owner)))
        shutil.rmtree(self.folder / study, ignore_errors=True)
        audit("study-deleted", study=study)

    @sentences()
    def export(self, study: str, owner: str, file: Path) -> int:
        """Writes all votes as .csv; returns how many. People are numbers; no cell is what a spreadsheet computes."""
        with self.database.session() as session:
            row = _find(session, Study.id == study, owned(Study, owner))
            votes = _votes(session, row)
        runs, captions = json.loads(row.runs), json.loads(row.captions)
        voters: dict[str, int] = {}
        with file.open("w", newline="", encoding="utf-8") as opened:
            table = csv.writer(opened)
            table.writerow(COLUMNS)
            for vote in votes:
                sides = runs[::-1] if vote.swapped else runs
                chosen = {FIRST: runs[0], SECOND: runs[1]}.get(vote.answer, TIE)
                voter = voters.setdefault(vote.person, len(voters) + 1)
                cells = voter, vote.pair + 1, captions[vote.pair], *sides, chosen, round(vote.at)
                table.writerow(map(safe_cell, cells))
        return len(votes)

    # ---- voters ----------------------------------------------------------------------------------

    @sentences()
    def question(self, key: str) -> str:
        """The question to the people with a link; raises InputError where there is no such study."""
        with self.database.session() as session:
            return _find(session, Study.key == key).question

    @sentences()
    def following(self, key: str, person: str) -> Next:
        """The next pair for a person: each has an order and sides of their own."""
        with self.database.session() as session:
            row = _find(session, Study.key == key)
            voter = _hashed(row, person)
            done = set(session.scalars(select(Vote.pair).where(Vote.study_id == row.id, Vote.person == voter)))
        captions, plan = json.loads(row.captions), _plan(row, voter)
        for number, swapped in plan.items():
            if number not in done:
                files = [self.folder / row.id / f"{2 * number + side}.npz" for side in (swapped, not swapped)]
                left, right = (cast(Duet, formats.read(file)) for file in files)
                return Next(len(done), len(plan), number, Pair(left, right, captions[number]))
        return Next(len(done), len(plan))

    @sentences()
    def vote(self, key: str, person: str, number: int, pressed: str) -> None:
        """Takes an answer to a pair: 1 is the left motion, 2 the right one, = neither.

        Raises:
            InputError: for a pair that there is none, or a second vote on one.
        """
        try:
            with self.database.session.begin() as session:
                row = _find(session, Study.key == key)
                voter = _hashed(row, person)
                answer, swapped = _PRESSED.get(pressed), _plan(row, voter).get(number)
                if answer is None or swapped is None:
                    raise InputError("An answer is 1, 2 or = to a pair of the study: reload the page.")
                if (session.scalar(select(func.count()).where(Vote.study_id == row.id)) or 0) >= MOST_VOTES:
                    raise InputError("This study has all the votes that it takes: thank you all the same.")
                if swapped:
                    answer = {FIRST: SECOND, SECOND: FIRST}.get(answer, answer)
                told = {"answer": answer, "swapped": swapped, "at": time.time()}
                session.add(Vote(study_id=row.id, person=voter, pair=number, **told))
        except IntegrityError:
            raise InputError("You have voted on this pair already: one vote for each pair counts.") from None


def _hashed(row: Study, person: str) -> str:
    """A name for a person that says nothing outside of the study."""
    return hashlib.sha256(f"{row.id} {person}".encode()).hexdigest()


def _plan(row: Study, voter: str) -> dict[int, bool]:
    """The numbers of the pairs in a voter's order, and whether the second run is on the left."""
    draw = random.Random(f"{row.id} {voter}")
    numbers = list(range(len(json.loads(row.captions))))
    draw.shuffle(numbers)
    return {number: draw.random() < 0.5 for number in numbers}


def _find(session: Session, *where: ColumnElement[bool]) -> Study:
    row = session.scalar(select(Study).where(*where))
    if row is None:
        raise InputError("There is no such study, or it was deleted: ask for its link, or reload the page.")
    return row


def _votes(session: Session, row: Study) -> Sequence[Vote]:
    return session.scalars(select(Vote).where(Vote.study_id == row.id).order_by(Vote.at)).all()


def _entry(row: Study, votes: Sequence[Vote]) -> StudyEntry:
    first, second = json.loads(row.runs)
    answers = Counter(vote.answer for vote in votes)
    entry = StudyEntry(row.id, row.key, row.question, (first, second), len(json.loads(row.captions)))
    wins, voters = (answers[FIRST], answers[SECOND]), len({vote.person for vote in votes})
    return replace(entry, wins=wins, ties=answers[TIE], voters=voters)
