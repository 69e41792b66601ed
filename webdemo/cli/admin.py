"""The commands that keep a lab: ``admin``, ``backup`` and ``restore``."""

from __future__ import annotations

import argparse
from contextlib import closing
from dataclasses import asdict
from pathlib import Path
from typing import Any

from motion import InputError

_ACTIONS = ("list", "make-admin", "end-admin", "room", "suspend", "let-in", "sign-out", "delete")


def add_admin(commands: Any) -> None:
    """Adds ``admin`` to the shell's commands."""
    parser = commands.add_parser("admin", help="people's use, rooms and roles; suspend, sign out, delete")
    parser.add_argument("action", choices=_ACTIONS)
    parser.add_argument("name", nargs="?", help="of the account; not for list")
    parser.add_argument("--megabytes", type=float, help="with room: the person's room; without it, everybody's")
    parser.set_defaults(job=admin)


def admin(options: argparse.Namespace) -> dict[str, Any]:
    """Does one act in the lab that the settings name; a running server heeds it at once."""
    from webdemo.server.accounts.users import Users
    from webdemo.server.lab import administration_of
    from webdemo.server.settings import read_settings
    from webdemo.server.store.database import Database, sentences

    settings, name, action = read_settings(), options.name or "", options.action
    if not settings.accounts:
        raise InputError("There are no accounts: set PASDEDEUX_USERS to their file.")
    if action != "list" and not name:
        raise InputError(f"Name the account: `admin {action} NAME`.")
    with closing(Database(settings.database_url)) as database, sentences():
        acts = administration_of(settings, database, Users(settings.users) if settings.users else None)
        if action == "list":
            return {"people": [asdict(row) for row in acts.rows()]}
        if action in ("make-admin", "end-admin"):
            acts.set_role(name, admin=action == "make-admin")
        elif action == "room":
            acts.set_room(name, options.megabytes)
        elif action in ("suspend", "let-in"):
            acts.suspend(name, suspended=action == "suspend")
        elif action == "sign-out":
            acts.sign_out(name)
        else:
            acts.delete(name)
    return {"done": action, "name": name}


def add_upkeep(commands: Any) -> None:
    """Adds ``backup`` and ``restore`` to the shell's commands."""
    backup_parser = commands.add_parser("backup", help="copy the lab's database and motions, while people work")
    backup_parser.add_argument("folder", type=Path, help="holds all backups; each has a folder of its own in it")
    backup_parser.add_argument("--keep", type=int, default=0, metavar="N", help="remove all but the newest N")
    backup_parser.set_defaults(job=backup)
    restore_parser = commands.add_parser("restore", help="put a backup into an empty data folder")
    restore_parser.add_argument("backup", type=Path, help="a backup, or a folder of backups, whose newest is taken")
    restore_parser.set_defaults(job=restore)


def backup(options: argparse.Namespace) -> dict[str, Any]:
    """Makes a backup of the lab that the settings name."""
    from webdemo.server.settings import settings_of_history
    from webdemo.server.store.backup import Lab, back_up

    settings = settings_of_history()
    if options.keep < 0:
        raise InputError("Give --keep 1 or more, or leave it out to keep all.")
    lab = Lab(settings.database_url, settings.data, settings.users)
    made = back_up(lab, options.folder, keep=options.keep)
    print(f"The backup is in {made}.")
    return {"backup": str(made)}


def restore(options: argparse.Namespace) -> dict[str, Any]:
    """Restores a backup into the empty data folder that the settings name."""
    from webdemo.server.settings import read_settings
    from webdemo.server.store.backup import SUMS, Lab, backups, restore

    chosen = options.backup
    if not (chosen / SUMS).is_file():
        if not (all_of_them := backups(chosen)):
            raise InputError(f"There is no backup in {chosen}: name a folder that `backup` made.")
        chosen = all_of_them[-1]
    settings = read_settings()
    files = restore(chosen, Lab(settings.database_url, settings.data, settings.users))
    print(f"{chosen} was restored to {settings.data}.")
    return {"backup": str(chosen), "files": files}
