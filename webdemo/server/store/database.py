"""The tables, in one SQLite file: runs, what shows them to others, studies, accounts and sign-ins."""

from __future__ import annotations

import errno
import json
import logging
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, cast

from sqlalchemy import (
    ColumnElement,
    CursorResult,
    Engine,
    Executable,
    ForeignKey,
    Text,
    and_,
    create_engine,
    event,
    inspect,
    select,
)
from sqlalchemy.exc import DatabaseError, SQLAlchemyError
from sqlalchemy.orm import DeclarativeBase, Mapped, Session, mapped_column, relationship, sessionmaker

from motion import InputError
from webdemo.ui.history import Entry

log = logging.getLogger(__name__)

SCHEMA = 2
"""Number of the tables' schema, which the file keeps (``PRAGMA user_version``); a change of a table changes it."""
DISK_FULL = "The server's disk is full, so nothing more can be kept: tell the person who runs it."
BROKEN = "The server's history cannot be read or written: tell the person who runs it."
BUSY_SECONDS = 15
"""Time that SQLite waits for another writer."""
SOUND_SECONDS = 30.0
"""Time for which a successful integrity check of SQLite's file is valid: checking a large file is slow."""


class Table(DeclarativeBase):
    """The base of all tables. Times are seconds since 1970 where nothing else is said."""


class Run(Table):
    """One run, from its request on, with what its owner wrote about it.

    Attributes:
        id: unguessable; names its folder of motion files.
        owner: whose history it is in.
        title: its prompt, or what it is a reaction to.
        state: "running" (or waiting), "done", "failed", "cancelled", "interrupted".
        request: as JSON, without motion.
        outcome: manifest, timings and notes as JSON; empty until done.
        message: what went wrong, as one sentence.
        created: when it was asked for, by which it grows old.
        size: bytes of its files and of what is written about it.
        address: a hash of the address that it came from; empty where people are known by more than a cookie.
        name: that the owner gave it; empty for its title.
        tags: separated, begun and ended by a space.
        note: the owner's words.
        thumbnail: of its motion.
        kept: how its tab was set, as JSON.
        part_of: the run whose grid or comparison this one is a part of; it has no card of its own then.
        removed: when the owner took it out of the history; it is deleted a while later.
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
    name: Mapped[str] = mapped_column(Text, default="")
    tags: Mapped[str] = mapped_column(Text, default="")
    note: Mapped[str] = mapped_column(Text, default="")
    thumbnail: Mapped[str] = mapped_column(Text, default="")
    kept: Mapped[str] = mapped_column(Text, default="")
    part_of: Mapped[str] = mapped_column(default="", index=True)
    removed: Mapped[float | None] = mapped_column(default=None, index=True)
    shares: Mapped[list[Share]] = relationship(
        back_populates="run", cascade="all, delete-orphan", passive_deletes=True, lazy="selectin"
    )


class Share(Table):
    """What shows a run to others until it ends: a link, to the people of the lab, or a public page, to anybody.

    Attributes:
        key: unguessable; the end of its address.
        until: when it ends.
    """

    __tablename__ = "shares"

    key: Mapped[str] = mapped_column(primary_key=True)
    run_id: Mapped[str] = mapped_column(ForeignKey("runs.id", ondelete="CASCADE"), index=True)
    public: Mapped[bool]
    created: Mapped[float] = mapped_column(default=time.time)
    until: Mapped[float]
    run: Mapped[Run] = relationship(back_populates="shares")


class Account(Table):
    """A person with a password, or one whom a proxy has named.

    Attributes:
        name: by which they sign in.
        key: the name and an id, to which everything of theirs belongs: nobody inherits from an earlier account.
        password: cost, salt and hash; empty for a person who signs in at the proxy alone.
        role: "admin" or empty.
        suspended: cannot sign in.
    """

    __tablename__ = "accounts"

    name: Mapped[str] = mapped_column(primary_key=True)
    key: Mapped[str] = mapped_column(unique=True)
    password: Mapped[str] = mapped_column(default="")
    role: Mapped[str] = mapped_column(default="")
    suspended: Mapped[bool] = mapped_column(default=False)

    @property
    def owner(self) -> str:
        """The owner of the person's runs and files."""
        return f"user {self.key}"


