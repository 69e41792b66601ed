"""Blind studies: copies of motions in a folder, pairs that are shown in random order and side, and votes."""

from __future__ import annotations

import json
import os
import secrets
import shutil
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

from sqlalchemy import delete, func, select
from sqlalchemy.orm import Session

from motion import Clip, Duet, InputError, formats
from motion.formats.files import replacing
from webdemo.server.accounts.visitors import digest
from webdemo.server.audit import audit
from webdemo.study import Pair, StudyResult, matched_pairs, tally
from webdemo.study.pairs import as_shown, check_sources, shuffled
from webdemo.study.results import FIRST, write_votes
from webdemo.ui.studies import NewStudy, StudyEntry

from .database import Ballot, Rater, Study, sentences
from .ledger import locked
from .voting import Voting, answered_of, pairs_of, plan_of, rater_of, votes_of

LONGEST_QUESTION, LONGEST_NAME = 300, 100
LONGEST_MOTION = 60.0
"""Seconds."""
MOST_STUDIES = 30
"""Of one owner."""
_NOT_MINE = "There is no such study of yours: reload the page."


class Studies(Voting):
    """Keeps studies; see :class:`Voting` for its arguments."""

    # ---- the owner -------------------------------------------------------------------------------

    @sentences()
    def create(self, owner: str, study: NewStudy, *, address: str = "") -> StudyEntry:
        """Makes a study of copies of the motions, so that it outlives the runs.

        Where the owner's room is used up, runs of theirs make way (:meth:`.storage.Storage.make_room`).

        Raises:
            InputError: if there are no pairs, or too many, or no question, or no room.
        """
        if not owner:
            raise InputError("There is no history here to make a study in: sign in or allow cookies first.")
        names, question = _checked(study)
        pairs = matched_pairs(list(study.sets.values()))
        motions: list[Duet | Clip] = [each.motion for given in study.sets.values() for each in given]
        if max(motion.seconds for motion in motions) > LONGEST_MOTION:
            raise InputError(f"Motions of a study last {LONGEST_MOTION:g} s at most: cut them first.")
        motions = [as_shown(motion) for motion in motions]
        count = len(pairs)
        for i, source in enumerate(check_sources(pairs, study.checks, seed=secrets.randbits(32))):
            chosen, where = source.motions[0], source.sets[0]
            pairs.append(Pair((where, where), (chosen, len(motions)), source.caption, known=FIRST))
            motions.append(shuffled(motions[chosen], seed=i))
        row = Study(
            # Hexadecimal, since people type it in a shell, where a word that begins with "-" is an option.
            id=secrets.token_hex(12), owner=owner, key=secrets.token_urlsafe(18), question=question,
            title=" ".join(study.title.split())[:LONGEST_NAME] or question[:LONGEST_NAME], sets=json.dumps(names),
            pairs=json.dumps([asdict(pair) for pair in pairs]), shows_sentence=study.shows_sentence,
            pairs_each=min(study.pairs_each or count, count), shows_result=study.shows_result,
            created=self.clock(), address=digest(address) if address else "",
        )  # fmt: skip
        with self.database.session() as session:
            self._check_number(session, owner)
            size = sum(motion.positions.nbytes for motion in motions)
            self.storage.check(session, owner, row.address, size)
        row.size = self._write(row.id, motions) + len(row.pairs)
        try:
            with self.database.session.begin() as session:
                locked(session)
                gone = self.storage.make_room(session, owner, row.address, row.size)
                session.add(row)
        except BaseException:
            shutil.rmtree(self.folder / row.id, ignore_errors=True)
            raise
        self.storage.drop(gone)
        return _entry(row, 0, 0)

    @sentences()
    def mine(self, owner: str) -> Sequence[StudyEntry]:
        """The owner's studies, newest first."""
        with self.database.session() as session:
            rows = session.scalars(select(Study).where(Study.owner == owner).order_by(Study.created.desc()))
            return [_entry(row, *_counts(session, row.id)) for row in rows] if owner else []

    @sentences()
    def everybodys(self) -> Sequence[tuple[str, StudyEntry]]:
        """All studies with their owners, newest first, for the person who runs the lab."""
        with self.database.session() as session:
            rows = session.scalars(select(Study).order_by(Study.created.desc()))
            return [(row.owner, _entry(row, *_counts(session, row.id))) for row in rows]

    @sentences()
    def result(self, study: str, owner: str, person: str = "") -> StudyResult:
        """The count of all answers.

        Raises:
            InputError: as well while the owner, as ``person``, has voted on some of the pairs and not on all.
        """
        with self.database.session() as session:
            row = self._own(session, study, owner)
            self._check_finished(session, row, person)
            return tally(json.loads(row.sets), pairs_of(row), votes_of(session, row.id))

    @sentences()
    def close(self, study: str, owner: str, *, closed: bool) -> None:
        """Ends the voting, or opens it again."""
        with self.database.session.begin() as session:
            self._own(session, study, owner).closed = closed

    @sentences()
    def delete(self, study: str, owner: str) -> None:
        """Deletes a study with its votes and its motions."""
        with self.database.session.begin() as session:
            row = self._own(session, study, owner)
            raters = select(Rater.id).where(Rater.study_id == row.id)
            session.execute(delete(Ballot).where(Ballot.rater_id.in_(raters)))
            session.execute(delete(Rater).where(Rater.study_id == row.id))
            session.delete(row)
        shutil.rmtree(self.folder / study, ignore_errors=True)
        audit("study-deleted", study=study)

    @sentences()
    def export(self, study: str, owner: str, file: Path, person: str = "") -> int:
        """Writes all votes as .csv; returns how many. Hidden as :meth:`result` is."""
        with self.database.session() as session:
            row = self._own(session, study, owner)
            self._check_finished(session, row, person)
            votes = votes_of(session, row.id)
            sets, pairs = json.loads(row.sets), pairs_of(row)
        with replacing(file) as temporary:
            write_votes(sets, pairs, votes, temporary)
        return len(votes)

    # ---- parts -----------------------------------------------------------------------------------

    @staticmethod
    def _check_number(session: Session, owner: str) -> None:
        count = session.scalar(select(func.count()).select_from(Study).where(Study.owner == owner)) or 0
        if count >= MOST_STUDIES:
            raise InputError(f"You have {count} studies already: delete one first.")

    def _check_finished(self, session: Session, row: Study, person: str) -> None:
        rater = rater_of(session, row, person) if person else None
        if rater is None:
            return
        done, total = len(answered_of(session, rater)), len(plan_of(rater))
        if 0 < done < total:
            raise InputError(
                f"You vote in this study yourself: its result is hidden until your last pair, {done} of {total} done."
            )

    def _own(self, session: Session, study: str, owner: str) -> Study:
        row = session.get(Study, study)
        if row is None or not owner or row.owner != owner:
            raise InputError(_NOT_MINE)
        return row

    def _write(self, study: str, motions: Sequence[Duet | Clip]) -> int:
        half = self.folder / f".{study}"
        try:
            half.mkdir(mode=0o700, parents=True)
            for number, motion in enumerate(motions):
                formats.write(motion, half / f"{number}.npz")
            size = sum(path.stat().st_size for path in half.iterdir())
            os.replace(half, self.folder / study)
        except OSError as error:
            shutil.rmtree(half, ignore_errors=True)
            raise InputError(
                f"The study could not be written ({error.strerror}): tell the person who runs this server."
            ) from None
        return size


