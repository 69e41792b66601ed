"""A database's file: made once, of one schema, and sound."""

from __future__ import annotations

import sqlite3
from contextlib import closing
from pathlib import Path

import pytest

from motion import InputError
from tests.server.attacks.target import READY
from webdemo.server.store.database import Database


@pytest.mark.parametrize("schema", [0, 99])
def test_that_of_another_version_is_left_alone(schema: int, tmp_path: Path) -> None:
    file = tmp_path / "history.db"
    Database(file).close()
    with closing(sqlite3.connect(file)) as connection:
        connection.execute(f"PRAGMA user_version = {schema}")
    with pytest.raises(InputError, match=rf"another version of Pas de Deux \(schema {schema};"):
        Database(file)


def _open(file: Path) -> None:
    Database(file).close()


def test_several_processes_open_a_new_one_at_once(tmp_path: Path) -> None:
    processes = [READY.Process(target=_open, args=(tmp_path / "history.db",)) for _ in range(3)]
    for process in processes:
        process.start()
    for process in processes:
        process.join()
    assert [process.exitcode for process in processes] == [0, 0, 0]


def test_one_damaged_page_ends_the_start_in_a_sentence(tmp_path: Path) -> None:
    file = tmp_path / "history.db"
    Database(file).close()
    whole = bytearray(file.read_bytes())
    size = int.from_bytes(whole[16:18], "big")
    refused = 0
    for page in range(len(whole) // size):
        file.write_bytes(whole[: page * size] + b"\xff" * size + whole[(page + 1) * size :])
        try:
            Database(file).close()
        except InputError as error:
            refused += 1
            assert "restore a backup" in str(error) and "\n" not in str(error)
    assert refused > 20
