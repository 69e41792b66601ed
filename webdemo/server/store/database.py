"""The tables, in one SQLite file: runs, what is written on them, links to them, studies, people and sign-ins."""

from __future__ import annotations

import json
import logging
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from sqlalchemy import Engine, ForeignKey, Text, create_engine, event, inspect, select
from sqlalchemy.exc import DatabaseError, SQLAlchemyError
from sqlalchemy.orm import DeclarativeBase, Mapped, Session, mapped_column, relationship, sessionmaker

from motion import InputError
from webdemo.ui.history import Entry

log = logging.getLogger(__name__)

SCHEMA = 1
"""Number of the tables' schema, which the file keeps (``PRAGMA user_version``); a change of a table changes it."""
BUSY_SECONDS = 15
"""Time that SQLite waits for another writer."""
SOUND_SECONDS = 30.0
"""Time for which a successful integrity check of SQLite's file is valid: checking a large file is slow."""


class Table(DeclarativeBase):
    """The base of all tables. Times are seconds since 1970 where nothing else is said."""


class Run(Table):
    """One run, from its request on.

    Attributes:
        id: unguessable; names its folder of motion files.
        owner: whose history it is in.
        state: "running" (or waiting), "done", "failed", "cancelled", "interrupted".
        request: as JSON, without motion.
        outcome: manifest, timings and notes as JSON; empty until done.
        message: what went wrong, as one sentence.
        created: when it was asked for, by which it grows old.
        size: bytes of its files and of what is written about it.
        address: a hash of the address that it came from; empty where people are known by more than a cookie.
    """

    __tablename__ = "runs"

    id: Mapped[str] = mapped_column(primary_key=True)
    owner: Mapped[str] = mapped_column(index=True)
    kind: Mapped[str]
    title: Mapped[str] = mapped_column(Text)
    state: Mapped[str] = mapped_column(default="running", index=True)
    request: Mapped[str] = mapped_column(Text)
    outcome: Mapped[str] = mapped_column(Text, default="")
    message: Mapped[str] = mapped_column(Text, default="")
    created: Mapped[float] = mapped_column(default=time.time, index=True)
    size: Mapped[int] = mapped_column(default=0)
    address: Mapped[str] = mapped_column(default="", index=True)
    favourite: Mapped[bool] = mapped_column(default=False)
    links: Mapped[list[Link]] = relationship(back_populates="run", cascade="all, delete-orphan")
    note: Mapped[Note | None] = relationship(back_populates="run", cascade="all, delete-orphan")


class Note(Table):
    """The owner's words on a run, and how its tab was set.

    Attributes:
        title: the name that the owner gave it; empty for that of the run.
        tags: separated, begun and ended by a space.
        frame: the frame that ``text`` is about.
        thumbnail: of its motion.
        kept: how its tab was set, as JSON.
        part_of: the run whose grid or comparison this one is a part of; it has no card of its own then.
        removed: when the owner took it out of the history; it is deleted a while later.
    """

    __tablename__ = "notes"

    run_id: Mapped[str] = mapped_column(ForeignKey("runs.id", ondelete="CASCADE"), primary_key=True)
    title: Mapped[str] = mapped_column(Text, default="")
    tags: Mapped[str] = mapped_column(Text, default="")
    text: Mapped[str] = mapped_column(Text, default="")
    frame: Mapped[int | None] = mapped_column(default=None)
    thumbnail: Mapped[str] = mapped_column(Text, default="")
    kept: Mapped[str] = mapped_column(Text, default="")
    part_of: Mapped[str] = mapped_column(default="", index=True)
    removed: Mapped[float | None] = mapped_column(default=None, index=True)
    run: Mapped[Run] = relationship(back_populates="note")


class Link(Table):
    """A link that opens a run for anybody, until it expires or is revoked."""

    __tablename__ = "links"

    token: Mapped[str] = mapped_column(primary_key=True)
    run_id: Mapped[str] = mapped_column(ForeignKey("runs.id", ondelete="CASCADE"), index=True)
    until: Mapped[float]
    run: Mapped[Run] = relationship(back_populates="links")


