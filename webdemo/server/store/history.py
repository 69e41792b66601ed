"""Runs that can be found again: rows in the database, motion files in a folder beside it."""

from __future__ import annotations

import errno
import json
import logging
import os
import re
import secrets
import shutil
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, cast

from sqlalchemy import CursorResult, delete, func, select, update
from sqlalchemy.exc import SQLAlchemyError
from sqlalchemy.orm import Session, selectinload

from motion import InputError, formats
from webdemo.inference.predict_request import PredictResult
from webdemo.inference.requests import Result
from webdemo.ui.history import Entry, Opened

from .database import Database, Link, Note, Run, sentence_of, sentences
from .originals import bytes_of

log = logging.getLogger(__name__)

SHOWN = 200
"""Runs that a list holds at most."""
DAY = 86_400.0
LEAP_SECONDS = 2 * DAY
"""A clock further than this past the newest run and the last cleaning is not trusted."""
UNDO_SECONDS = 600.0
"""For so long a removed run can be brought back."""
WAIT_SECONDS = DAY
"""After a clock was not trusted, nothing is removed for this long: time to read the log and correct it."""
_TRUTH = "truth.npz"
"""What really followed the past of a prediction."""
_PREDICTION = ("past_frames", "error", "speed", "true_speed")
_KEY = re.compile(r"[A-Za-z0-9_-]{16,64}\Z")
_MISSING = "There is no such run, or its link has expired: ask the person who sent it for a new one."


