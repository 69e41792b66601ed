"""The acts of administrators from a shell: ``admin``."""

from __future__ import annotations

import argparse
from contextlib import closing
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from motion import InputError

if TYPE_CHECKING:
    from webdemo.server.activity import Activity


def add_admin(commands: Any) -> None:
    """Adds ``admin`` to the shell's commands."""
    parser = commands.add_parser(
        "admin", help="people's use, rooms, roles, runs, health; suspend, sign out, delete, end, announce"
    )
    parser.add_argument(
        "action",
        choices=(
            "list",
            "make-admin",
            "end-admin",
            "room",
            "suspend",
            "let-in",
            "sign-out",
            "delete",
            "announce",
            "jobs",
            "end",
            "health",
        ),
    )
    parser.add_argument(
        "name", nargs="?", help="of the account; with announce: the line (empty: none); with end: the id"
    )
    parser.add_argument("--megabytes", type=float, help="with room: the person's room; without it, everybody's")
    parser.set_defaults(job=admin)


def admin(options: argparse.Namespace) -> dict[str, Any]:
    """Does one act in the lab that the settings name; a running server heeds it at once."""
    from webdemo.server.accounts.users import Users
    from webdemo.server.activity import Activity
    from webdemo.server.lab import administration_of
    from webdemo.server.settings import read_settings
    from webdemo.server.store.database import Database, sentences

    settings, name, action = read_settings(), options.name or "", options.action
    if not settings.accounts:
        raise InputError("There are no accounts: set PASDEDEUX_USERS to their file.")
    if action not in ("list", "announce", "jobs", "health") and not name:
        raise InputError(
            "Give the id: `admin end ID`." if action == "end" else f"Name the account: `admin {action} NAME`."
        )
    with closing(Database(settings.database_url)) as database, sentences():
        if action in ("jobs", "end", "health"):
            return _activity(Activity(database), action, name)
        acts = administration_of(settings, database, Users(settings.users) if settings.users else None)
        if action == "list":
            return {"people": [asdict(row) for row in acts.rows()], "announced": acts.people.announced()}
        if action in ("make-admin", "end-admin"):
            acts.set_role(name, admin=action == "make-admin")
        elif action == "room":
            acts.set_room(name, options.megabytes)
        elif action in ("suspend", "let-in"):
            acts.suspend(name, suspended=action == "suspend")
        elif action == "sign-out":
            acts.sign_out(name)
        elif action == "delete":
            acts.delete(name)
        else:
            acts.announce(name)
    return {"done": action, "name": name}


def _activity(activity: Activity, action: str, key: str) -> dict[str, Any]:
    """Reads what the processes of a running server do, or ends a run or a stream of one."""
    if action == "end":
        activity.end(key)
        return {"done": action, "id": key}
    if action == "jobs":
        return {"jobs": [asdict(item) for item in activity.items()]}
    states = activity.states()
    return {"processes": {node: {k: v for k, v in state.items() if k != "work"} for node, state in states.items()}}