class Published(Table):
    """A page that shows a run to anybody, until it expires or is revoked.

    Attributes:
        key: unguessable; the page's address.
        owner: whose run it is.
        until: when it ends.
    """

    __tablename__ = "published"

    key: Mapped[str] = mapped_column(primary_key=True)
    owner: Mapped[str] = mapped_column(index=True)
    run_id: Mapped[str] = mapped_column(ForeignKey("runs.id", ondelete="CASCADE"), index=True)
    created: Mapped[float] = mapped_column(default=time.time)
    until: Mapped[float]
    run: Mapped[Run] = relationship()


class SignIn(Table):
    """A session of a signed-in person, known by the hash of its cookie.

    Attributes:
        entry: fingerprint of the password at sign-in; a changed password invalidates the session.
    """

    __tablename__ = "sessions"

    digest: Mapped[str] = mapped_column(primary_key=True)
    person: Mapped[str] = mapped_column(index=True)
    entry: Mapped[str]
    until: Mapped[float]


class Person(Table):
    """An account's role; a person without a row has the ordinary one.

    Attributes:
        key: of the account, or the name that a proxy gives.
        role: "admin" or empty.
        suspended: cannot sign in.
    """

    __tablename__ = "people"

    key: Mapped[str] = mapped_column(primary_key=True)
    role: Mapped[str] = mapped_column(default="")
    suspended: Mapped[bool] = mapped_column(default=False)


class Study(Table):
    """A blind study; its motions are in a folder of its name.

    Attributes:
        id: unguessable; names its folder.
        owner: whose it is.
        key: unguessable; anyone who knows it can vote.
        question: that people answer for every pair.
        runs: names of the two runs, as JSON.
        captions: the sentence of each pair, as JSON.
        size: bytes of its motions.
        address: as that of a run.
    """

    __tablename__ = "studies"

    id: Mapped[str] = mapped_column(primary_key=True)
    owner: Mapped[str] = mapped_column(index=True)
    key: Mapped[str] = mapped_column(unique=True)
    question: Mapped[str] = mapped_column(Text)
    runs: Mapped[str] = mapped_column(Text)
    captions: Mapped[str] = mapped_column(Text)
    created: Mapped[float] = mapped_column(default=time.time)
    size: Mapped[int] = mapped_column(default=0)
    address: Mapped[str] = mapped_column(default="", index=True)


class Vote(Table):
    """A person's answer to a pair of a study.

    Attributes:
        person: a hash of the study and the person.
        pair: its number in the study.
        answer: "first" or "second" of the runs, or "tie".
        swapped: the second run was on the left.
        at: when.
    """

    __tablename__ = "votes"

    study_id: Mapped[str] = mapped_column(ForeignKey("studies.id", ondelete="CASCADE"), primary_key=True)
    person: Mapped[str] = mapped_column(primary_key=True)
    pair: Mapped[int] = mapped_column(primary_key=True)
    answer: Mapped[str]
    swapped: Mapped[bool]
    at: Mapped[float]


class Database:
    """A connection to the tables, which are made in an empty file.

    Args:
        file: SQLite's.

    Raises:
        InputError: if it cannot be opened, or another version of the program has made it.
    """

    def __init__(self, file: Path) -> None:
        with _opening(file):
            self.engine = _engine_of(file)
            self._make_tables()
            self.session = sessionmaker(self.engine, expire_on_commit=False)
            self._sound_until = 0.0
            self.check()  # rather than in the middle of a start

    def _make_tables(self) -> None:
        with self.engine.connect() as connection:
            connection.exec_driver_sql("BEGIN IMMEDIATE")  # another process may open it as well
            found = connection.exec_driver_sql("PRAGMA user_version").scalar()
            if found == SCHEMA:
                return
            if inspect(connection).get_table_names():
                raise InputError(
                    f"{self.engine.url.database} was made by another version of Pas de Deux (schema {found}; this one "
                    f"knows {SCHEMA}): move its folder away to begin anew, or install that version."
                )
            Table.metadata.create_all(connection)
            connection.exec_driver_sql(f"PRAGMA user_version = {SCHEMA}")
            connection.commit()

    def check(self) -> None:
        """Raises SQLAlchemyError if the database does not answer, or what people need cannot be read."""
        with self.engine.connect() as connection:
            for table in Table.metadata.sorted_tables:
                connection.execute(select(table).limit(1)).first()
            if time.monotonic() > self._sound_until:
                (found,) = connection.exec_driver_sql("PRAGMA quick_check(1)").one()
                if found != "ok":
                    raise DatabaseError("PRAGMA quick_check", None, ValueError(found))
                self._sound_until = time.monotonic() + SOUND_SECONDS

    def close(self) -> None:
        """Closes all connections."""
        self.engine.dispose()


