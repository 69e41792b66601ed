"""Brings a database's tables to the schema of this version, by Alembic.

An empty database gets the tables of the classes at once. ``versions`` holds one file for each change of older ones,
``rNUMBER_NAME.py``. The revision of a database is in its table ``alembic_version``.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from sqlalchemy import Connection, Engine, MetaData, inspect, text

from motion import InputError

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


def upgrade(engine: Engine, tables: MetaData) -> None:
    """Brings a database to the newest revision in one transaction; several processes may do so at once.

    Args:
        engine: connects to the database.
        tables: those of the newest revision.

    Raises:
        InputError: if a newer version of the program has made it.
    """
    revision = revision_of(engine)
    if revision == NEWEST:
        return
    if revision and revision not in REVISIONS:
        raise InputError(
            f"The database was made by a newer version of Pas de Deux (revision {revision}; this one knows {NEWEST}): "
            "install that version."
        )
    from alembic import command
    from alembic.config import Config

    config = Config()
    config.set_main_option("script_location", str(FOLDER).replace("%", "%%"))
    with _alone(engine) as connection:
        config.attributes["connection"] = connection
        if inspect(connection).get_table_names():
            command.upgrade(config, NEWEST)
        else:
            tables.create_all(connection)
            command.stamp(config, NEWEST)


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