def _checked(study: NewStudy) -> tuple[list[str], str]:
    """The names of the sets and the question; raises InputError for ones that do not fit."""
    question = " ".join(study.question.split())
    if not question:
        raise InputError("The study has no question: write what people are to decide.")
    if len(question) > LONGEST_QUESTION:
        raise InputError(
            f"The question has {len(question)} characters: shorten it to {LONGEST_QUESTION} or fewer."
        )
    if study.pairs_each < 0:
        raise InputError("Give 0 or more pairs for each person; 0 stands for all.")
    names = [name[:LONGEST_NAME] for name in study.sets]
    if len(set(names)) < len(names):
        raise InputError("Two sets have the same name: give each its own.")
    if empty := [name for name, given in study.sets.items() if not given]:
        raise InputError(f"The set {empty[0][:LONGEST_NAME]!r} has no motions: choose some for it.")
    return names, question


def _counts(session: Session, study: str) -> tuple[int, int]:
    counts = select(func.count(func.distinct(Ballot.rater_id)), func.count()).join(
        Rater, Rater.id == Ballot.rater_id
    )
    people, votes = session.execute(counts.where(Rater.study_id == study, Ballot.answer != "")).one()
    return people, votes


def _entry(row: Study, raters: int, votes: int) -> StudyEntry:
    pairs = pairs_of(row)
    checks = sum(bool(pair.known) for pair in pairs)
    return StudyEntry(
        id=row.id, key=row.key, title=row.title, question=row.question, sets=tuple(json.loads(row.sets)),
        pairs=len(pairs) - checks, checks=checks, closed=row.closed, created=row.created, raters=raters, votes=votes,
    )  # fmt: skip
