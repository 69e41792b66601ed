"""Backups of a lab: its database and its motions together, made while people work, and put back elsewhere.

A backup is a folder: ``rows.jsonl`` (all rows, in the same form for every kind of database), ``motions``, ``studies``,
the accounts, and ``manifest.json`` with the SHA-256 of each file. The rows are read in one transaction and
the files copied after it. A finished run has its files before its row, and loses its row before its files, so what is
missing then was deleted meanwhile: its row is left out.
"""

from __future__ import annotations

import fcntl
import hashlib
import json
import os
import shutil
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sqlalchemy import Connection, Engine, MetaData, inspect, text

from motion import InputError
from motion.formats.files import replacing
from webdemo.server.audit import audit

from .migrations import NEWEST, REVISIONS, revision_of, upgrade

FORMAT = "pas-de-deux-backup-1"
PREFIX = "pas-de-deux-"
ROWS, MANIFEST, ACCOUNTS = "rows.jsonl", "manifest.json", "users"
LEFT_OUT = {"alembic_version", "places", "processes", "endings", "sessions"}
"""Tables of the moment. Sign-ins are left out so that none comes back that was ended: people sign in again."""
_FOLDERS = ("motions", "studies")
_ROWS_OF = {"motions": "runs", "studies": "studies"}


@dataclass(frozen=True)
class Lab:
    """The places that a backup is made of, and restored to.

    Attributes:
        engine: connections to the database.
        data: the data folder.
        users: the file of accounts; None without accounts.
    """

    engine: Engine
    data: Path
    users: Path | None


def back_up(lab: Lab, folder: Path, *, keep: int = 0) -> Path:
    """Makes a backup in a folder of its own below ``folder``; nothing half-made has its name.

    Args:
        lab: to be backed up.
        folder: holds all backups.
        keep: newest backups that stay; 0: all.

    Returns:
        the backup's folder.

    Raises:
        InputError: if the folder cannot be written, or another process makes a backup there.
    """
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        with _alone(folder):
            name = PREFIX + time.strftime("%Y-%m-%dT%H%M%SZ", time.gmtime())
            half = folder / f".{name}"
            shutil.rmtree(half, ignore_errors=True)
            try:
                half.mkdir(mode=0o700)
                runs = _write(lab, half)
                os.replace(half, folder / name)
            finally:
                shutil.rmtree(half, ignore_errors=True)
            for old in backups(folder)[:-keep] if keep else []:
                shutil.rmtree(old)
    except OSError as error:
        raise InputError(
            f"The backup cannot be written to {folder} ({error.strerror or error}): choose another, or make room."
        ) from None
    audit("backup", folder=name, runs=runs)
    return folder / name


def backups(folder: Path) -> list[Path]:
    """All finished backups in a folder, the oldest first."""
    return sorted(path for path in folder.glob(f"{PREFIX}*") if (path / MANIFEST).is_file())


def back_up_if_due(lab: Lab, folder: Path, *, hours: float, keep: int) -> Path | None:
    """Makes a backup if the newest is older than that; None if there was nothing to do."""
    newest = max((path.stat().st_mtime for path in backups(folder)), default=0.0)
    if abs(time.time() - newest) < hours * 3600:
        return None
    return back_up(lab, folder, keep=keep)


def restore(backup: Path, lab: Lab) -> dict[str, Any]:
    """Puts a backup into an empty data folder and an empty database of any kind, and migrates it to this version.

    Returns:
        the numbers of rows by table, and of files.

    Raises:
        InputError: if the backup is damaged or newer than this version, or there is anything where it would go. Then
            nothing is written.
    """
    manifest = _checked(backup)
    if inspect(lab.engine).get_table_names():
        raise InputError("The database is not empty: restore into an empty one, and switch over then.")
    if taken := [name for name in _FOLDERS if (lab.data / name).exists() and any((lab.data / name).iterdir())]:
        raise InputError(f"The data folder {lab.data} holds {' and '.join(taken)} already: restore into an empty one.")
    if (backup / ACCOUNTS).is_file() and lab.users is not None and lab.users.exists():
        raise InputError(f"There is a file of accounts {lab.users} already: move it away first.")
    upgrade(lab.engine, manifest["revision"])
    try:
        counts = _fill(lab.engine, backup / ROWS)
    except BaseException:
        _empty(lab.engine)
        raise
    upgrade(lab.engine)
    for name in _FOLDERS:
        if (backup / name).is_dir():
            shutil.copytree(backup / name, lab.data / name, dirs_exist_ok=True)
    if (backup / ACCOUNTS).is_file() and lab.users is not None:
        with replacing(lab.users) as temporary:
            shutil.copyfile(backup / ACCOUNTS, temporary)
        os.chmod(lab.users, 0o600)
    return {"rows": counts, "files": len(manifest["files"])}


# ---- writing ---------------------------------------------------------------------------------------


