"""Backups of a lab: its database and its motions together, made while people work.

A backup is a data folder: ``history.db`` (SQLite's online backup), ``motions`` and ``studies``. A server that is
started on a copy of it goes on from there. The database is copied first and the files after it. A finished run has its
files before its row, and loses its row before its files, so what is missing then was deleted meanwhile: its row is left
out.
"""

from __future__ import annotations

import shutil
import sqlite3
import time
from contextlib import closing
from pathlib import Path

from motion import InputError
from webdemo.server.audit import audit
from webdemo.server.settings import Settings

from .folders import hold, whole

PREFIX = "pas-de-deux-"
DATABASE = "history.db"
_FOLDERS = {"motions": "SELECT id FROM runs WHERE state = 'done'", "studies": "SELECT id FROM studies"}
"""Folders, and the rows that have a folder in each."""


def back_up(lab: Settings, folder: Path, *, keep: int = 0) -> Path:
    """Makes a backup in a folder of its own below ``folder``; nothing half-made has its name.

    Args:
        lab: whose data folder is copied.
        folder: holds all backups.
        keep: newest backups that stay; 0: all.

    Returns:
        the backup's folder.

    Raises:
        InputError: if the folder cannot be written, another process makes a backup there, or the database is damaged;
            no older backup is removed then.
    """
    name = PREFIX + time.strftime("%Y-%m-%dT%H%M%SZ", time.gmtime())
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        with hold(folder / ".lock", f"Another process is making a backup in {folder}: wait for it."):
            with whole(folder / name) as half:
                _write(lab, half)
            for old in backups(folder)[:-keep] if keep else []:
                shutil.rmtree(old)
    except (OSError, sqlite3.Error) as error:
        if type(error) is sqlite3.DatabaseError:  # SQLite's for a damaged file
            raise InputError(f"{lab.database} is damaged ({error}): no backup is made of it; restore one.") from None
        reason = getattr(error, "strerror", None) or error
        raise InputError(
            f"The backup cannot be written to {folder} ({reason}): choose another, or make room."
        ) from None
    audit("backup", folder=name)
    return folder / name


def backups(folder: Path) -> list[Path]:
    """All finished backups in a folder, the oldest first."""
    return sorted(path for path in folder.glob(f"{PREFIX}*") if (path / DATABASE).is_file())


def _write(lab: Settings, half: Path) -> None:
    """Writes all of a backup."""
    with closing(sqlite3.connect(lab.database)) as live, closing(sqlite3.connect(half / DATABASE)) as copy:
        live.backup(copy)
        if copy.execute("PRAGMA quick_check(1)").fetchone() != ("ok",):
            raise sqlite3.DatabaseError("its pages do not fit together")
        copy.execute("PRAGMA foreign_keys=ON")
        for name, rows in _FOLDERS.items():
            _copy(lab.data / name, half / name)
            gone = [(key,) for (key,) in copy.execute(rows) if not (half / name / key).is_dir()]
            copy.executemany(f"DELETE FROM {'runs' if name == 'motions' else name} WHERE id = ?", gone)
        copy.execute("DELETE FROM sessions")  # so that no sign-in comes back that was ended
        copy.commit()
        copy.execute("PRAGMA journal_mode=DELETE")  # one file


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
