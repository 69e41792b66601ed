"""Databases of every earlier version, brought up to date, and back."""

from __future__ import annotations

import json
import multiprocessing
import sqlite3
from contextlib import closing
from pathlib import Path

import pytest
from alembic.autogenerate import compare_metadata
from alembic.migration import MigrationContext
from sqlalchemy import create_engine, inspect, select, text

from motion import InputError
from tests.server.clients import DATABASES, database_url
from webdemo.cli import main
from webdemo.server import activity
from webdemo.server.queue import places, shares
from webdemo.server.store import ledger
from webdemo.server.store.database import Ballot, Database, Link, Note, Run, SignIn, Study, Table
from webdemo.server.store.history import History
from webdemo.server.store.migrations import NEWEST, REVISIONS, downgrade, revision_of, upgrade

TABLES = {Table, activity.Process, places.Place, shares.Work, ledger.Ledger}
"""Imported for their metadata."""
SCHEMAS = sorted((Path(__file__).parent / "schemas").glob("*.sql"))
"""Dumps of databases that earlier versions made, each with a row in each table."""


def of_version(schema: Path, folder: Path) -> str:
    """The URL of a database as an earlier version left it."""
    file = folder / "history.db"
    with closing(sqlite3.connect(file)) as database:
        database.executescript(schema.read_text())
    return f"sqlite:///{file}"


@pytest.mark.parametrize("schema", SCHEMAS, ids=lambda path: path.stem)
def test_a_database_of_every_version_is_read(schema: Path, tmp_path: Path) -> None:
    url = of_version(schema, tmp_path)
    database = Database(url)
    database.check()
    history = History(database, tmp_path / "motions")
    (entry,) = history.entries("user ada")
    assert (entry.favourite, entry.created, entry.links) == (True, 1.7e9, 1)
    old = schema.read_text()
    with database.session() as session:
        run = session.scalars(select(Run)).one()
        assert run.stored == run.created and run.address == ""
        assert session.scalars(select(Link)).one().run_id == run.id
        assert [note.title for note in session.scalars(select(Note))] == ["The hug"] * ("TABLE notes" in old)
        assert len(session.scalars(select(SignIn)).all()) == ("TABLE sessions" in old)
        assert [study.title for study in session.scalars(select(Study))] == ["Which?"] * (
            "TABLE studies" in old
        )
        assert [vote.answer for vote in session.scalars(select(Ballot))] == ["first"] * (
            "TABLE studies" in old
        )
    assert revision_of(database.engine) == NEWEST
    database.close()
    with closing(sqlite3.connect(f"{tmp_path / 'history.db'}.before-{NEWEST}")) as copy:
        assert "\n".join(copy.iterdump()) + "\n" == old  # to go back to that version


@pytest.mark.parametrize("kind", DATABASES)
def test_a_new_database_is_as_the_tables_say(kind: str, tmp_path: Path) -> None:
    """A table or column without a migration, or a migration of something else, is a difference."""
    database = Database(database_url(kind, tmp_path))
    with database.engine.connect() as connection:
        assert not compare_metadata(MigrationContext.configure(connection), Table.metadata)
    database.close()
    assert not list(tmp_path.glob("*.before-*"))  # an empty one is not copied


@pytest.mark.parametrize("schema", SCHEMAS, ids=lambda path: path.stem)
def test_a_migrated_database_is_as_a_new_one(schema: Path, tmp_path: Path) -> None:
    database = Database(of_version(schema, tmp_path))
    with database.engine.connect() as connection:
        found = compare_metadata(MigrationContext.configure(connection), Table.metadata)
    left = ("sign_ins", "ix_sign_ins_person")  # of the first versions: nobody reads it any more
    assert not [change for change in found if not any(name in str(change) for name in left)]
    database.close()


def test_revisions_go_back_one_by_one_and_forward_again(tmp_path: Path) -> None:
    database = Database(of_version(SCHEMAS[-1], tmp_path))
    tables = set(inspect(database.engine).get_table_names())
    for revision in reversed(REVISIONS[:-1]):
        downgrade(database.engine, revision)
        assert revision_of(database.engine) == revision
    upgrade(database.engine)
    assert set(inspect(database.engine).get_table_names()) == tables
    assert History(database, tmp_path / "motions").entries("user ada")
    with pytest.raises(InputError, match="cannot go back"):
        downgrade(database.engine, "9999")
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


def test_a_migration_that_fails_leaves_what_was(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    url = of_version(SCHEMAS[0], tmp_path)
    with closing(sqlite3.connect(tmp_path / "history.db")) as database:
        database.execute("CREATE TABLE ix_notes_removed (x)")  # the name of an index that is made late
        before = "\n".join(database.iterdump())
    with pytest.raises(InputError, match="cannot be opened"):
        Database(url)
    with closing(sqlite3.connect(tmp_path / "history.db")) as database:
        assert "\n".join(database.iterdump()) == before


def _open(url: str) -> None:
    Database(url).close()


def test_several_processes_migrate_at_once(tmp_path: Path) -> None:
    url = of_version(SCHEMAS[3], tmp_path)
    context = multiprocessing.get_context("spawn")
    processes = [context.Process(target=_open, args=(url,)) for _ in range(3)]
    for process in processes:
        process.start()
    for process in processes:
        process.join()
    assert [process.exitcode for process in processes] == [0, 0, 0]


def test_the_shell_shows_migrates_and_goes_back(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("PASDEDEUX_DATA", str(tmp_path))
    assert main(["database"]) == 2 and "no lab's history" in capsys.readouterr().err
    of_version(SCHEMAS[0], tmp_path)
    for command, revision in (("show", ""), ("upgrade", NEWEST), (f"downgrade {REVISIONS[0]}", REVISIONS[0])):
        assert main(["database", *command.split()]) == 0
        assert json.loads(capsys.readouterr().out.splitlines()[-1])["revision"] == revision
    assert main(["database", "downgrade"]) == 2 and "Name the revision" in capsys.readouterr().err
