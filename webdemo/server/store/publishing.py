"""Public pages: one result or a gallery, for anybody who knows the address, until it ends."""

from __future__ import annotations

import re
import secrets
import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, cast

from sqlalchemy import CursorResult, delete, func, select
from sqlalchemy.orm import Session, selectinload

from motion import InputError
from webdemo.server.audit import audit, fingerprint
from webdemo.ui.history import Entry, Opened
from webdemo.ui.sharing import PublicPage

from .database import Database, Note, Published, PublishedRun, Run, sentences
from .entries import entry_of, is_removed
from .history import History
from .ledger import DAY

MOST_RUNS = 60
"""Results on one page."""
MOST_PAGES = 200
"""Pages of one person at a time."""
MOST_EXPORTED = 500
"""Results in one folder of pages."""
LONGEST_TITLE = 200
_KEY = re.compile(r"\A[A-Za-z0-9_-]{16,64}\Z")
_ENDED = "There is no such page, or it has ended: ask the person who sent it to you."
_OFF = "This lab makes no public pages: the person who runs it can set PASDEDEUX_PUBLISH_DAYS."


@dataclass(frozen=True)
class Shown:
    """A public page as its visitors see it.

    Attributes:
        title: above the results.
        until: when it ends, in seconds since 1970.
        entries: the results by their places; those that were removed are left out.
    """

    title: str
    until: float
    entries: dict[int, Entry]


