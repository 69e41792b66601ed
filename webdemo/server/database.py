"""The tables: runs, the links that open them for others, and sign-ins."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

from sqlalchemy import Engine, ForeignKey, Text, create_engine, event
from sqlalchemy.exc import ArgumentError, NoSuchModuleError, SQLAlchemyError
from sqlalchemy.orm import DeclarativeBase, Mapped, mapped_column, relationship, sessionmaker

from webdemo.motion import InputError

BUSY_SECONDS = 15
"""How long SQLite waits for another writer."""


class Table(DeclarativeBase):
    """What all tables share. Times are seconds since 1970."""


class Run(Table):
    """One run, from when it was asked for.

    Attributes:
        id: unguessable; names its folder of motion files.
        owner: whose history it is in.
        state: "running" (or waiting), "done", "failed", "cancelled", "interrupted".
        request: as JSON, without motion.
        outcome: manifest, timings and notes as JSON; empty until done.
        message: what went wrong, as one sentence.
        size: bytes of its files.
        node: the process that runs it.
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
    favourite: Mapped[bool] = mapped_column(default=False)
    node: Mapped[str] = mapped_column(default="")
    links: Mapped[list[Link]] = relationship(back_populates="run", cascade="all, delete-orphan")


class Link(Table):
    """Opens a run for anybody who has it, until it ends or is revoked."""

    __tablename__ = "links"

    token: Mapped[str] = mapped_column(primary_key=True)
    run_id: Mapped[str] = mapped_column(ForeignKey("runs.id", ondelete="CASCADE"), index=True)
    until: Mapped[float]
    run: Mapped[Run] = relationship(back_populates="links")


class SignIn(Table):
    """A session of a signed-in person, known by the hash of its cookie."""

    __tablename__ = "sign_ins"

    digest: Mapped[str] = mapped_column(primary_key=True)
    person: Mapped[str] = mapped_column(index=True)
    until: Mapped[float]


class Database:
    """A connection to the tables, which are made where they are missing.

    Args:
        url: as SQLAlchemy takes it.

    Raises:
        InputError: where the URL is none, its driver is missing or the database cannot be opened.
    """

    def __init__(self, url: str) -> None:
        try:
            self.engine = create_engine(url, pool_pre_ping=True)
            if self.engine.dialect.name == "sqlite":
                _prepare_sqlite(self.engine)
            Table.metadata.create_all(self.engine)
        except (ArgumentError, NoSuchModuleError):
            raise InputError(
                "The database's URL is not understood: write it as sqlite:///FILE or postgresql+psycopg://…"
            ) from None
        except ModuleNotFoundError as error:
            raise InputError(
                f"The database needs the Python package {error.name}: install it, or use SQLite."
            ) from None
        except (SQLAlchemyError, OSError) as error:
            reason = str(getattr(error, "orig", None) or error).partition("\n")[0]
            raise InputError(
                f"The database cannot be opened ({reason}): check its URL, or move the damaged file away."
            ) from None
        self.session = sessionmaker(self.engine, expire_on_commit=False)

    def check(self) -> None:
        """Raises SQLAlchemyError where the database does not answer."""
        with self.engine.connect() as connection:
            connection.exec_driver_sql("SELECT 1")

    def close(self) -> None:
        self.engine.dispose()


def _prepare_sqlite(engine: Engine) -> None:
    """Write-ahead logging, so that a reader never waits and a killed process leaves a whole file."""
    if (file := engine.url.database) and file != ":memory:":
        Path(file).parent.mkdir(mode=0o700, parents=True, exist_ok=True)

    @event.listens_for(engine, "connect")
    def set_up(connection: Any, _: Any) -> None:
        cursor = connection.cursor()
        cursor.execute(f"PRAGMA busy_timeout={BUSY_SECONDS * 1000}")
        cursor.execute("PRAGMA journal_mode=WAL")
        cursor.execute("PRAGMA foreign_keys=ON")
        cursor.close()
