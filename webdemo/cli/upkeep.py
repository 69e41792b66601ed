"""The command that migrates the lab's database: ``database``."""

from __future__ import annotations

import argparse
from typing import Any

from motion import InputError


def add_upkeep(commands: Any) -> None:
    """Adds ``database`` to the shell's commands."""
    parser = commands.add_parser("database", help="the database's revision: show it, migrate, or go back")
    parser.add_argument("action", nargs="?", choices=("show", "upgrade", "downgrade"), default="show")
    parser.add_argument(
        "revision", nargs="?", help="with downgrade: the revision of the version to go back to"
    )
    parser.set_defaults(job=database)


def database(options: argparse.Namespace) -> dict[str, Any]:
    """Shows the revision of the lab's database, brings it to the newest, or takes it back to an earlier one."""
    from webdemo.server.settings import read_settings
    from webdemo.server.store.database import engine_of, opening
    from webdemo.server.store.migrations import NEWEST, REVISIONS, downgrade, revision_of, upgrade

    settings = read_settings()
    if not settings.database and not (settings.data / "history.db").is_file():
        raise InputError(
            f"There is no lab's history in {settings.data}: name its folder with PASDEDEUX_DATA."
        )
    if options.action == "downgrade" and not options.revision:
        raise InputError(f"Name the revision to go back to, one of {', '.join(REVISIONS)}.")
    with opening():
        engine = engine_of(settings.database_url)
        try:
            if options.action == "upgrade":
                upgrade(engine)
            elif options.action == "downgrade":
                downgrade(engine, options.revision)
            revision = revision_of(engine)
        finally:
            engine.dispose()
    print(f"The database is at revision {revision or 'none'}; this version of Pas de Deux has {NEWEST}.")
    return {"revision": revision, "newest": NEWEST, "known": list(REVISIONS)}
