"""The migrations make the tables that the classes describe, once, all or none."""

from __future__ import annotations

import multiprocessing
import sqlite3
from contextlib import closing
from pathlib import Path

import pytest
from alembic.autogenerate import compare_metadata
from alembic.migration import MigrationContext
from sqlalchemy import create_engine, text

from motion import InputError
from tests.server.clients import DATABASES, database_url
from webdemo.server import activity
from webdemo.server.queue import places, shares
from webdemo.server.store import ledger
from webdemo.server.store.database import Database, Table
from webdemo.server.store.migrations import NEWEST, revision_of

TABLES = {Table, activity.Process, places.Place, shares.Work, ledger.Ledger}
"""Imported for their metadata."""


@pytest.mark.parametrize("kind", DATABASES)
def test_a_new_database_is_as_the_tables_say(kind: str, tmp_path: Path) -> None:
    """A table or column without a migration, or a migration of something else, is a difference."""
    database = Database(database_url(kind, tmp_path))
    with database.engine.connect() as connection:
        assert not compare_metadata(MigrationContext.configure(connection), Table.metadata)
    assert revision_of(database.engine) == NEWEST
    database.close()


def test_a_newer_database_is_left_alone(tmp_path: Path) -> None:
    url = f"sqlite:///{tmp_path / 'history.db'}"
    Database(url).close()
    engine = create_engine(url)
    with engine.begin() as connection:
        connection.execute(text("UPDATE alembic_version SET version_num = '9999'"))
    with pytest.raises(InputError, match="newer version"):
        Database(url)
    engine.dispose()


def test_a_migration_that_fails_leaves_what_was(tmp_path: Path) -> None:
    with closing(sqlite3.connect(tmp_path / "history.db")) as database:
        database.execute("CREATE TABLE ix_notes_removed (x)")  # the name of an index that is made late
        before = "\n".join(database.iterdump())
    with pytest.raises(InputError, match="cannot be opened"):
        Database(f"sqlite:///{tmp_path / 'history.db'}")
    with closing(sqlite3.connect(tmp_path / "history.db")) as database:
        assert "\n".join(database.iterdump()) == before


def _open(url: str) -> None:
    Database(url).close()


def test_several_processes_migrate_at_once(tmp_path: Path) -> None:
    context = multiprocessing.get_context("spawn")
    url = f"sqlite:///{tmp_path / 'history.db'}"
    processes = [context.Process(target=_open, args=(url,)) for _ in range(3)]
    for process in processes:
        process.start()
    for process in processes:
        process.join()
    assert [process.exitcode for process in processes] == [0, 0, 0]


def test_one_damaged_page_ends_the_start_in_a_sentence(tmp_path: Path) -> None:
    file = tmp_path / "history.db"
    Database(f"sqlite:///{file}").close()
    whole = bytearray(file.read_bytes())
    size = int.from_bytes(whole[16:18], "big")
    refused = 0
    for page in range(len(whole) // size):
        file.write_bytes(whole[: page * size] + b"\xff" * size + whole[(page + 1) * size :])
        try:
            Database(f"sqlite:///{file}").close()
        except InputError as error:
            refused += 1
            assert "restore a backup" in str(error) and "\n" not in str(error)
    assert refused > 20
