"""The command ``study``: the blind studies of a lab, for the person who runs it."""

from __future__ import annotations

import argparse
import time
from contextlib import closing
from pathlib import Path
from typing import Any

from motion import InputError


def add_study(commands: Any) -> None:
    """Adds ``study`` to the shell's commands."""
    parser = commands.add_parser("study", help="blind studies of this lab: list, result, export")
    parser.add_argument("action", choices=("list", "result", "export"))
    parser.add_argument(
        "study", nargs="?", help="id of the study, or how it begins, after -- if with a dash; not for list"
    )
    parser.add_argument("--out", type=Path, help="with export: .csv file to write, a row a vote")
    parser.set_defaults(job=study)


def study(options: argparse.Namespace) -> dict[str, Any]:
    """Lists all studies of the data folder, or gives the result or the votes of one."""
    from webdemo.server.lab import studies_of
    from webdemo.server.settings import settings_of_history
    from webdemo.server.store.database import Database

    settings = settings_of_history()
    if options.action == "export" and options.out is None:
        raise InputError("Name the file to write: give --out FILE.csv.")
    if options.action != "list" and not options.study:
        raise InputError("Give the id of a study: see `study list`.")
    with closing(Database(settings.database_url)) as database:
        studies = studies_of(settings, database)
        everybodys = studies.everybodys()
        if options.action == "list":
            return {"studies": [_about(owner, each) for owner, each in everybodys]}
        found = [pair for pair in everybodys if pair[1].id.startswith(options.study)]
        if len(found) != 1:
            raise InputError(
                f"{len(found)} studies begin with {options.study!r:.40}: see `study list` for their ids."
            )
        ((owner, each),) = found
        if options.action == "export":
            return {"votes": studies.export(each.id, owner, options.out), "files": [str(options.out)]}
        return _about(owner, each) | studies.result(each.id, owner).to_dict()


def _about(owner: str, each: Any) -> dict[str, Any]:
    made = time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime(each.created))
    return {
        "id": each.id, "owner": owner, "title": each.title, "question": each.question, "sets": list(each.sets),
        "pairs": each.pairs, "checks": each.checks, "closed": each.closed, "created": made, "all_votes": each.votes,
    }  # fmt: skip
