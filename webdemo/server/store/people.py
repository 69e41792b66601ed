"""Roles, rooms and suspensions of accounts, what each person has computed, and the announcement to everybody."""

from __future__ import annotations

import threading
from typing import Any, cast

from sqlalchemy import CursorResult, Text, delete, select, update
from sqlalchemy.exc import IntegrityError
from sqlalchemy.orm import Mapped, mapped_column

from .database import Database, SignIn, Table

ADMIN = "admin"
MOST_ANNOUNCED = 500
"""Characters of an announcement."""


class Person(Table):
    """An account's role and limits; a person without a row has the ordinary ones.

    Attributes:
        key: of the account, or the name that a proxy gives.
        role: "admin" or empty.
        suspended: cannot sign in.
        megabytes: room of their own; None: as everybody.
    """

    __tablename__ = "people"

    key: Mapped[str] = mapped_column(primary_key=True)
    role: Mapped[str] = mapped_column(default="")
    suspended: Mapped[bool] = mapped_column(default=False)
    megabytes: Mapped[float | None] = mapped_column(default=None)


class Computed(Table):
    """The runs of a person that were computed, and their seconds of a worker; of a shared pass, each has its part."""

    __tablename__ = "computed"

    person: Mapped[str] = mapped_column(primary_key=True)
    runs: Mapped[int] = mapped_column(default=0)
    seconds: Mapped[float] = mapped_column(default=0.0)


class Announcement(Table):
    """The line that everybody is shown."""

    __tablename__ = "announcements"

    id: Mapped[int] = mapped_column(primary_key=True, autoincrement=False)
    text: Mapped[str] = mapped_column(Text)


class People:
    """Roles, rooms, suspensions, computed seconds and the announcement, for all processes.

    Args:
        database: holds them.
    """

    def __init__(self, database: Database) -> None:
        self.database = database
        self._added: dict[str, tuple[int, float]] = {}
        self._lock = threading.Lock()

    def of(self, key: str) -> Person:
        """The settings of an account."""
        with self.database.session() as session:
            return session.get(Person, key) or Person(key=key, role="", suspended=False, megabytes=None)

    def all(self) -> dict[str, Person]:
        """All accounts for which anything is set."""
        with self.database.session() as session:
            return {person.key: person for person in session.scalars(select(Person))}

    def set(self, key: str, **values: Any) -> None:
        """Changes what is set for an account."""
        with self.database.session.begin() as session:
            row = session.get(Person, key)
            if row is None:
                row = Person(key=key)
                session.add(row)
            for field, value in values.items():
                setattr(row, field, value)

    def arrive(self, key: str, *, admin: bool | None = None) -> bool:
        """Notes a person signing in elsewhere, so that administrators see them.

        Args:
            key: theirs.
            admin: whether their groups make them an administrator; None where groups do not decide that.

        Returns:
            False if they are suspended.
        """
        try:
            return self._arrive(key, admin)
        except IntegrityError:  # they came by two requests at once
            return self._arrive(key, admin)

    def _arrive(self, key: str, admin: bool | None) -> bool:
        with self.database.session.begin() as session:
            row = session.get(Person, key)
            if row is None:
                row = Person(key=key, role="", suspended=False)
                session.add(row)
            if admin is not None:
                row.role = ADMIN if admin else ""
            return not row.suspended

    def bytes_of(self, owner: str) -> float | None:
        """The room of a history's owner in bytes, where it is not everybody's."""
        if not owner.startswith("user "):
            return None
        megabytes = self.of(owner.removeprefix("user ")).megabytes
        return None if megabytes is None else megabytes * 2**20

    def sign_out(self, key: str) -> int:
        """Ends all sessions of an account; returns how many there were."""
        with self.database.session.begin() as session:
            ended = session.execute(delete(SignIn).where(SignIn.person == key))
            return cast(CursorResult[Any], ended).rowcount

    def forget(self, key: str) -> None:
        """Removes all that is set or counted for an account."""
        self.sign_out(key)
        with self.database.session.begin() as session:
            session.execute(delete(Person).where(Person.key == key))
            session.execute(delete(Computed).where(Computed.person == f"user {key}"))

    # ---- computed seconds ------------------------------------------------------------------------

    def add(self, person: str, seconds: float) -> None:
        """Counts a run of a person; :meth:`write` puts it into the database."""
        with self._lock:
            runs, before = self._added.get(person, (0, 0.0))
            self._added[person] = (runs + 1, before + seconds)

    def write(self) -> None:
        """Writes what was counted."""
        with self._lock:
            added, self._added = self._added, {}
        if not added:
            return
        with self.database.session.begin() as session:
            for person, (runs, seconds) in added.items():
                more = update(Computed).where(Computed.person == person)
                more = more.values(runs=Computed.runs + runs, seconds=Computed.seconds + seconds)
                if not cast(CursorResult[Any], session.execute(more)).rowcount:
                    session.add(Computed(person=person, runs=runs, seconds=seconds))

    def computed(self) -> dict[str, tuple[int, float]]:
        """Runs and seconds by person."""
        with self.database.session() as session:
            return {row.person: (row.runs, row.seconds) for row in session.scalars(select(Computed))}

    # ---- the announcement ------------------------------------------------------------------------

    def announce(self, text: str) -> None:
        """Shows everybody a line; an empty one removes it."""
        with self.database.session.begin() as session:
            session.execute(delete(Announcement))
            if line := " ".join(text.split())[:MOST_ANNOUNCED]:
                session.add(Announcement(id=1, text=line))

    def announced(self) -> str:
        """The line that everybody is shown; empty if there is none."""
        with self.database.session() as session:
            found = session.get(Announcement, 1)
            return found.text if found is not None else ""