class History:
    """Keeps runs.

    Args:
        database: where their rows are.
        folder: holds a folder a run.
        node: this process's name; its unfinished runs of an earlier life are marked as interrupted.
        keep_days: age in days at which a run is removed unless it is a favourite.
        keep_bytes: size of all runs' files above which the oldest that are no favourites are removed.
        keep_favourites: favourites that one owner may have.
        link_days: how long a link lasts.
        free_bytes: free disk space below which nothing is begun.
    """

    def __init__(
        self,
        database: Database,
        folder: Path,
        *,
        node: str = "",
        keep_days: float = 30,
        keep_bytes: float = 2e9,
        keep_favourites: int = 200,
        link_days: float = 30,
        free_bytes: float = 0,
    ) -> None:
        self.database, self.folder, self.node = database, folder, node
        self.keep_days, self.keep_bytes, self.keep_favourites = keep_days, keep_bytes, keep_favourites
        self.link_days, self.free_bytes = link_days, free_bytes
        self._owed: dict[str, tuple[str, str]] = {}
        self._cleaned = 0.0
        self._trusted_from = 0.0
        try:
            folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        except OSError as error:
            raise InputError(
                f"The folder {folder} cannot be made ({error.strerror}): choose another with PASDEDEUX_DATA."
            ) from None

    # ---- while a run goes on ---------------------------------------------------------------------

    @sentences()
    def begin(self, owner: str, request: Any, title: str) -> str:
        """Writes down that a run was asked for; returns its id.

        Raises:
            InputError: if the disk is nearly full.
        """
        if shutil.disk_usage(self.folder).free < self.free_bytes:
            raise InputError(
                "The server's disk is nearly full, so nothing new can be kept: tell the person who runs it."
            )
        asked = request.to_dict()
        run = Run(
            id=secrets.token_urlsafe(18), owner=owner, kind=asked.get("kind", "generate"), title=title,
            request=json.dumps(asked), node=self.node,
        )  # fmt: skip
        with self.database.session.begin() as session:
            session.add(run)
        return run.id

    def finish(self, run: str, result: Result) -> None:
        """Keeps a run's result: first its files, then its row, so every finished row has its files.

        Raises:
            InputError: if they cannot be written; the run is then marked as failed.
        """
        try:
            size = self._write(run, result)
        except (OSError, InputError) as error:
            full = getattr(error, "errno", None) in (errno.ENOSPC, errno.EDQUOT) or "full" in str(error)
            sentence = (
                "The result could not be kept in the history, the server's disk is full: "
                "download its files now."
                if full
                else "The result could not be kept in the history: download its files now."
            )
            self.end(run, "failed", sentence)
            raise InputError(sentence) from None
        outcome = {"manifest": result.manifest, "timings": result.timings, "notes": list(result.notes)}
        if isinstance(result, PredictResult):
            outcome["prediction"] = {name: getattr(result, name) for name in _PREDICTION}
        done = update(Run).where(Run.id == run).values(state="done", outcome=json.dumps(outcome), size=size)
        try:
            with self.database.session.begin() as session:
                there = cast(CursorResult[Any], session.execute(done)).rowcount
        except SQLAlchemyError as error:
            reason = sentence_of(error)
            shutil.rmtree(self.folder / run, ignore_errors=True)
            self.end(run, "failed", str(reason))
            raise InputError(f"{reason} Download the result's files now.") from None
        if not there:  # its owner removed it while it ran
            shutil.rmtree(self.folder / run, ignore_errors=True)

    def end(self, run: str, state: str, message: str = "") -> None:
        """Marks a run that has no result; where that cannot be written, :meth:`settle` does it later."""
        self._owed[run] = (state, message)
        self.settle()

    def settle(self) -> None:
        """Writes down how runs ended for which there was no disk space when they did."""
        for run, (state, message) in list(self._owed.items()):
            ended = update(Run).where(Run.id == run).values(state=state, message=message)
            try:
                with self.database.session.begin() as session:
                    session.execute(ended)
            except SQLAlchemyError as error:
                log.warning("The end of a run could not be written down (%s).", type(error).__name__)
                return
            self._owed.pop(run, None)

    def recover(self, dead: Callable[[Sequence[str]], Sequence[str]] | None = None) -> int:
        """Marks the unfinished runs of processes that have ended; returns their number.

        Half-written files of a killed process are removed.

        Args:
            dead: selects the names of processes that have ended; by default only an earlier process of this name.
        """
        with self.database.session() as session:
            nodes = list(session.scalars(select(Run.node).where(Run.state == "running").distinct()))
        gone = dead(nodes) if dead is not None else [self.node]
        unfinished = (Run.state == "running", Run.node.in_(gone))
        with self.database.session.begin() as session:
            lost = list(session.scalars(select(Run.id).where(*unfinished)))
            session.execute(
                update(Run)
                .where(*unfinished)
                .values(state="interrupted", message="The server stopped while this ran: run it again.")
            )
        for run in lost:
            shutil.rmtree(self.folder / run, ignore_errors=True)
            shutil.rmtree(self.folder / f".{run}", ignore_errors=True)
        return len(lost)

    # ---- finding them again ----------------------------------------------------------------------

    @sentences()
    def entries(self, owner: str) -> Sequence[Entry]:
        """The owner's runs, newest first."""
        if not owner:
            return []
        query = (
            select(Run)
            .outerjoin(Note)
            .where(Run.owner == owner, Note.removed.is_(None))
            .options(selectinload(Run.links), selectinload(Run.note))
            .order_by(Run.created.desc())
            .limit(SHOWN)
        )
        with self.database.session() as session:
            return [entry_of(run) for run in session.scalars(query)]

    @sentences()
    def open(self, key: str, owner: str) -> Opened:
        """A run by its id, for its owner, or by a link, for anybody.

        Raises:
            InputError: the same sentence for an unknown run, another person's run and an expired link, to reveal
                nothing; a different one for the owner's run without a result.
        """
        if not _KEY.match(key):
            raise InputError(_MISSING)
        with self.database.session() as session:
            run = session.get(Run, key)
            if run is None or not owner or run.owner != owner:
                link = session.get(Link, key)
                run = link.run if link is not None and link.until > time.time() else None
            if run is None or _removed(run):
                raise InputError(_MISSING)
            entry = entry_of(run)
            outcome = fields_of(run.outcome)
        if entry.state != "done":
            raise InputError(entry.message or f"This run has no result: it is {entry.state}.")
        return Opened(entry=entry, result=replace(self._read(entry.id, outcome), run=entry.id))

    @sentences()
    def favour(self, run: str, owner: str, *, favourite: bool) -> None:
        """Marks a run as one to keep, or no longer; raises InputError if there are too many."""
        with self.database.session.begin() as session:
            found = self._own(session, run, owner)
            if favourite and not found.favourite:
                count = session.scalar(
                    select(func.count()).select_from(Run).where(Run.owner == owner, Run.favourite)
                )
                if (count or 0) >= self.keep_favourites:
                    raise InputError(f"You already keep {count} favourites: stop keeping one first.")
            found.favourite = favourite

    @sentences()
    def delete(self, run: str, owner: str) -> None:
        """Deletes a run, its files and its links at once."""
        with self.database.session.begin() as session:
            session.delete(self._own(session, run, owner))
        shutil.rmtree(self.folder / run, ignore_errors=True)

    @sentences()
    def link(self, run: str, owner: str) -> tuple[str, float]:
        """A new link to a run: its key, and when it ends."""
        token, until = secrets.token_urlsafe(18), time.time() + self.link_days * DAY
        with self.database.session.begin() as session:
            found = self._own(session, run, owner)
            if found.state != "done":
                raise InputError(f"This run has no result to show: it is {found.state}.")
            session.add(Link(token=token, run_id=found.id, until=until))
        return token, until

    @sentences()
    def revoke(self, run: str, owner: str) -> int:
        """Ends all links to a run; returns how many there were."""
        with self.database.session.begin() as session:
            found = self._own(session, run, owner)
            ended = session.execute(delete(Link).where(Link.run_id == found.id))
            return cast(CursorResult[Any], ended).rowcount

    # ---- expiry ----------------------------------------------------------------------------------

    def clean(self) -> int:
        """Removes runs by age, then the oldest by size; favourites stay. Returns how many.

        A clock that is wrong removes nothing: where it is far past the newest run and the last cleaning, age
        counts again after :data:`WAIT_SECONDS`.
        """
        now = time.time()
        with self.database.session.begin() as session:
            old = select(Run.id, Run.size).where(~Run.favourite, Run.state != "running")
            taken_out = select(Run.id, Run.size).join(Note).where(Note.removed < now - UNDO_SECONDS)
            gone: dict[str, int] = dict(session.execute(taken_out).tuples().all())
            if self._clock_is_trusted(now, session.scalar(select(func.max(Run.created)))):
                session.execute(delete(Link).where(Link.until < now))
                outlived = session.execute(old.where(Run.created < now - self.keep_days * DAY))
                gone |= dict(outlived.tuples().all())
            total = (session.scalar(select(func.sum(Run.size))) or 0) - sum(gone.values())
            if total > self.keep_bytes:
                for run, size in session.execute(old.order_by(Run.created)):
                    if total <= self.keep_bytes:
                        break
                    if run not in gone:
                        gone[run] = size
                        total -= size
            for run in gone:
                session.execute(delete(Note).where(Note.run_id == run))
                session.execute(delete(Link).where(Link.run_id == run))
                session.execute(delete(Run).where(Run.id == run))
        for run in gone:
            shutil.rmtree(self.folder / run, ignore_errors=True)
        return len(gone)

    def _clock_is_trusted(self, now: float, newest: float | None) -> bool:
        """True if ages of runs can be trusted: not for a while after the clock seems to have jumped."""
        last = max(self._cleaned, newest or 0.0)
        if last and now - last > LEAP_SECONDS:
            log.warning(
                "The clock is %.0f days past the newest run and the last cleaning: runs are kept whatever "
                "their age for %.0f hours. Set the clock right if it is wrong.",
                (now - last) / DAY, WAIT_SECONDS / 3600,
            )  # fmt: skip
            self._trusted_from = time.monotonic() + WAIT_SECONDS
        self._cleaned = now
        return time.monotonic() >= self._trusted_from

    # ---- files -----------------------------------------------------------------------------------

    def _own(self, session: Session, run: str, owner: str) -> Run:
        found = session.get(Run, run) if _KEY.match(run) else None
        if found is None or not owner or found.owner != owner or _removed(found):
            raise InputError("There is no such run in your history: reload the page.")
        return found

    def _write(self, run: str, result: Result) -> int:
        """Writes a result's files into a folder that takes its name when it is whole; returns their bytes."""
        half = self.folder / f".{run}"
        try:
            half.mkdir(mode=0o700)
            for i, duet in enumerate(result.duets):
                formats.write(duet, half / f"{i + 1}.npz")
            if isinstance(result, PredictResult) and result.truth is not None:
                formats.write(result.truth, half / _TRUTH)
            (half / "readouts.json").write_text(
                json.dumps(list(result.readouts), default=float), encoding="utf-8"
            )
            size = bytes_of(half)
            os.replace(half, self.folder / run)
        except BaseException:
            shutil.rmtree(half, ignore_errors=True)
            raise
        return size

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
            "duets": duets, "manifest": outcome["manifest"], "readouts": readouts,
            "timings": outcome["timings"], "notes": tuple(outcome["notes"]),
        }  # fmt: skip
        if kept := outcome.get("prediction"):
            curves: dict[str, Any] = {
                name: tuple(value) for name, value in kept.items() if name != "past_frames"
            }
            return PredictResult(**whole, truth=truth, past_frames=kept["past_frames"], **curves)
        return Result(**whole)


def _removed(run: Run) -> bool:
    return run.note is not None and run.note.removed is not None


def fields_of(text: str) -> dict[str, Any]:
    """A column's JSON; empty if it is damaged."""
    try:
        found = json.loads(text or "{}")
    except ValueError:
        return {}
    return found if isinstance(found, dict) else {}


def entry_of(run: Run) -> Entry:
    """A row as the page takes it."""
    now, note = time.time(), run.note or Note(title="", tags="", text="", frame=None, thumbnail="")
    return Entry(
        id=run.id, kind=run.kind, title=note.title or run.title, state=run.state, message=run.message,
        created=run.created, request=fields_of(run.request), favourite=run.favourite,
        links=sum(link.until > now for link in run.links), tags=tuple(note.tags.split()), note=note.text,
        frame=note.frame, thumbnail=note.thumbnail,
    )  # fmt: skip
