"""The people who vote in blind studies: pairs in random order and side, one answer to each."""

from __future__ import annotations

import hashlib
import json
import random
import secrets
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast

from sqlalchemy import ColumnElement, CursorResult, func, select, update
from sqlalchemy.exc import IntegrityError
from sqlalchemy.orm import Session

from motion import Clip, Duet, InputError, formats
from webdemo.study import Pair, StudyResult, Vote, tally
from webdemo.study.results import ANSWERS, FIRST, SECOND, SKIP, TIE

from .database import Ballot, Database, Rater, Study, sentences
from .storage import Storage

SOONEST = 1.5
"""Seconds after a pair was sent before which no person can have seen it."""
_ANSWERED = {"1": FIRST, "2": SECOND, "=": TIE, "skip": SKIP}
"""Pressed keys and the answers that they stand for where nothing is swapped."""
_MISSING = "There is no such study, or it was deleted: ask the person who invited you."
_CLOSED = "This study is closed: nobody can vote any more."


@dataclass(frozen=True)
class Invitation:
    """The progress of a person who was invited.

    Attributes:
        question: to be answered.
        total: pairs that the person is shown, attention checks among them.
        done: answers that the person gave.
        result: after the last answer, if the owner shows it.
    """

    question: str
    total: int
    done: int
    result: StudyResult | None = None


@dataclass(frozen=True)
class Shown:
    """A pair on its way to a person.

    Attributes:
        ticket: comes back with the answer.
        left: the motion on the left.
        right: the motion on the right.
        caption: their sentence; empty where the owner hides it or they have different ones.
        wait: seconds until an answer is taken.
    """

    ticket: str
    left: Duet | Clip
    right: Duet | Clip
    caption: str
    wait: float


class Voting:
    """The part of :class:`webdemo.server.store.studies.Studies` that people with the link use.

    Args:
        database: where their rows are.
        folder: holds a folder of motions a study.
        storage: counts what people store, and makes room; by default with no limit for one person.
        address_people: people who may vote from one address where strangers are known by a cookie.
        clock: gives seconds since 1970.
    """

    def __init__(
        self, database: Database, folder: Path, *, storage: Storage | None = None, address_people: int = 60,
        clock: Callable[[], float] = time.time,
    ) -> None:  # fmt: skip
        self.database, self.folder, self.clock = database, folder, clock
        self.storage, self.address_people = storage or Storage(database, folder), address_people

    @sentences()
    def invitation(self, key: str, person: str) -> Invitation:
        """The question, and how far a person is; the result after the last answer, if the owner shows it."""
        with self.database.session() as session:
            row = self._invited(session, key)
            rater = rater_of(session, row, person)
            plan = plan_of(rater) if rater is not None else []
            done = len(answered_of(session, rater)) if rater is not None else 0
            checks = sum(bool(pair.known) for pair in pairs_of(row))
            finished = bool(plan) and done == len(plan)
            shown = (
                tally(json.loads(row.sets), pairs_of(row), votes_of(session, row.id)) if finished else None
            )
            return Invitation(
                row.question, len(plan) or row.pairs_each + checks, done, shown if row.shows_result else None
            )

    def hand_out(self, key: str, person: str, address: str = "") -> Shown | None:
        """The next pair for a person; None after the last. A pair without an answer is sent again.

        Raises:
            InputError: if the study is closed, or too many people vote from the address.
        """
        with sentences():
            try:
                return self._hand_out(key, person, address)
            except IntegrityError:  # the same person asks twice at once: the other one made the rows
                return self._hand_out(key, person, address)

    @sentences()
    def vote(self, key: str, person: str, ticket: str, pressed: str) -> None:
        """Takes an answer: 1 is the left motion, 2 the right one, = neither, or skip.

        Raises:
            InputError: for a pair that was not sent to this person, a second vote, or one that comes before the
                pair can have been seen.
        """
        if pressed not in _ANSWERED:
            raise InputError("An answer is 1, 2, = or skip: reload the page.")
        now = self.clock()
        with self.database.session.begin() as session:
            row = self._invited(session, key)
            if row.closed:
                raise InputError(_CLOSED)
            rater = rater_of(session, row, person)
            sent: list[ColumnElement[bool]] = [
                Ballot.ticket == ticket,
                Ballot.rater_id == (rater.id if rater else -1),
            ]
            ballot = session.scalar(select(Ballot).where(*sent))
            if ballot is None:
                raise InputError(
                    "This pair was not sent to you: open the study's link in a browser and vote there."
                )
            if ballot.answer:
                raise InputError("You have voted on this pair already: one vote for each pair counts.")
            if now - ballot.shown < SOONEST:
                raise InputError("This vote came before the pair can have been seen: watch it first.")
            answer = _ANSWERED[pressed]
            if ballot.swapped:
                answer = {FIRST: SECOND, SECOND: FIRST}.get(answer, answer)
            done = session.execute(
                update(Ballot).where(*sent, Ballot.answer == "").values(answer=answer, answered=now)
            )
            if not cast(CursorResult[Any], done).rowcount:
                raise InputError("You have voted on this pair already: one vote for each pair counts.")

    # ---- parts -----------------------------------------------------------------------------------

    def _hand_out(self, key: str, person: str, address: str) -> Shown | None:
        with self.database.session.begin() as session:
            row = self._invited(session, key)
            rater = rater_of(session, row, person)
            if rater is None:
                if row.closed:
                    raise InputError(_CLOSED)
                rater = self._new_rater(session, row, person, address)
            sent = session.scalars(select(Ballot).where(Ballot.rater_id == rater.id))
            seen = {ballot.pair: ballot for ballot in sent}
            left = [number for number in plan_of(rater) if number not in seen or not seen[number].answer]
            if not left:
                return None
            if row.closed:
                raise InputError(_CLOSED)
            ballot = seen.get(left[0])
            if ballot is None:
                ballot = Ballot(
                    rater_id=rater.id, pair=left[0], ticket=secrets.token_urlsafe(18),
                    swapped=bool(secrets.randbits(1)), shown=self.clock(),
                )  # fmt: skip
                session.add(ballot)
                session.flush()
            pair = pairs_of(row)[ballot.pair]
            study, caption = row.id, pair.caption if row.shows_sentence else ""
            ticket, swapped, wait = ballot.ticket, ballot.swapped, ballot.shown + SOONEST - self.clock()
        first, second = (self._read(study, number) for number in pair.motions)
        return Shown(
            ticket, second if swapped else first, first if swapped else second, caption, max(wait, 0.0)
        )

    def _new_rater(self, session: Session, row: Study, person: str, address: str) -> Rater:
        """Draws the order of the pairs for a person; the pairs with the fewest votes are shown to the next people."""
        hashed = _hashed(row.id, address) if address else ""
        if hashed:
            people = session.scalar(
                select(func.count())
                .select_from(Rater)
                .where(Rater.study_id == row.id, Rater.address == hashed)
            )
            if (people or 0) >= self.address_people:
                raise InputError(
                    f"{people} people vote in this study from your network already, more are not let in: ask the "
                    "person who invited you."
                )
        pairs = pairs_of(row)
        shown = select(Ballot.pair, func.count()).join(Rater, Rater.id == Ballot.rater_id)
        counts = dict(
            session.execute(shown.where(Rater.study_id == row.id).group_by(Ballot.pair)).tuples().all()
        )
        draw = random.SystemRandom()
        real = [number for number, pair in enumerate(pairs) if not pair.known]
        draw.shuffle(real)
        chosen = sorted(real, key=lambda number: counts.get(number, 0))[: row.pairs_each]
        plan = chosen + [number for number, pair in enumerate(pairs) if pair.known]
        draw.shuffle(plan)
        rater = Rater(study_id=row.id, person=_hashed(row.id, person), address=hashed, plan=json.dumps(plan))
        session.add(rater)
        session.flush()
        return rater

    @staticmethod
    def _invited(session: Session, key: str) -> Study:
        row = session.scalar(select(Study).where(Study.key == key))
        if row is None:
            raise InputError(_MISSING)
        return row

    def _read(self, study: str, number: int) -> Duet | Clip:
        try:
            return formats.read(self.folder / study / f"{number}.npz")
        except (OSError, ValueError):
            raise InputError("The motions of this study are gone: tell the person who invited you.") from None


