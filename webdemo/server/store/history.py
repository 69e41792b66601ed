"""Runs that can be found again: rows in the database, motion files in a folder beside it."""

from __future__ import annotations

import json
import logging
import re
import secrets
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

from sqlalchemy import delete, select, update
from sqlalchemy.exc import SQLAlchemyError
from sqlalchemy.orm import Session

from motion import Duet, InputError, formats
from webdemo.inference.requests.predict import PredictResult
from webdemo.inference.run import Result
from webdemo.server.accounts.visitors import digest
from webdemo.server.audit import audit, fingerprint
from webdemo.ui.history import Opened, PublicPage
from webdemo.view.thumbnail import thumbnail

from .database import Run, Share, changed, entry_of, fields_of, locked, owned, sentence_of, sentences
from .folders import whole
from .storage import ROW_BYTES, RUN_BYTES, Storage, forget, sweep, weight_of

log = logging.getLogger(__name__)

DAY = 86_400.0
STEADY_SECONDS = 3600.0
"""A clock that has jumped is trusted after so much time without another jump."""
UNDO_SECONDS = 600.0
"""For so long a removed run can be brought back."""
LINK_DAYS = 30
"""For which a link lasts."""
_TRUTH = "truth.npz"
"""What really followed the past of a prediction."""
_PREDICTION = ("past_frames", "error", "speed", "true_speed")
_KEY = re.compile(r"\A[A-Za-z0-9_-]{16,64}\Z")
_ENDED = "There is no such page, or it has ended: ask the person who sent it to you."
_OFF = "This lab makes no public pages: the person who runs it can set PASDEDEUX_PUBLISH_DAYS."
_MISSING = "There is no such run, or its link has expired: ask the person who sent it for a new one."