class SignIn(Table):
    """A session of a signed-in person, known by the hash of its cookie."""

    __tablename__ = "sessions"

    digest: Mapped[str] = mapped_column(primary_key=True)
    person: Mapped[str] = mapped_column(ForeignKey("accounts.name", ondelete="CASCADE"), index=True)
    until: Mapped[float]


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
        self._sound_until = 0.0
        try:
            self.engine = _engine_of(file)
            self._make_tables()
            self.session = sessionmaker(self.engine, expire_on_commit=False)
            self.check()  # rather than in the middle of a start
        except (SQLAlchemyError, OSError) as error:
            reason = str(getattr(error, "orig", None) or error).partition("\n")[0]
            raise InputError(
                f"The database {file.name} cannot be opened ({reason}): move the damaged file away and restore a "
                "backup."
            ) from None

    def _make_tables(self) -> None:
        with self.engine.connect() as connection:
            connection.exec_driver_sql("BEGIN IMMEDIATE")  # another process may open it as well
            schema = connection.exec_driver_sql("PRAGMA user_version").scalar()
            if schema == SCHEMA:
                return
            if inspect(connection).get_table_names():
                raise InputError(
                    f"{self.engine.url.database} was made by another version of Pas de Deux (schema {schema}; this one "
                    f"has {SCHEMA}): export the runs with that version, move the folder, and import them in History."
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
                (answer,) = connection.exec_driver_sql("PRAGMA quick_check(1)").one()
                if answer != "ok":
                    raise DatabaseError("PRAGMA quick_check", None, ValueError(answer))
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


def owned(table: type[Run] | type[Study], owner: str) -> ColumnElement[bool]:
    """What belongs to somebody: nothing where there is nobody."""
    return and_(table.owner == owner, table.owner != "")


def changed(session: Session, statement: Executable) -> int:
    """Executes a statement; returns how many rows it has changed or deleted."""
    return cast(CursorResult[Any], session.execute(statement)).rowcount


def sentence_of(error: Exception) -> InputError:
    """The user's message for what fails while something is kept. It may quote private text, so it goes to the log."""
    if isinstance(error, InputError):
        return error
    log.error("Something could not be kept.", exc_info=error)
    return InputError(DISK_FULL if is_full(error) else BROKEN)


@contextmanager
def sentences() -> Iterator[None]:
    """Turns a database error into an InputError with one sentence; also works as a decorator."""
    try:
        yield
    except SQLAlchemyError as error:
        raise sentence_of(error) from None


def is_full(error: BaseException) -> bool:
    """True if an error says that a disk is full."""
    return (isinstance(error, OSError) and error.errno in (errno.ENOSPC, errno.EDQUOT)) or (
        isinstance(error, SQLAlchemyError) and "full" in str(getattr(error, "orig", ""))
    )


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


def fields_of(text: str) -> dict[str, Any]:
    """A column's JSON; empty if it is damaged."""
    try:
        fields = json.loads(text or "{}")
    except ValueError:
        return {}
    return fields if isinstance(fields, dict) else {}


def entry_of(run: Run) -> Entry:
    """A row as the page takes it."""
    now = time.time()
    return Entry(
        id=run.id,
        kind=run.kind,
        title=run.name or run.title,
        state=run.state,
        message=run.message,
        created=run.created,
        request=fields_of(run.request),
        favourite=run.favourite,
        links=sum(share.until > now for share in run.shares if not share.public),
        tags=tuple(run.tags.split()),
        note=run.note,
        thumbnail=run.thumbnail,
    )
