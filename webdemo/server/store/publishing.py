"""Public pages: one result, for anybody who knows the address, until it ends."""

from __future__ import annotations

import re
import secrets
import time
from collections.abc import Sequence
from typing import Any, cast

from sqlalchemy import CursorResult, delete, select
from sqlalchemy.orm import selectinload

from motion import InputError
from webdemo.server.audit import audit, fingerprint
from webdemo.ui.history import Opened, PublicPage

from .database import Database, Note, Published, Run, entry_of, is_removed, sentences
from .history import DAY, History

_KEY = re.compile(r"\A[A-Za-z0-9_-]{16,64}\Z")
_ENDED = "There is no such page, or it has ended: ask the person who sent it to you."
_OFF = "This lab makes no public pages: the person who runs it can set PASDEDEUX_PUBLISH_DAYS."


class Publishing:
    """Keeps public pages.

    Args:
        history: of the runs that they show.
        days: for which a page lasts; 0 where there are none.
    """

    def __init__(self, history: History, *, days: float = 30) -> None:
        self.history, self.days = history, days
        self.database: Database = history.database

    # ---- for owners ------------------------------------------------------------------------------

    @sentences()
    def publish(self, owner: str, run: str) -> PublicPage:
        """The page of a finished run, made where it has none; it lasts :attr:`days` from now on.

        Raises:
            InputError: for another person's run, or one without a result.
        """
        if not self.days:
            raise InputError(_OFF)
        now = time.time()
        with self.database.session.begin() as session:
            found = self.history._own(session, run, owner)
            if found.state != "done":
                raise InputError(f"A run without a result cannot be published: this one is {found.state}.")
            page = session.scalar(select(Published).where(Published.run_id == run, Published.until > now))
            if page is None:
                page = Published(key=secrets.token_hex(16), owner=owner, run_id=run, created=now)
                session.add(page)
            page.until = now + self.days * DAY
            title = entry_of(found).title
        audit("page-published", page=fingerprint(page.key), run=run, days=self.days)
        return _page(page, title)

    @sentences()
    def pages(self, owner: str) -> Sequence[PublicPage]:
        """The owner's pages that have not ended, newest first."""
        mine = (Published.owner == owner, Published.owner != "", Published.until > time.time())
        query = (
            select(Published)
            .join(Run)
            .outerjoin(Note)
            .options(_WHOLE)
            .where(*mine, Note.removed.is_(None))
            .order_by(Published.created.desc(), Published.key)
        )
        with self.database.session() as session:
            return [_page(row, entry_of(row.run).title) for row in session.scalars(query)]

    @sentences()
    def revoke(self, key: str, owner: str) -> None:
        """Ends a page; raises InputError if it is not the owner's."""
        with self.database.session.begin() as session:
            mine = (Published.key == key, Published.owner == owner, Published.owner != "")
            ended = cast(CursorResult[Any], session.execute(delete(Published).where(*mine)))
            if not ended.rowcount:
                raise InputError("You have no such public page: reload the list.")
        audit("page-ended", page=fingerprint(key))

    # ---- for anybody -----------------------------------------------------------------------------

    @sentences()
    def open(self, key: str) -> tuple[Opened, float]:
        """A page's result, and when the page ends, in seconds since 1970.

        Raises:
            InputError: the same sentence for no page, an ended one, and one whose result was removed.
        """
        page = None
        if self.days and _KEY.match(key):
            with self.database.session() as session:
                page = session.get(Published, key, options=[_WHOLE])
        there = page is not None and page.until >= time.time() and not is_removed(page.run)
        audit("page-opened", ok=there, page=fingerprint(key))
        if page is None or not there:
            raise InputError(_ENDED)
        # The result alone, not what it was made from.
        return History.open(self.history, page.run_id, page.owner), page.until

    def clean(self) -> None:
        """Deletes pages that have ended, where the clock can be trusted."""
        if self.history.is_steady():
            with self.database.session.begin() as session:
                session.execute(delete(Published).where(Published.until < time.time()))


_WHOLE = selectinload(Published.run).options(selectinload(Run.note), selectinload(Run.links))


def _page(page: Published, title: str) -> PublicPage:
    return PublicPage(key=page.key, title=title, created=page.created, until=page.until)
