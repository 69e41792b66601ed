"""The command ``share``: the public pages of a lab, for the person who runs it."""

from __future__ import annotations

import argparse
import time
from collections.abc import Iterator, Sequence
from contextlib import closing, contextmanager
from typing import Any

from motion import InputError


def add_share(commands: Any) -> None:
    """Adds ``share`` to the shell's commands."""
    parser = commands.add_parser("share", help="public pages of this lab: runs, link, list, revoke")
    actions = parser.add_subparsers(required=True, metavar="ACTION", parser_class=type(parser))
    of_owner = argparse.ArgumentParser(add_help=False)
    of_owner.add_argument("--user", help="account whose runs they are; without accounts, leave it out")

    listed = actions.add_parser("runs", parents=[of_owner], help="the newest runs with their ids")
    listed.set_defaults(job=runs)

    made = actions.add_parser("link", parents=[of_owner], help="make a page of a run and print its address")
    made.add_argument(
        "run", metavar="RUN", help="id of a run, or how it begins, after -- if with a dash; see `share runs`"
    )
    made.add_argument("--days", type=float, help="days until it ends; the most that the lab allows by default")
    made.add_argument("--base", help="address of the lab, as https://lab.example/; its own by default")
    made.set_defaults(job=link)

    pages = actions.add_parser("list", help="all public pages that have not ended")
    pages.set_defaults(job=list_pages)

    ended = actions.add_parser("revoke", help="end a page")
    ended.add_argument("key", help="of the page, or how it begins; see `share list`")
    ended.set_defaults(job=revoke)


@contextmanager
def _publishing() -> Iterator[Any]:
    """The public pages of the lab that the settings name."""
    from webdemo.server.lab import history_of, storage_of
    from webdemo.server.settings import settings_of_history
    from webdemo.server.store.database import Database
    from webdemo.server.store.publishing import Publishing

    settings = settings_of_history()
    with closing(Database(settings.database_url)) as database:
        history = history_of(settings, storage_of(settings, database))
        yield Publishing(history, days=settings.publish_days)


def _owner(options: argparse.Namespace) -> str:
    from webdemo.server.accounts.users import Users
    from webdemo.server.settings import read_settings

    if not options.user:
        return "local"
    file = read_settings().users
    return f"user {(Users(file).key(options.user) if file is not None else None) or options.user}"


def _runs(publishing: Any, options: argparse.Namespace) -> Sequence[Any]:
    """The newest runs of a person."""
    from webdemo.ui.history import Search

    return publishing.history.search(_owner(options), Search(limit=200)).entries


def _only(begin: str, known: Sequence[str], what: str, see: str) -> str:
    found = [each for each in known if each.startswith(begin)]
    if len(found) != 1:
        raise InputError(f"{len(found)} {what} begin with {begin!r:.40}: see `{see}` for their ids.")
    return found[0]


def runs(options: argparse.Namespace) -> dict[str, Any]:
    """The newest finished runs of a person."""
    with _publishing() as publishing:
        entries = [entry for entry in _runs(publishing, options) if entry.state == "done"]
    return {"runs": [{"id": e.id, "title": e.title, "created": _moment(e.created)} for e in entries]}


def link(options: argparse.Namespace) -> dict[str, Any]:
    """Makes a page."""
    from webdemo.server.settings import read_settings
    from webdemo.ui.public_html import frame_code

    base = (options.base or read_settings().url).rstrip("/")
    with _publishing() as publishing:
        runs = [entry.id for entry in _runs(publishing, options)]
        run = _only(options.run, runs, "runs", "share runs")
        page = publishing.publish(_owner(options), run, days=options.days)
    address = f"{base}/share/{page.key}"
    print(f"{address} until {_moment(page.until)}")
    return _about(page) | {"address": address, "frame": frame_code(f"{base}/embed/{page.key}", page.title)}


def list_pages(options: argparse.Namespace) -> dict[str, Any]:
    """All pages that have not ended, with their owners."""
    with _publishing() as publishing:
        pages = publishing.everybodys()
    return {"pages": [{"owner": owner.partition("#")[0]} | _about(page) for owner, page in pages]}


def revoke(options: argparse.Namespace) -> dict[str, Any]:
    """Ends a page of anybody's."""
    with _publishing() as publishing:
        owners = {page.key: owner for owner, page in publishing.everybodys()}
        key = _only(options.key, list(owners), "public pages", "share list")
        publishing.revoke(key, owners[key])
    return {"revoked": key}


def _about(page: Any) -> dict[str, Any]:
    return {"key": page.key, "title": page.title, "created": _moment(page.created), "until": _moment(page.until)}


def _moment(seconds: float) -> str:
    return time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime(seconds))