class Publishing:
    """Keeps public pages.

    Args:
        history: of the runs that they show.
        days: for which a page lasts where nothing else is said, and the most; 0 where there are none.
    """

    def __init__(self, history: History, *, days: float = 30) -> None:
        self.history, self.days = history, days
        self.database: Database = history.database

    # ---- for owners ------------------------------------------------------------------------------

    @sentences()
    def publish(
        self, owner: str, runs: Sequence[str], *, title: str = "", days: float | None = None
    ) -> PublicPage:
        """Makes a page of finished runs, in their order.

        Args:
            owner: whose runs they are.
            runs: their ids.
            title: above the results; that of the run where there is only one.
            days: for which the page lasts.

        Raises:
            InputError: for no run, too many, another person's, one without a result, or more days than allowed.
        """
        lasts = self._days(days)
        title, wanted = " ".join(title.split()), list(dict.fromkeys(runs))
        if not 1 <= len(wanted) <= MOST_RUNS:
            raise InputError(f"Choose 1 to {MOST_RUNS} runs for a public page, not {len(wanted)}.")
        if len(title) > LONGEST_TITLE:
            raise InputError(f"The title has {len(title):,} characters: shorten it to {LONGEST_TITLE}.")
        now = time.time()
        with self.database.session.begin() as session:
            self._check_number(session, owner, now)
            found = [self._finished(session, run, owner) for run in wanted]
            title = title or (entry_of(found[0]).title if len(found) == 1 else f"{len(found)} results")
            page = Published(
                key=secrets.token_hex(16), owner=owner, title=title, created=now, until=now + lasts * DAY
            )
            page.runs = [PublishedRun(place=i + 1, run_id=run.id) for i, run in enumerate(found)]
            session.add(page)
        audit(
            "page-published", page=fingerprint(page.key), runs=" ".join(run.id for run in found), days=lasts
        )
        return _page(page, len(found))

    def _days(self, days: float | None) -> float:
        if not self.days:
            raise InputError(_OFF)
        lasts = self.days if days is None else days
        if not 0 < lasts <= self.days:
            raise InputError(f"A public page lasts up to {self.days:g} days here, not {lasts:g}.")
        return lasts

    def _finished(self, session: Session, run: str, owner: str) -> Run:
        found = self.history._own(session, run, owner)
        if found.state != "done":
            raise InputError(f"A run without a result cannot be published: one of these is {found.state}.")
        return found

    def _check_number(self, session: Session, owner: str, now: float) -> None:
        count = session.scalar(
            select(func.count()).select_from(Published).where(Published.owner == owner, Published.until > now)
        )
        if (count or 0) >= MOST_PAGES:
            raise InputError(f"You have {count} public pages already: end one of them first.")

    @sentences()
    def pages(self, owner: str) -> Sequence[PublicPage]:
        """The owner's pages that have not ended, newest first."""
        return [page for whose, page in self._all(Published.owner == owner) if whose and whose == owner]

    @sentences()
    def everybodys(self) -> Sequence[tuple[str, PublicPage]]:
        """The owner and the page, for all that have not ended, newest first."""
        return self._all()

    def _all(self, *conditions: Any) -> list[tuple[str, PublicPage]]:
        shown = (
            select(func.count()).select_from(PublishedRun).join(Run).outerjoin(Note)
            .where(PublishedRun.key == Published.key, Note.removed.is_(None)).scalar_subquery()
        )  # fmt: skip
        query = select(Published, shown).where(Published.until > time.time(), *conditions)
        with self.database.session() as session:
            rows = session.execute(query.order_by(Published.created.desc(), Published.key)).tuples()
            return [(row.owner, _page(row, count)) for row, count in rows]

    @sentences()
    def revoke(self, key: str, owner: str) -> None:
        """Ends a page; raises InputError if it is not the owner's."""
        with self.database.session.begin() as session:
            mine = (Published.key == key, Published.owner == owner, Published.owner != "")
            ended = cast(CursorResult[Any], session.execute(delete(Published).where(*mine)))
            if not ended.rowcount:
                raise InputError("You have no such public page: reload the list.")
        audit("page-ended", page=fingerprint(key))

    def results(self, owner: str, runs: Sequence[str] = ()) -> Sequence[Opened]:
        """Finished runs of the owner's, all of them for none given, newest first, for a folder of pages.

        Raises:
            InputError: for none, too many, or another person's.
        """
        wanted = list(dict.fromkeys(runs)) or self._all_finished(owner)
        if not wanted:
            raise InputError("There is no finished run to make pages of: generate a motion first.")
        if len(wanted) > MOST_EXPORTED:
            raise InputError(f"{len(wanted)} runs are too many for one folder: choose {MOST_EXPORTED}.")
        with sentences(), self.database.session() as session:
            for run in wanted:
                self._finished(session, run, owner)
        return [History.open(self.history, run, owner) for run in wanted]

    @sentences()
    def _all_finished(self, owner: str) -> list[str]:
        mine = (Run.owner == owner, Run.owner != "", Run.state == "done", Note.removed.is_(None))
        query = select(Run.id).outerjoin(Note).where(*mine, func.coalesce(Note.part_of, "") == "")
        with self.database.session() as session:
            return list(session.scalars(query.order_by(Run.created.desc(), Run.id)))

    # ---- for anybody -----------------------------------------------------------------------------

    @sentences()
    def shown(self, key: str) -> Shown:
        """A page by its key; raises one sentence for none, an ended one, and one without a result left."""
        page = self._found(key, told=True)
        entries = {each.place: entry_of(each.run) for each in page.runs if not is_removed(each.run)}
        if not entries:
            raise InputError(_ENDED)
        return Shown(page.title, page.until, entries)

    @sentences()
    def run_of(self, key: str, place: int) -> str:
        """The id of a result, by its place on a page; raises InputError as :meth:`shown`, and where there is none."""
        return self._run(self._found(key), place).id

    def open(self, key: str, place: int) -> Opened:
        """One of a page's results; raises InputError as :meth:`run_of`."""
        with sentences():
            page = self._found(key)
            run = self._run(page, place).id
        return History.open(self.history, run, page.owner)  # the result alone, not what it was made from

    @staticmethod
    def _run(page: Published, place: int) -> Run:
        run = next((each.run for each in page.runs if each.place == place), None)
        if run is None or is_removed(run):
            raise InputError(_ENDED)
        return run

    def _found(self, key: str, *, told: bool = False) -> Published:
        """A page that has not ended; ``told`` writes a line of the audit log about a key that might be one."""
        if not self.days or not _KEY.match(key):
            raise InputError(_ENDED)
        whole = selectinload(Published.runs).selectinload(PublishedRun.run)
        options = (whole.selectinload(Run.note), whole.selectinload(Run.links))
        with self.database.session() as session:
            page = session.get(Published, key, options=options)
        there = page is not None and page.until >= time.time()
        if told:
            audit("page-opened", ok=there, page=fingerprint(key))
        if page is None or not there:
            raise InputError(_ENDED)
        return page

    def clean(self) -> None:
        """Deletes pages that have ended, where the clock can be trusted."""
        if self.history.clock.look():
            with self.database.session.begin() as session:
                session.execute(delete(Published).where(Published.until < time.time()))


def _page(page: Published, runs: int) -> PublicPage:
    return PublicPage(key=page.key, title=page.title, created=page.created, until=page.until, runs=runs)