def _write(lab: Lab, half: Path) -> int:
    """Writes all of a backup; returns its number of runs."""
    rows = _rows(lab.engine)
    there: dict[str, set[str]] = {}
    for name in _FOLDERS:
        there[name] = _copied(lab.data / name, half / name)
    gone = {
        row["id"]
        for name, table in _ROWS_OF.items()
        for row in rows.get(table, ())
        if row["id"] not in there[name] and (table != "runs" or row["state"] == "done")
    }
    kept = {
        table: [row for row in found if not gone & {row.get("id"), row.get("run_id"), row.get("study_id")}]
        for table, found in rows.items()
    }
    raters = {row["id"] for row in kept.get("raters", ())}
    kept["ballots"] = [row for row in kept.get("ballots", ()) if row["rater_id"] in raters]
    with open(half / ROWS, "w", encoding="utf-8") as file:
        for table, found in kept.items():
            file.writelines(json.dumps([table, row]) + "\n" for row in found)
    if lab.users is not None and lab.users.exists():
        shutil.copyfile(lab.users, half / ACCOUNTS)
        os.chmod(half / ACCOUNTS, 0o600)
    files = {path.relative_to(half).as_posix(): _sha256(path) for path in half.rglob("*") if path.is_file()}
    manifest = {"format": FORMAT, "revision": revision_of(lab.engine), "made": time.time(), "files": files}
    (half / MANIFEST).write_text(json.dumps(manifest), encoding="utf-8")
    return len(kept.get("runs", ()))


def _rows(engine: Engine) -> dict[str, list[dict[str, Any]]]:
    """All rows by table, as they were at one moment; tables that others refer to come first."""
    with engine.connect() as connection:
        if engine.dialect.name == "sqlite":
            connection.exec_driver_sql("BEGIN")
        else:
            connection = connection.execution_options(isolation_level="REPEATABLE READ")
        tables = MetaData()
        tables.reflect(connection)
        return {
            table.name: [dict(row) for row in connection.execute(table.select()).mappings()]
            for table in tables.sorted_tables
            if table.name not in LEFT_OUT
        }


def _copied(source: Path, target: Path) -> set[str]:
    """Copies a folder's entries but hidden ones, which are half-written; returns the names of those that are whole."""
    names = set()
    target.mkdir(mode=0o700)
    for path in sorted(source.iterdir()) if source.is_dir() else []:
        if path.name.startswith("."):
            continue
        try:
            if path.is_dir():
                shutil.copytree(path, target / path.name)
            else:
                shutil.copy2(path, target / path.name)
            names.add(path.name)
        except (FileNotFoundError, shutil.Error):  # deleted meanwhile
            if path.exists():
                raise
            shutil.rmtree(target / path.name, ignore_errors=True)
    return names


# ---- reading ---------------------------------------------------------------------------------------


def _checked(backup: Path) -> dict[str, Any]:
    """A backup's manifest; raises InputError unless all its files are there and unchanged."""
    try:
        manifest = json.loads((backup / MANIFEST).read_text(encoding="utf-8"))
        files = dict(manifest["files"])
        revision, form = manifest["revision"], manifest["format"]
    except (OSError, ValueError, KeyError, TypeError):
        raise InputError(f"{backup} is no backup: name a folder that `backup` made.") from None
    if form != FORMAT or revision not in REVISIONS:
        raise InputError(
            f"The backup is of a newer version (revision {revision!r:.20}; this one knows {NEWEST}): restore it there."
        )
    for name, digest in files.items():
        path = backup / name
        if not path.is_file() or _sha256(path) != digest:
            raise InputError(f"The backup is damaged: {name} is missing or has changed. Take another one.")
    return manifest


def _fill(engine: Engine, file: Path) -> dict[str, int]:
    counts: dict[str, int] = {}
    tables = MetaData()
    with engine.begin() as connection, open(file, encoding="utf-8") as lines:
        tables.reflect(connection)
        waiting: list[dict[str, Any]] = []
        before = ""
        for line in lines:
            table, row = json.loads(line)
            if waiting and (table != before or len(waiting) == 500):
                connection.execute(tables.tables[before].insert(), waiting)
                waiting = []
            waiting.append(row)
            before = table
            counts[table] = counts.get(table, 0) + 1
        if waiting:
            connection.execute(tables.tables[before].insert(), waiting)
        _continue_numbers(connection, tables)
    return counts


def _continue_numbers(connection: Connection, tables: MetaData) -> None:
    """Lets PostgreSQL number new rows after those that came with their numbers."""
    if connection.dialect.name != "postgresql" or "raters" not in tables.tables:
        return
    following = "(SELECT coalesce(max(id), 0) + 1 FROM raters)"
    after = f"SELECT setval(pg_get_serial_sequence('raters', 'id'), {following}, false)"
    connection.execute(text(after))


def _empty(engine: Engine) -> None:
    tables = MetaData()
    tables.reflect(engine)
    tables.drop_all(engine)


@contextmanager
def _alone(folder: Path) -> Iterator[None]:
    """Holds a folder of backups; raises InputError if another process does."""
    with open(folder / ".lock", "ab") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise InputError(f"Another process is making a backup in {folder}: wait for it.") from None
        yield


def _sha256(path: Path) -> str:
    with open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
