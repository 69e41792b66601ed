"""Limits a person's runs over all page processes that share a database."""

from __future__ import annotations

import secrets
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress

from sqlalchemy import delete, func, or_, select, update
from sqlalchemy.exc import SQLAlchemyError
from sqlalchemy.orm import Mapped, mapped_column

from motion import InputError
from webdemo.server.store.database import Database, Table

SEEN_EVERY = 20.0
"""Seconds between two heartbeats of a process."""
LOST_AFTER = 90.0
"""Seconds without a heartbeat after which the runs of a process no longer count."""


class Place(Table):
    """A waiting or running run at one of the processes.

    Attributes:
        person: its owner, as the queue identifies them.
        node: the process that holds it.
        seen: time of that process's last heartbeat.
    """

    __tablename__ = "places"

    id: Mapped[str] = mapped_column(primary_key=True)
    person: Mapped[str] = mapped_column(index=True)
    node: Mapped[str] = mapped_column(index=True)
    seen: Mapped[float] = mapped_column(default=time.time)


class Places:
    """Counts each person's runs.

    Args:
        database: shared by all processes.
        node: this process's name.
        most: runs that a person may have at a time.
    """

    def __init__(self, database: Database, node: str, most: int) -> None:
        self.database, self.node, self.most = database, node, most

    @contextmanager
    def held(self, person: str) -> Iterator[None]:
        """Counts a run while it lasts.

        Raises:
            InputError: if the person has reached the limit.
        """
        place = secrets.token_hex(12)
        # Written before counting: of two that arrive at two processes at once, both may be refused, but never
        # both accepted beyond the limit.
        with self.database.session.begin() as session:
            session.add(Place(id=place, person=person, node=self.node))
        try:
            with self.database.session() as session:
                count = session.scalar(
                    select(func.count())
                    .select_from(Place)
                    .where(Place.person == person, Place.seen > time.time() - LOST_AFTER)
                )
            if (count or 0) > self.most:
                raise InputError(
                    f"You have {self.most} runs waiting or running already, here or in another of the "
                    "server's processes: wait for one or cancel it, then try again."
                )
            yield
        finally:
            with suppress(SQLAlchemyError), self.database.session.begin() as session:
                session.execute(delete(Place).where(Place.id == place))

    def refresh(self) -> None:
        """Records a heartbeat."""
        with self.database.session.begin() as session:
            session.execute(update(Place).where(Place.node == self.node).values(seen=time.time()))

    def clear(self) -> None:
        """Deletes runs left by an earlier process of this name and by lost processes."""
        old = or_(Place.node == self.node, Place.seen < time.time() - LOST_AFTER)
        with self.database.session.begin() as session:
            session.execute(delete(Place).where(old))