class History:
    """Keeps runs, and shows them to others until that ends: by links, to the people of the lab, and by public pages, to
    anybody.

    Args:
        storage: knows their rows and their folders, counts what people store, and makes room.
        keep_days: age in days at which a run is removed unless it is a favourite.
        publish_days: for which a public page lasts; 0 where there are none.
    """

    def __init__(self, storage: Storage, *, keep_days: float = 30, publish_days: float = 30) -> None:
        self.storage, self.database, self.folder = storage, storage.database, storage.motions
        self.keep_days, self.publish_days = keep_days, publish_days
        self.clock: Callable[[], float] = time.time
        self._began, self._since = time.time() - time.monotonic(), time.monotonic()

    # ---- while a run goes on ---------------------------------------------------------------------

    @sentences()
    def begin(self, owner: str, asked: Mapping[str, Any], title: str, *, address: str = "") -> str:
        """Writes down that a run was asked for; returns its id.

        Args:
            owner: whose run it is.
            asked: the request as plain values.
            title: of the run.
            address: that it comes from, where strangers are known by cookies that they could throw away.

        Raises:
            InputError: if the disk is nearly full, or the owner has no room and nothing that can make way.
        """
        self.storage.check_disk()
        text = json.dumps(asked)
        run = Run(
            id=secrets.token_urlsafe(18),
            owner=owner,
            kind=asked.get("kind", "generate"),
            title=title,
            request=text,
            created=self.clock(),
            address=digest(address) if address else "",
            size=ROW_BYTES + len(text),
        )
        with self.database.session.begin() as session:
            self.storage.check(session, owner, run.address, RUN_BYTES)
            session.add(run)
        return run.id

    def finish(self, run: str, result: Result) -> None:
        """Keeps a run's result: first its files, then its row, so every finished row has its files.

        Where its owner's room is used up, runs of theirs make way (:meth:`Storage.make_room`).

        Raises:
            InputError: if it cannot be kept; the run is then marked as failed.
        """
        outcome = {"manifest": result.manifest, "timings": result.timings, "notes": list(result.notes)}
        if isinstance(result, PredictResult):
            outcome["prediction"] = {name: getattr(result, name) for name in _PREDICTION}
        try:
            self._write(run, result)
            there, gone = self._enter(run, json.dumps(outcome), thumbnail(result.duets[0]))
        except Exception as error:  # whatever it is, the result itself is there
            reason = str(sentence_of(error)).replace(f"{self.folder}/.{run}/", "")
            self.storage.drop([run])
            self.end(run, "failed", reason)
            raise InputError(f"{reason} Download the result's files now.") from None
        self.storage.drop(gone if there else [run])  # its owner removed it while it ran

    def _enter(self, run: str, outcome: str, picture: str) -> tuple[bool, list[str]]:
        """Writes a result into its row; returns whether that is still there, and the runs that made way."""
        with self.database.session.begin() as session:
            locked(session)
            row = session.get(Run, run)
            if row is None:
                return False, []
            weight = weight_of(row, self.folder / run) + len(outcome)
            gone = self.storage.make_room(session, row.owner, row.address, weight - row.size, spare=[run])
            row.state, row.outcome, row.size, row.thumbnail = "done", outcome, weight, picture
        return True, gone

    def end(self, run: str, state: str, message: str = "") -> None:
        """Marks a run that has no result; one whose end cannot be written is interrupted at the next start."""
        ended = update(Run).where(Run.id == run).values(state=state, message=message)
        try:
            with self.database.session.begin() as session:
                session.execute(ended)
        except SQLAlchemyError as error:
            log.warning("The end of a run could not be written down (%s).", type(error).__name__)

    def recover(self) -> int:
        """Marks the runs that an earlier process left unfinished, and removes its half-written files.

        Returns:
            the number of those runs.
        """
        lost = update(Run).where(Run.state == "running")
        lost = lost.values(state="interrupted", message="The server stopped while this ran: run it again.")
        with self.database.session.begin() as session:
            count = changed(session, lost)
        sweep(self.database, Run, self.folder)
        return count

    # ---- for those who know an id or a link ------------------------------------------------------

    @sentences()
    def _shown(self, key: str, owner: str) -> Run:
        """The row of a run that somebody may see."""
        if not _KEY.match(key):
            raise InputError(_MISSING)
        with self.database.session() as session:
            run = session.get(Run, key)
            if run is None or not owner or run.owner != owner:
                shown = (Share.key == key, ~Share.public, Share.until > time.time(), Run.removed.is_(None))
                run = session.scalar(select(Run).join(Share).where(*shown))
                audit("link-opened", ok=run is not None, link=fingerprint(key))
            if run is None or run.removed is not None:
                raise InputError(_MISSING)
        return run

    def _opened(self, run: Run) -> Opened:
        """A run with its result alone, not what it was made from."""
        if run.state != "done":
            raise InputError(run.message or f"This run has no result ({run.state}).")
        return Opened(entry=entry_of(run), result=replace(self._read(run.id, fields_of(run.outcome)), run=run.id))

    @sentences()
    def delete(self, run: str, owner: str) -> None:
        """Deletes a run, its files and its links at once."""
        with self.database.session.begin() as session:
            session.delete(self._own(session, run, owner))
        self.storage.drop([run])

    # ---- shown to others -------------------------------------------------------------------------

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
                raise InputError(f"This run has no result to show ({row.state}).")
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
            mine = self._own(session, run, owner)
            ended = changed(session, delete(Share).where(Share.run_id == mine.id, ~Share.public))
        audit("links-ended", run=run, count=ended)
        return ended

    @sentences()
    def pages(self, owner: str) -> Sequence[PublicPage]:
        """The owner's public pages that have not ended, newest first."""
        mine = (owned(Run, owner), Run.removed.is_(None), Share.public, Share.until > time.time())
        query = select(Share).join(Run).where(*mine).order_by(Share.created.desc(), Share.key)
        with self.database.session() as session:
            return [_page(share) for share in session.scalars(query)]

    @sentences()
    def end_page(self, key: str, owner: str) -> None:
        """Ends a public page; raises InputError if it is not the owner's."""
        mine = select(Run.id).where(owned(Run, owner))
        with self.database.session.begin() as session:
            if not changed(session, delete(Share).where(Share.key == key, Share.public, Share.run_id.in_(mine))):
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

    # ---- expiry ----------------------------------------------------------------------------------

    def _is_steady(self) -> bool:
        """False for an hour after the start, and after the clock has jumped by more than a day."""
        began, now = self.clock() - time.monotonic(), time.monotonic()
        if abs(began - self._began) > DAY:
            log.warning("The clock has jumped: nothing is removed because of its age until it has been steady.")
            self._began, self._since = began, now
        return now - self._since >= STEADY_SECONDS

    def clean(self) -> int:
        """Removes runs by age; favourites stay. Returns how many.

        While the clock cannot be trusted, nothing is removed because of its age.
        """
        now = self.clock()
        with self.database.session.begin() as session:
            locked(session)
            gone = list(session.scalars(select(Run.id).where(Run.removed < now - UNDO_SECONDS)))
            if self._is_steady():
                session.execute(delete(Share).where(Share.until < now))
                old = Run.created < now - self.keep_days * DAY
                gone += session.scalars(select(Run.id).where(old, ~Run.favourite, Run.state != "running"))
            gone = [run for run in dict.fromkeys(gone) if forget(session, run)]
        self.storage.drop(gone)
        return len(gone)

    # ---- files -----------------------------------------------------------------------------------

    def _own(self, session: Session, run: str, owner: str) -> Run:
        row = session.get(Run, run) if _KEY.match(run) else None
        if row is None or not owner or row.owner != owner or row.removed is not None:
            raise InputError("There is no such run in your history: reload the page.")
        return row

    def _write(self, run: str, result: Result) -> None:
        """Writes a result's files into a folder that takes its name when it is whole."""
        with whole(self.folder / run) as half:
            for i, duet in enumerate(result.duets):
                if isinstance(duet, Duet) and not duet.manifest:  # by which the file opens again elsewhere
                    duet = replace(duet, manifest={**result.manifest, "sample": i})
                formats.write(duet, half / f"{i + 1}.npz")
            if isinstance(result, PredictResult) and result.truth is not None:
                formats.write(result.truth, half / _TRUTH)
            (half / "readouts.json").write_text(json.dumps(list(result.readouts), default=float), encoding="utf-8")

    def _read(self, run: str, outcome: dict[str, Any]) -> Result:
        folder = self.folder / run
        files = sorted(folder.glob("[0-9]*.npz"), key=lambda path: int(path.stem))
        try:
            duets = tuple(map(formats.read, files))
            truth = formats.read(folder / _TRUTH) if (folder / _TRUTH).exists() else None
            readouts = tuple(json.loads((folder / "readouts.json").read_text(encoding="utf-8")))
        except (OSError, ValueError):
            duets = ()
        if not {"manifest", "timings", "notes"} <= outcome.keys():  # its row is damaged
            duets = ()
        if not duets:
            raise InputError("The files of this run are gone or damaged: run it again.")
        whole: dict[str, Any] = {
            "duets": duets,
            "manifest": outcome["manifest"],
            "readouts": readouts,
            "timings": outcome["timings"],
            "notes": tuple(outcome["notes"]),
        }
        if kept := outcome.get("prediction"):
            curves: dict[str, Any] = {name: tuple(value) for name, value in kept.items() if name != "past_frames"}
            return PredictResult(**whole, truth=truth, past_frames=kept["past_frames"], **curves)
        return Result(**whole)


def _page(share: Share) -> PublicPage:
    title = entry_of(share.run).title
    return PublicPage(key=share.key, title=title, created=share.created, until=share.until)