def locked(session: Session) -> None:
    """Makes a session's transaction the only one that changes anything until it ends.

    Args:
        session: that has not read or written anything yet.
    """
    session.connection().exec_driver_sql("BEGIN IMMEDIATE")


@contextmanager
def _opening(file: Path) -> Iterator[None]:
    """Turns what fails when a database is opened into an InputError with one sentence."""
    try:
        yield
    except (SQLAlchemyError, OSError) as error:
        reason = str(getattr(error, "orig", None) or error).partition("\n")[0]
        raise InputError(
            f"The database {file.name} cannot be opened ({reason}): move the damaged file away and restore a backup."
        ) from None


def sentence_of(error: SQLAlchemyError) -> InputError:
    """The user's message for a database error. The error itself may quote private text, so it goes to the log."""
    log.error("The database failed.", exc_info=error)
    return InputError(
        "The server's disk is full, so nothing new can be kept: tell the person who runs it."
        if is_full(error)
        else "The server's history cannot be read or written: tell the person who runs it."
    )


@contextmanager
def sentences() -> Iterator[None]:
    """Turns a database error into an InputError with one sentence; also works as a decorator."""
    try:
        yield
    except SQLAlchemyError as error:
        raise sentence_of(error) from None


def is_full(error: BaseException) -> bool:
    """True if a database's error says that its disk is full."""
    return isinstance(error, SQLAlchemyError) and "full" in str(getattr(error, "orig", ""))


def _engine_of(file: Path) -> Engine:
    """Connections with write-ahead logging: readers never wait, and a killed process leaves an intact file."""
    file.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
    engine = create_engine(f"sqlite:///{file}")

    @event.listens_for(engine, "connect")
    def set_up(connection: Any, _: Any) -> None:
        cursor = connection.cursor()
        cursor.execute(f"PRAGMA busy_timeout={BUSY_SECONDS * 1000}")
        cursor.execute("PRAGMA journal_mode=WAL")
        cursor.execute("PRAGMA foreign_keys=ON")
        cursor.close()

    return engine


# ---- rows as the page takes them ---------------------------------------------------------------------


def is_removed(run: Run) -> bool:
    """True for a run that its owner has removed, and may still bring back."""
    return run.note is not None and run.note.removed is not None


def fields_of(text: str) -> dict[str, Any]:
    """A column's JSON; empty if it is damaged."""
    try:
        found = json.loads(text or "{}")
    except ValueError:
        return {}
    return found if isinstance(found, dict) else {}


def entry_of(run: Run) -> Entry:
    """A row as the page takes it."""
    now, note = time.time(), run.note or Note(title="", tags="", text="", frame=None, thumbnail="")
    return Entry(
        id=run.id,
        kind=run.kind,
        title=note.title or run.title,
        state=run.state,
        message=run.message,
        created=run.created,
        request=fields_of(run.request),
        favourite=run.favourite,
        links=sum(link.until > now for link in run.links),
        tags=tuple(note.tags.split()),
        note=note.text,
        frame=note.frame,
        thumbnail=note.thumbnail,
    )


def note_of(session: Session, run: str) -> Note:
    """The note of a run, made where it has none."""
    found = session.get(Note, run)
    if found is None:
        found = Note(run_id=run, title="", tags="", text="", thumbnail="", kept="", part_of="")
        session.add(found)
    return found
