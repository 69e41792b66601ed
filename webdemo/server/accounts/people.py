"""What is set for each account: roles and suspensions."""

from __future__ import annotations

from typing import Any, cast

from sqlalchemy import CursorResult, delete, select
from sqlalchemy.exc import IntegrityError

from webdemo.server.store.database import Database, Person, SignIn

ADMIN = "admin"


class People:
    """Roles and suspensions.

    Args:
        database: holds them.
    """

    def __init__(self, database: Database) -> None:
        self.database = database

    def of(self, key: str) -> Person:
        """What is set for an account."""
        with self.database.session() as session:
            return session.get(Person, key) or Person(key=key, role="", suspended=False)

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

    def arrive(self, key: str) -> bool:
        """Notes a person signing in elsewhere, so that administrators see them; False if they are suspended."""
        try:
            self.set(key)
        except IntegrityError:  # they came by two requests at once
            self.set(key)
        return not self.of(key).suspended

    def sign_out(self, key: str) -> int:
        """Ends all sessions of an account; returns how many there were."""
        with self.database.session.begin() as session:
            ended = session.execute(delete(SignIn).where(SignIn.person == key))
            return cast(CursorResult[Any], ended).rowcount
