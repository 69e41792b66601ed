"""Shares each person's served work among all page processes that use one database."""

from __future__ import annotations

import threading
import time
from typing import Any, cast

from sqlalchemy import CursorResult, delete, func, select, update
from sqlalchemy.orm import Mapped, mapped_column

from webdemo.server.store.database import Database, Table

SHARE_EVERY = 1.0
"""Seconds between two exchanges."""
KEPT_SECONDS = 86_400.0
"""Seconds after which the work of a person who does not return is deleted."""


class Work(Table):
    """The work that one process has done for a person.

    Attributes:
        units: total work.
        seen: time of the last addition.
    """

    __tablename__ = "work"

    person: Mapped[str] = mapped_column(primary_key=True)
    node: Mapped[str] = mapped_column(primary_key=True)
    units: Mapped[float]
    seen: Mapped[float] = mapped_column(index=True)


class Shares:
    """Publishes the work done by this process and reads that of the others.

    Args:
        database: shared by all processes.
        node: this process's name.
    """

    def __init__(self, database: Database, node: str) -> None:
        self.database, self.node = database, node
        self._added: dict[str, float] = {}
        self._lock = threading.Lock()

    def add(self, person: str, units: float) -> None:
        """Adds work that this process did for a person; the next exchange writes it."""
        with self._lock:
            self._added[person] = self._added.get(person, 0.0) + units

    def exchange(self) -> dict[str, float]:
        """Writes the added work; returns each person's total at all other processes."""
        with self._lock:
            added, self._added = self._added, {}
        now = time.time()
        if added:
            with self.database.session.begin() as session:
                for person, units in added.items():
                    mine = (Work.person == person, Work.node == self.node)
                    more = update(Work).where(*mine).values(units=Work.units + units, seen=now)
                    if not cast(CursorResult[Any], session.execute(more)).rowcount:
                        session.add(Work(person=person, node=self.node, units=units, seen=now))
                session.execute(delete(Work).where(Work.seen < now - KEPT_SECONDS))
        others = select(Work.person, func.sum(Work.units)).where(Work.node != self.node)
        with self.database.session() as session:
            return dict(session.execute(others.group_by(Work.person)).tuples().all())
