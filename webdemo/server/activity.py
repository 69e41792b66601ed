"""Activity of all page processes that share a database: runs, live streams, health and last errors, for administrators
at the page of any of them and in a shell; and the wish that one of those runs or streams ends."""

from __future__ import annotations

import json
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import asdict, dataclass
from typing import Any

from sqlalchemy import Text, delete, select
from sqlalchemy.exc import SQLAlchemyError
from sqlalchemy.orm import Mapped, mapped_column

from motion import InputError
from webdemo.server.audit import audit
from webdemo.server.live.streams import Streams
from webdemo.server.queue.places import LOST_AFTER, SEEN_EVERY
from webdemo.server.queue.queue import FairQueue
from webdemo.server.store.database import Database, Table

ENDED = "The person who runs this server ended this."
_PATIENCE = 30.0
"""Seconds for which a wish that something ends is kept."""
_LOOK_EVERY = 0.2
"""Seconds between two looks for whether it has ended."""


class Process(Table):
    """A page process and what it does.

    Attributes:
        seen: time of the last change or heartbeat.
        state: JSON; see :meth:`Activity.publish`.
    """

    __tablename__ = "processes"

    node: Mapped[str] = mapped_column(primary_key=True)
    seen: Mapped[float]
    state: Mapped[str] = mapped_column(Text)


class Ending(Table):
    """An administrator's wish that a run or a live stream ends, until the process that has it has heard it."""

    __tablename__ = "endings"

    id: Mapped[str] = mapped_column(primary_key=True)
    came: Mapped[float] = mapped_column(default=time.time)


@dataclass(frozen=True)
class Item:
    """A run or a live stream.

    Attributes:
        node: the process that has it.
        person: its owner, as the queue identifies them.
        what: "live stream", or the model of a run.
        state: "runs", "waits" or "open".
        since: time at which that state began.
    """

    id: str
    node: str
    person: str
    what: str
    state: str
    since: float


class Activity:
    """Reads what all processes do, and asks the one that has a run or a stream to end it.

    Args:
        database: shared by all processes.
    """

    def __init__(self, database: Database) -> None:
        self.database = database
        self._written: tuple[str, str, float] = ("", "", 0.0)

    def items(self) -> list[Item]:
        """Everything that runs, waits or is open, in all processes."""
        return [Item(**item) for state in self.states().values() for item in state["work"]]

    def states(self) -> dict[str, dict[str, Any]]:
        """The state of each process that was seen lately, by its name."""
        living = select(Process).where(Process.seen > time.time() - LOST_AFTER).order_by(Process.node)
        with self.database.session() as session:
            return {process.node: json.loads(process.state) for process in session.scalars(living)}

    def end(self, key: str, *, wait: float = 5.0) -> None:
        """Asks that a run or a stream ends, and waits until it has.

        Raises:
            InputError: if there is none of that id, or its process does not answer.
        """
        found = next((item for item in self.items() if item.id == key), None)
        if found is None:
            raise InputError(f"There is no run or live stream {key!r:.60}: see `admin jobs`.")
        self.ask(key)
        until = time.monotonic() + wait
        while any(item.id == key for item in self.items()):
            if time.monotonic() > until:
                raise InputError(f"The process {found.node} has not ended it yet: look again with `admin jobs`.")
            time.sleep(_LOOK_EVERY)
        audit("admin-end-stream" if found.state == "open" else "admin-end-run", id=key)

    def ask(self, key: str) -> None:
        """Asks that a run or a stream ends, without waiting."""
        with self.database.session.begin() as session:
            session.merge(Ending(id=key, came=time.time()))

    def heed(self, end: Callable[[str], bool]) -> None:
        """Ends what others have asked for.

        Args:
            end: ends a run or a stream of this process by its id; False if it has none of that id.
        """
        old = time.time() - _PATIENCE
        with self.database.session() as session:
            asked = list(session.scalars(select(Ending)))
        done = [ending.id for ending in asked if end(ending.id) or ending.came < old]
        if done:
            with self.database.session.begin() as session:
                session.execute(delete(Ending).where(Ending.id.in_(done)))

    def publish(self, node: str, work: list[Item], **state: Any) -> None:
        """Writes what this process does, when it has changed and as a heartbeat.

        Args:
            node: this process's name.
            work: its runs and streams.
            state: further things that can be written as JSON: its health and last errors.
        """
        text = json.dumps({"work": [asdict(item) for item in work], **state})
        now = time.time()
        if self._written[:2] == (node, text) and now - self._written[2] < SEEN_EVERY:
            return
        with self.database.session.begin() as session:
            session.execute(delete(Process).where(Process.seen < now - LOST_AFTER))
            session.merge(Process(node=node, seen=now, state=text))
        self._written = (node, text, now)

    def leave(self, node: str) -> None:
        """Removes a process that stops; where the database is gone, it is taken for lost a little later."""
        with suppress(SQLAlchemyError), self.database.session.begin() as session:
            session.execute(delete(Process).where(Process.node == node))


def work_of(node: str, queue: FairQueue, streams: Streams) -> list[Item]:
    """The runs and live streams of this process."""
    now, clock = time.time(), time.monotonic()

    def since(moment: float) -> float:
        return round(now - clock + moment, 0)

    runs = [
        Item(
            job.id, node, job.person, job.group, "runs" if begun else "waits", since(job.started if begun else job.came)
        )
        for job, begun in queue.jobs()
    ]
    return runs + [
        Item(stream.id, node, stream.person, "live stream", "open", since(stream.began)) for stream in streams.opened()
    ]
