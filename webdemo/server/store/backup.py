"""Backups of a lab: its database and its motions together, made while people work, and put back elsewhere.

A backup is a folder: ``history.db`` (SQLite's online backup), ``motions``, ``studies`` and the accounts. The database
is copied first and the files after it. A finished run has its files before its row, and loses its row before its
files, so what is missing then was deleted meanwhile: its row is left out.
"""

from __future__ import annotations

import fcntl
import os
import shutil
import sqlite3
import time
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path

from motion import InputError
from webdemo.server.audit import audit
from webdemo.server.settings import Settings

from .database import Database

PREFIX = "pas-de-deux-"
DATABASE, ACCOUNTS = "history.db", "users"
_FOLDERS = {"motions": "SELECT id FROM runs WHERE state = 'done'", "studies": "SELECT id FROM studies"}
"""Folders, and the rows that have a folder in each."""


def back_up(lab: Settings, folder: Path, *, keep: int = 0) -> Path:
    """Makes a backup in a folder of its own below ``folder``; nothing half-made has its name.

    Args:
        lab: whose data folder and file of accounts are copied.
        folder: holds all backups.
        keep: newest backups that stay; 0: all.

    Returns:
        the backup's folder.

    Raises:
        InputError: if the folder cannot be written, or another process makes a backup there.
    """
    name = PREFIX + time.strftime("%Y-%m-%dT%H%M%SZ", time.gmtime())
    half = folder / f".{name}"
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        with _alone(folder):
            shutil.rmtree(half, ignore_errors=True)
            try:
                half.mkdir(mode=0o700)
                _write(lab, half)
                os.replace(half, folder / name)
            finally:
                shutil.rmtree(half, ignore_errors=True)
            for old in backups(folder)[:-keep] if keep else []:
                shutil.rmtree(old)
    except (OSError, sqlite3.Error) as error:
        reason = getattr(error, "strerror", None) or error
        raise InputError(
            f"The backup cannot be written to {folder} ({reason}): choose another, or make room."
        ) from None
    audit("backup", folder=name)
    return folder / name


def backups(folder: Path) -> list[Path]:
    """All finished backups in a folder, the oldest first."""
    return sorted(path for path in folder.glob(f"{PREFIX}*") if (path / DATABASE).is_file())


def restore(backup: Path, lab: Settings) -> None:
    """Puts a backup into the empty data folder of a lab.

    Raises:
        InputError: if the backup is damaged or another version's, or there is anything where it would go. Then
            nothing is written.
    """
    accounts = [backup / ACCOUNTS] if lab.users is not None and (backup / ACCOUNTS).is_file() else []
    taken = [lab.database, *(lab.data / name for name in _FOLDERS if any((lab.data / name).glob("*")))]
    taken += [lab.users] if lab.users is not None and accounts else []
    if there := [str(path) for path in taken if path.exists()]:
        raise InputError(f"There is {' and '.join(there)} already: restore into an empty folder, and switch over then.")
    half = lab.database.with_name(".restored")
    try:
        half.mkdir(mode=0o700, parents=True, exist_ok=True)
        for path in (backup / DATABASE, *accounts):
            shutil.copyfile(path, half / path.name)
        for name in _FOLDERS:
            shutil.copytree(backup / name, half / name)
        Database(half / DATABASE).close()  # refuses a damaged one, and that of another version
        _check(half)
        for name in (DATABASE, *_FOLDERS):
            shutil.rmtree(lab.data / name, ignore_errors=True)  # an empty folder
            os.replace(half / name, lab.data / name)
        if lab.users is not None and accounts:
            shutil.copyfile(half / ACCOUNTS, lab.users)
            os.chmod(lab.users, 0o600)
    except OSError as error:
        raise InputError(f"{backup} cannot be restored ({error.strerror}): name a folder that `backup` made.") from None
    finally:
        shutil.rmtree(half, ignore_errors=True)


def _check(folder: Path) -> None:
    """Raises InputError for a row whose files are missing."""
    with closing(sqlite3.connect(folder / DATABASE)) as database:
        for name, rows in _FOLDERS.items():
            for (key,) in database.execute(rows):
                if not any((folder / name / key).glob("*.npz")):
                    raise InputError(f"The backup is damaged: {name}/{key} is missing. Take another one.")


def _write(lab: Settings, half: Path) -> None:
    """Writes all of a backup."""
    with closing(sqlite3.connect(lab.database)) as live, closing(sqlite3.connect(half / DATABASE)) as copy:
        live.backup(copy)
        copy.execute("PRAGMA foreign_keys=ON")
        for name, rows in _FOLDERS.items():
            _copy(lab.data / name, half / name)
            gone = [(key,) for (key,) in copy.execute(rows) if not (half / name / key).is_dir()]
            copy.executemany(f"DELETE FROM {'runs' if name == 'motions' else name} WHERE id = ?", gone)
        copy.execute("DELETE FROM sessions")  # so that no sign-in comes back that was ended
        copy.commit()
        copy.execute("PRAGMA journal_mode=DELETE")  # one file
    if lab.users is not None and lab.users.exists():
        shutil.copyfile(lab.users, half / ACCOUNTS)
        os.chmod(half / ACCOUNTS, 0o600)


def _copy(source: Path, target: Path) -> None:
    """Copies the folders in a folder but hidden ones, which are half-written, and those deleted meanwhile."""
    target.mkdir(mode=0o700)
    for path in sorted(source.glob("[!.]*")):
        try:
            shutil.copytree(path, target / path.name)
        except (FileNotFoundError, shutil.Error):
            if path.exists():
                raise
            shutil.rmtree(target / path.name, ignore_errors=True)


@contextmanager
def _alone(folder: Path) -> Iterator[None]:
    """Holds a folder of backups; raises InputError if another process does."""
    with open(folder / ".lock", "ab") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise InputError(f"Another process is making a backup in {folder}: wait for it.") from None
        yield