def _hashed(study: str, person: str) -> str:
    """A name for a person or an address that says nothing outside of the study."""
    return hashlib.sha256(f"{study} {person}".encode()).hexdigest()


def rater_of(session: Session, row: Study, person: str) -> Rater | None:
    """The row of a person in a study; None before the first pair."""
    return session.scalar(
        select(Rater).where(Rater.study_id == row.id, Rater.person == _hashed(row.id, person))
    )


def plan_of(rater: Rater) -> list[int]:
    """The numbers of the pairs that a rater is shown, in their order."""
    return json.loads(rater.plan)


def answered_of(session: Session, rater: Rater) -> Sequence[int]:
    """The numbers of the pairs that a rater has answered."""
    return session.scalars(select(Ballot.pair).where(Ballot.rater_id == rater.id, Ballot.answer != "")).all()


def pairs_of(row: Study) -> list[Pair]:
    """All pairs of a study, attention checks last."""
    return [
        Pair(tuple(each["sets"]), tuple(each["motions"]), each["caption"], each["known"])
        for each in json.loads(row.pairs)
    ]


def votes_of(session: Session, study: str) -> list[Vote]:
    """All answers to a study; raters are numbered in the order of their arrival."""
    query = (
        select(Ballot).join(Rater, Rater.id == Ballot.rater_id)
        .where(Rater.study_id == study, Ballot.answer.in_(ANSWERS)).order_by(Ballot.rater_id, Ballot.answered)
    )  # fmt: skip
    found = list(session.scalars(query))
    numbers = {
        rater: number for number, rater in enumerate(dict.fromkeys(b.rater_id for b in found), start=1)
    }
    return [
        Vote(numbers[b.rater_id], b.pair, b.answer, b.swapped, b.answered - b.shown, b.answered)
        for b in found
    ]
