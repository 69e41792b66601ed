"""The migrations make the tables that the classes describe, once, all or none."""

from __future__ import annotations

import multiprocessing
from pathlib import Path

import pytest
from alembic.autogenerate import compare_metadata
from alembic.migration import MigrationContext
from sqlalchemy import create_engine, func, insert, select, text

from motion import InputError
from webdemo.server.store.database import Database, Run, Table
from webdemo.server.store.migrations import NEWEST, revision_of


@pytest.fixture
def first(tmp_path: Path) -> str:
    """A database of the first revision, with a run."""
    url = f"sqlite:///{tmp_path / 'history.db'}"
    engine = create_engine(url)
    Table.metadata.create_all(engine)
    with engine.begin() as connection:
        connection.execute(text("ALTER TABLE runs ADD COLUMN node VARCHAR NOT NULL DEFAULT ''"))
        connection.execute(text("CREATE TABLE ledger (id INTEGER PRIMARY KEY, turn INTEGER)"))
        connection.execute(text("CREATE TABLE alembic_version (version_num VARCHAR(32) NOT NULL)"))
        connection.execute(text("INSERT INTO alembic_version VALUES ('0001')"))
        connection.execute(insert(Run).values(id="r" * 24, owner="user ada", kind="generate", title="x", request="{}"))
    engine.dispose()
    return url


@pytest.mark.parametrize("empty", [True, False])
def test_a_database_becomes_as_the_tables_say(empty: bool, first: str, tmp_path: Path) -> None:
    """A table or column without a migration, or a migration of something else, is a difference."""
    database = Database(f"sqlite:///{tmp_path / 'new.db'}" if empty else first)
    with database.engine.connect() as connection:
        assert not compare_metadata(MigrationContext.configure(connection), Table.metadata)
        assert connection.scalar(select(func.count()).select_from(Run)) == (0 if empty else 1)
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
