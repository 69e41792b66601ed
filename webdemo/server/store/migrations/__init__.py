"""Brings a database's tables to the schema of this version, or back to an earlier one, by Alembic.

``versions`` holds one file for each change, ``rNUMBER_NAME.py``. The revision of a database is in its table
``alembic_version``; a database of a version before migrations has none, and begins with the first.
"""

from __future__ import annotations

import logging
import os
import sqlite3
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path

from sqlalchemy import Connection, Engine, inspect, text

from motion import InputError

log = logging.getLogger(__name__)

FOLDER = Path(__file__).parent
REVISIONS = tuple(sorted(path.name[1:5] for path in (FOLDER / "versions").glob("r[0-9]*.py")))
"""All revisions that this version knows, the oldest first."""
NEWEST = REVISIONS[-1]
_LOCK = 7_201_907
"""Number of PostgreSQL's advisory lock that a process holds while it migrates."""


def revision_of(engine: Engine) -> str:
    """The revision of a database; empty where it has none."""
    with engine.connect() as connection:
        if not inspect(connection).has_table("alembic_version"):
            return ""
        return connection.scalar(text("SELECT version_num FROM alembic_version")) or ""


def upgrade(engine: Engine) -> None:
    """Brings a database to the newest revision; several processes may do so at once.

    A SQLite file that holds anything is copied before, beside itself.

    Raises:
        InputError: if a newer version of the program has made it.
    """
    revision = revision_of(engine)
    if revision == NEWEST:
        return
    if revision and revision not in REVISIONS:
        raise InputError(
            f"The database was made by a newer version of Pas de Deux (revision {revision}; this one knows {NEWEST}): "
            f"install that version, or go back by its `python -m webdemo database downgrade {NEWEST}`."
        )
    _copy(engine, NEWEST)
    _migrate(engine, "upgrade", NEWEST)
    if revision:
        log.warning("The database was brought from revision %s to %s.", revision, NEWEST)


def migrate(engine: Engine, revision: str) -> None:
    """Brings an empty or older database to a revision, without a copy of it."""
    _migrate(engine, "upgrade", revision)


def downgrade(engine: Engine, revision: str) -> None:
    """Takes a database back to an earlier revision, for the version of the program that made it.

    Raises:
        InputError: for a revision that is none, or newer than the database's.
    """
    current = revision_of(engine)
    if revision not in REVISIONS or current not in REVISIONS or revision > current:
        raise InputError(
            f"The database (revision {current or 'none'}) cannot go back to {revision!r:.20}: "
            f"name one of {', '.join(REVISIONS)} that is not newer."
        )
    _copy(engine, f"{revision}-again")
    _migrate(engine, "downgrade", revision)


def _copy(engine: Engine, revision: str) -> None:
    """Copies a SQLite database that holds tables to ``FILE.before-REVISION``, unless that is there."""
    file = engine.url.database
    if (
        engine.dialect.name != "sqlite"
        or not file
        or file == ":memory:"
        or not inspect(engine).get_table_names()
    ):
        return
    target = Path(f"{file}.before-{revision}")
    if target.exists():
        return
    half = target.with_name(f".{target.name}.{os.getpid()}")
    try:
        os.close(os.open(half, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o600))
        with closing(sqlite3.connect(file)) as old, closing(sqlite3.connect(half)) as new:
            old.backup(new)
        os.replace(half, target)
    finally:
        half.unlink(missing_ok=True)
    log.warning("The database is about to be migrated; a copy of it is in %s.", target)


def _migrate(engine: Engine, way: str, revision: str) -> None:
    from alembic import command
    from alembic.config import Config

    config = Config()
    config.set_main_option("script_location", str(FOLDER).replace("%", "%%"))
    with _alone(engine) as connection:
        config.attributes["connection"] = connection
        getattr(command, way)(config, revision)


@contextmanager
def _alone(engine: Engine) -> Iterator[Connection]:
    """A transaction in which no other process migrates: all changes are made, or none."""
    with engine.connect() as connection:
        if engine.dialect.name == "sqlite":
            connection.exec_driver_sql("BEGIN IMMEDIATE")
        elif engine.dialect.name == "postgresql":
            connection.execute(text("SELECT pg_advisory_xact_lock(:lock)"), {"lock": _LOCK})
        yield connection
        connection.commit()
