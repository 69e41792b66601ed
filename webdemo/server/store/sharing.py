"""What shows a run to others until it ends: links, for the people of the lab, and public pages, for anybody."""

from __future__ import annotations

import secrets
import time
from collections.abc import Sequence
from typing import Any, cast

from sqlalchemy import CursorResult, delete, select
from sqlalchemy.orm import Session

from motion import InputError
from webdemo.server.audit import audit, fingerprint
from webdemo.ui.history import Opened, PublicPage

from .database import Run, Share, entry_of, sentences
from .history import DAY, History

LINK_DAYS = 30
"""For which a link lasts."""
_ENDED = "There is no such page, or it has ended: ask the person who sent it to you."
_OFF = "This lab makes no public pages: the person who runs it can set PASDEDEUX_PUBLISH_DAYS."


class Sharing(History):
    """A history whose owners can show runs to others.

    Args:
        publish_days: for which a public page lasts; 0 where there are none.
        history: see :class:`History`.
    """

    def __init__(self, *history: Any, publish_days: float = 30, **more: Any) -> None:
        super().__init__(*history, **more)
        self.publish_days = publish_days

    def link(self, run: str, owner: str) -> tuple[str, float]:
        """The link to a finished run: its key, and when it ends (seconds since 1970)."""
        share = self._share(run, owner, public=False)
        return share.key, share.until

    def publish(self, run: str, owner: str) -> PublicPage:
        """The public page of a finished run."""
        if not self.publish_days:
            raise InputError(_OFF)
        return _page(self._share(run, owner, public=True))

    @sentences()
    def _share(self, run: str, owner: str, *, public: bool) -> Share:
        """What shows a run, made where there is nothing; it lasts all its days from now on."""
        now, days = time.time(), self.publish_days if public else LINK_DAYS
        with self.database.session.begin() as session:
            row = self._own(session, run, owner)
            if row.state != "done":
                raise InputError(f"This run has no result to show: it is {row.state}.")
            there = (Share.run_id == run, Share.public == public, Share.until > now)
            share = session.scalar(select(Share).where(*there)) or Share(key=secrets.token_urlsafe(18), public=public)
            share.run, share.until = row, now + days * DAY
            session.add(share)
        audit("page-published" if public else "link-made", run=run, link=fingerprint(share.key))
        return share

    @sentences()
    def revoke(self, run: str, owner: str) -> int:
        """Ends the link to a run; returns how many there were."""
        with self.database.session.begin() as session:
            ended = _end(session, Share.run_id == self._own(session, run, owner).id, ~Share.public)
        audit("links-ended", run=run, count=ended)
        return ended

    @sentences()
    def pages(self, owner: str) -> Sequence[PublicPage]:
        """The owner's public pages that have not ended, newest first."""
        mine = (Run.owner == owner, Run.owner != "", Run.removed.is_(None), Share.public, Share.until > time.time())
        query = select(Share).join(Run).where(*mine).order_by(Share.created.desc(), Share.key)
        with self.database.session() as session:
            return [_page(share) for share in session.scalars(query)]

    @sentences()
    def end_page(self, key: str, owner: str) -> None:
        """Ends a public page; raises InputError if it is not the owner's."""
        mine = select(Run.id).where(Run.owner == owner, Run.owner != "")
        with self.database.session.begin() as session:
            if not _end(session, Share.key == key, Share.public, Share.run_id.in_(mine)):
                raise InputError("You have no such public page: reload the list.")
        audit("page-ended", link=fingerprint(key))

    @sentences()
    def open_page(self, key: str) -> tuple[Opened, float]:
        """A public page's result, and when the page ends, in seconds since 1970.

        Raises:
            InputError: the same sentence for no page, an ended one, and one whose result was removed.
        """
        stands = (Share.key == key, Share.public, Share.until > time.time(), Run.removed.is_(None))
        with self.database.session() as session:
            row = session.execute(select(Run, Share.until).join(Share).where(*stands)).first()
        there = bool(self.publish_days) and row is not None
        audit("page-opened", ok=there, link=fingerprint(key))
        if row is None or not there:
            raise InputError(_ENDED)
        return self._opened(row[0]), row[1]


def _end(session: Session, *where: Any) -> int:
    return cast(CursorResult[Any], session.execute(delete(Share).where(*where))).rowcount


def _page(share: Share) -> PublicPage:
    title = entry_of(share.run).title
    return PublicPage(key=share.key, title=title, created=share.created, until=share.until)
