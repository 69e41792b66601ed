"""Backups of a lab: its database and its motions together, made while people work, and put back elsewhere.

A backup is a folder: ``history.db`` (SQLite's online backup), ``motions``, ``studies``, the accounts, and
``SHA256SUMS`` of all of them. The database is copied first and the files after it. A finished run has its files before
its row, and loses its row before its files, so what is missing then was deleted meanwhile: its row is left out.
"""

from __future__ import annotations

import fcntl
import hashlib
import os
import shutil
import sqlite3
import time
from collections.abc import Iterator
from contextlib import closing, contextmanager
from dataclasses import dataclass
from pathlib import Path

from sqlalchemy import make_url

from motion import InputError
from webdemo.server.audit import audit

from .database import Database

PREFIX = "pas-de-deux-"
DATABASE, SUMS, ACCOUNTS = "history.db", "SHA256SUMS", "users"
_FOLDERS = {"motions": "SELECT id FROM runs WHERE state = 'done'", "studies": "SELECT id FROM studies"}
"""Folders, and the rows that have a folder in each."""


@dataclass(frozen=True)
class Lab:
    """The places that a backup is made of, and restored to.

    Attributes:
        url: of the database.
        data: the data folder.
        users: the file of accounts; None without accounts.
    """

    url: str
    data: Path
    users: Path | None

    @property
    def database(self) -> Path:
        """SQLite's file.

        Raises:
            InputError: for another database.
        """
        url = make_url(self.url)
        if url.get_backend_name() != "sqlite" or not url.database:
            raise InputError(
                "Only SQLite is backed up here: use your database's own command, and copy the data folder after it."
            )
        return Path(url.database)


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
    source, name = lab.database, PREFIX + time.strftime("%Y-%m-%dT%H%M%SZ", time.gmtime())
    half = folder / f".{name}"
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        with _alone(folder):
            shutil.rmtree(half, ignore_errors=True)
            try:
                half.mkdir(mode=0o700)
                _write(source, lab, half)
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
    return sorted(path for path in folder.glob(f"{PREFIX}*") if (path / SUMS).is_file())


def restore(backup: Path, lab: Lab) -> int:
    """Puts a backup into an empty data folder, and migrates it to this version; returns the number of files.

    Raises:
        InputError: if the backup is damaged or newer than this version, or there is anything where it would go. Then
            nothing is written.
    """
    files = _checked(backup)
    taken = [lab.database, *(lab.data / name for name in _FOLDERS if any((lab.data / name).glob("*")))]
    taken += [lab.users] if lab.users is not None and (backup / ACCOUNTS).is_file() else []
    if there := [str(path) for path in taken if path.exists()]:
        raise InputError(f"There is {' and '.join(there)} already: restore into an empty folder, and switch over then.")
    half = lab.database.with_name(".restored")
    try:
        half.mkdir(mode=0o700, parents=True, exist_ok=True)
        shutil.copyfile(backup / DATABASE, half / DATABASE)
        Database(f"sqlite:///{half / DATABASE}").close()  # migrates it, or refuses a newer one
        os.replace(half / DATABASE, lab.database)
    finally:
        shutil.rmtree(half, ignore_errors=True)
    for name in _FOLDERS:
        if (backup / name).is_dir():
            shutil.copytree(backup / name, lab.data / name, dirs_exist_ok=True)
    if lab.users is not None and (backup / ACCOUNTS).is_file():
        shutil.copyfile(backup / ACCOUNTS, lab.users)
        os.chmod(lab.users, 0o600)
    return files


def _write(source: Path, lab: Lab, half: Path) -> None:
    """Writes all of a backup."""
    with closing(sqlite3.connect(source)) as live, closing(sqlite3.connect(half / DATABASE)) as copy:
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
    files = sorted(path for path in half.rglob("*") if path.is_file())
    sums = "".join(f"{_sha256(path)}  {path.relative_to(half).as_posix()}\n" for path in files)
    (half / SUMS).write_text(sums, encoding="utf-8")


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


def _checked(backup: Path) -> int:
    """The number of a backup's files; raises InputError unless all are there and unchanged."""
    try:
        lines = (backup / SUMS).read_text(encoding="utf-8").splitlines()
    except OSError:
        raise InputError(f"{backup} is no backup: name a folder that `backup` made.") from None
    for line in lines:
        digest, _, name = line.partition("  ")
        if not (backup / name).is_file() or _sha256(backup / name) != digest:
            raise InputError(f"The backup is damaged: {name} is missing or has changed. Take another one.")
    return len(lines)


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
