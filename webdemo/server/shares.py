"""The work that people have had at all page processes that share a database, so that each knows of it."""

from __future__ import annotations

import threading
import time

from sqlalchemy import delete, func, select, update
from sqlalchemy.orm import Mapped, mapped_column

from .database import Database, Table

SHARE_EVERY = 1.0
"""Seconds between two exchanges."""
KEPT_SECONDS = 86_400.0
"""After which the work of people who came no more is forgotten."""


class Work(Table):
    """What a person has had at a process.

    Attributes:
        units: of work, all told.
        seen: when some was last added.
    """

    __tablename__ = "work"

    person: Mapped[str] = mapped_column(primary_key=True)
    node: Mapped[str] = mapped_column(primary_key=True)
    units: Mapped[float]
    seen: Mapped[float] = mapped_column(index=True)


class Shares:
    """Tells others of the work done here, and is told of theirs.

    Args:
        database: shared by all processes.
        node: this process's name.
    """

    def __init__(self, database: Database, node: str) -> None:
        self.database, self.node = database, node
        self._added: dict[str, float] = {}
        self._lock = threading.Lock()

    def add(self, person: str, units: float) -> None:
        """A person had so much here; written at the next exchange."""
        with self._lock:
            self._added[person] = self._added.get(person, 0.0) + units

    def exchange(self) -> dict[str, float]:
        """Writes what was added, and gives what everybody has had at the other processes, all told."""
        with self._lock:
            added, self._added = self._added, {}
        now = time.time()
        if added:
            with self.database.session.begin() as session:
                for person, units in added.items():
                    mine = (Work.person == person, Work.node == self.node)
                    more = update(Work).where(*mine).values(units=Work.units + units, seen=now)
                    if not session.execute(more).rowcount:
                        session.add(Work(person=person, node=self.node, units=units, seen=now))
                session.execute(delete(Work).where(Work.seen < now - KEPT_SECONDS))
        others = select(Work.person, func.sum(Work.units)).where(Work.node != self.node)
        with self.database.session() as session:
            return dict(session.execute(others.group_by(Work.person)).tuples().all())
