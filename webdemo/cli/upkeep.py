"""The commands that keep a lab's data: ``backup`` and ``restore``."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from motion import InputError

if TYPE_CHECKING:
    from webdemo.server.settings import Settings
    from webdemo.server.store.backup import Lab


def add_upkeep(commands: Any) -> None:
    """Adds ``backup`` and ``restore`` to the shell's commands."""
    backup_parser = commands.add_parser("backup", help="copy the lab's database and motions, while people work")
    backup_parser.add_argument("folder", type=Path, help="holds all backups; each has a folder of its own in it")
    backup_parser.add_argument("--keep", type=int, default=0, metavar="N", help="remove all but the newest N")
    backup_parser.set_defaults(job=backup)
    restore_parser = commands.add_parser("restore", help="put a backup into an empty data folder and database")
    restore_parser.add_argument("backup", type=Path, help="a backup, or a folder of backups, whose newest is taken")
    restore_parser.set_defaults(job=restore)


def backup(options: argparse.Namespace) -> dict[str, Any]:
    """Makes a backup of the lab that the settings name."""
    from webdemo.server.settings import settings_of_history
    from webdemo.server.store.backup import back_up

    settings = settings_of_history()
    if options.keep < 0:
        raise InputError("Give --keep 1 or more, or leave it out to keep all.")
    with _lab(settings) as lab:
        made = back_up(lab, options.folder, keep=options.keep)
    print(f"The backup is in {made}.")
    return {"backup": str(made)}


def restore(options: argparse.Namespace) -> dict[str, Any]:
    """Restores a backup into the empty data folder and database that the settings name."""
    from webdemo.server.settings import read_settings
    from webdemo.server.store.backup import MANIFEST, backups, restore

    chosen = options.backup
    if not (chosen / MANIFEST).is_file():
        if not (all_of_them := backups(chosen)):
            raise InputError(f"There is no backup in {chosen}: name a folder that `backup` made.")
        chosen = all_of_them[-1]
    settings = read_settings()
    settings.data.mkdir(mode=0o700, parents=True, exist_ok=True)
    with _lab(settings) as lab:
        restored = restore(chosen, lab)
    print(f"{restored['rows'].get('runs', 0)} runs were restored from {chosen} to {settings.data}.")
    return {"backup": str(chosen), **restored}


@contextmanager
def _lab(settings: Settings) -> Iterator[Lab]:
    """The lab of the settings, with its database as it is."""
    from webdemo.server.store.backup import Lab
    from webdemo.server.store.database import engine_of, opening

    with opening():
        engine = engine_of(settings.database_url)
        try:
            yield Lab(engine, settings.data, settings.users)
        finally:
            engine.dispose()
