"""The history as a notebook: search, names, tags and notes, undo, how a tab was set, and one file of everything."""

from __future__ import annotations

import json
import logging
import threading
from collections.abc import Generator, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

from sqlalchemy import ColumnElement, func, or_, select, update
from sqlalchemy.exc import SQLAlchemyError
from sqlalchemy.orm import Session, selectinload

from motion import Clip, InputError, formats
from webdemo.inference.requests import Result
from webdemo.server.accounts.visitors import digest
from webdemo.server.audit import audit
from webdemo.ui.history import Entry, Found, Kept, Opened, Search, Usage
from webdemo.ui.visitor import Visitor
from webdemo.view.thumbnail import thumbnail

from .database import Note, Run, sentences
from .entries import entry_of, fields_of
from .history import History
from .intake import announce, intake
from .kept_settings import MOST_BESIDE
from .ledger import locked
from .originals import LARGEST_SHARE, ORIGINAL, keep_original, kept_original
from .storage import weight_of
from .workspace import Packed, Taken, pack, unpack

log = logging.getLogger(__name__)

LONGEST_TITLE, LONGEST_NOTE, LONGEST_TAGS = 200, 4000, 300
LONGEST_PERSON = 60.0
"""Seconds of a chosen file that are kept with a run."""
MOST_PEOPLE = 6
LARGEST_KEPT = 20_000
"""Characters of the settings of a tab."""


class Notebook(History):
    """A history whose owners can search it, write in it, and take it along; see :class:`History`."""

    def __init__(self, *args: Any, **more: Any) -> None:
        super().__init__(*args, **more)
        self._importing: set[str] = set()
        self._lock = threading.Lock()

    # ---- finding ---------------------------------------------------------------------------------

    @sentences()
    def search(self, owner: str, wanted: Search) -> Found:
        """The owner's runs that fit, newest first."""
        if not owner:
            return Found((), 0)
        fit = [Run.owner == owner, Note.removed.is_(None), _ALONE, *_conditions(wanted)]
        query = (
            select(Run).outerjoin(Note).where(*fit).order_by(Run.created.desc(), Run.id)
            .options(selectinload(Run.links), selectinload(Run.note))
            .offset(max(wanted.offset, 0)).limit(min(max(wanted.limit, 1), 500))
        )  # fmt: skip
        mine = (Run.owner == owner, Note.removed.is_(None))
        with self.database.session() as session:
            total = session.scalar(select(func.count()).select_from(Run).outerjoin(Note).where(*fit)) or 0
            entries = [entry_of(run) for run in session.scalars(query)]
            tags = session.scalars(select(Note.tags).join(Run).where(*mine, Note.tags != "").distinct())
            asked = session.scalars(select(Run.request).outerjoin(Note).where(*mine).distinct())
            models = {str(fields_of(request).get("model", "")) for request in asked} - {""}
            return Found(
                entries, total, sorted({tag for line in tags for tag in line.split()}), sorted(models)
            )

    @sentences()
    def entry(self, run: str, owner: str) -> Entry:
        """One of the owner's runs."""
        with self.database.session() as session:
            return entry_of(self._own(session, run, owner))

    def open(self, key: str, owner: str) -> Opened:
        """See :meth:`History.open`; also how the tab was set, and what the run was compared with."""
        opened = super().open(key, owner)
        with sentences(), self.database.session() as session:
            run = session.get(Run, opened.entry.id)
            kept = fields_of(run.note.kept) if run is not None and run.note is not None else {}
            whose = run.owner if run is not None else ""
        mine = bool(owner) and owner == whose  # a link shows the motion, not the file that it began with
        files = sorted((self.folder / opened.entry.id).glob("given-*.npz")) if mine else []
        people = []
        with suppress(OSError, ValueError):
            people = [clip for clip in map(formats.read, files) if isinstance(clip, Clip)]
        beside = []
        for other in kept.get("compared", ())[:MOST_BESIDE]:
            with suppress(InputError):  # it was removed meanwhile
                beside.append(super().open(str(other), whose))
        found = Kept(
            controls=kept.get("controls", {}), people=tuple(people), compared=tuple(kept.get("compared", ())),
            original=kept_original(kept.get("file"), self.folder / opened.entry.id) if mine else None,
        )  # fmt: skip
        return replace(opened, kept=found, beside=tuple(beside))

    # ---- writing ---------------------------------------------------------------------------------

    def finish(self, run: str, result: Result) -> None:
        """See :meth:`History.finish`; also draws the thumbnail."""
        super().finish(run, result)
        try:
            with self.database.session.begin() as session:
                if session.get(Run, run) is not None:
                    _note(session, run).thumbnail = thumbnail(result.duets[0])
        except SQLAlchemyError as error:  # the motion is kept all the same
            log.warning("A thumbnail could not be kept (%s).", type(error).__name__)

    @sentences()
    def keep(self, run: str, owner: str, kept: Kept) -> None:
        """Writes down how the tab was set; people of a file too long to react to are left out.

        The file itself is copied beside the run where it is not too large and its owner's runs leave room.
        """
        record: dict[str, Any] = {"controls": dict(kept.controls), "compared": list(kept.compared)}
        if len(json.dumps(record)) > LARGEST_KEPT:
            return
        with self.database.session() as session:
            self._own(session, run, owner)
        folder = self.folder / run
        if kept.original is not None:
            room = self.storage.spare(owner, LARGEST_SHARE)
            record["file"] = keep_original(kept.original, folder, room)
        added = [folder / ORIGINAL, *self._keep_people(kept, folder)]
        try:
            gone = self._note_kept(run, owner, record, kept.compared[:MOST_BESIDE])
        except InputError:  # the files alone are left out
            for path in added:
                path.unlink(missing_ok=True)
            gone = self._note_kept(run, owner, record | {"file": ""}, kept.compared[:MOST_BESIDE])
        self.storage.drop(gone)

    def _note_kept(self, run: str, owner: str, record: Mapping[str, Any], beside: Sequence[str]) -> list[str]:
        """Writes the record of how a tab was set; returns the runs that made way for the files beside it."""
        with self.database.session.begin() as session:
            locked(session)
            mine = self._own(session, run, owner)
            weight = weight_of(mine, self.folder / run)
            gone = self.storage.make_room(
                session, owner, mine.address, weight - mine.size, spare=[run, *beside]
            )
            mine.size = weight
            _note(session, run).kept = json.dumps(record)
            for other in beside:
                self._own(session, other, owner)
                _note(session, other).part_of = run
        return gone

    @staticmethod
    def _keep_people(kept: Kept, folder: Path) -> list[Path]:
        written: list[Path] = []
        if len(kept.people) <= MOST_PEOPLE and all(p.seconds <= LONGEST_PERSON for p in kept.people):
            for i, person in enumerate(kept.people):
                with suppress(OSError, InputError):
                    written += formats.write(person, folder / f"given-{i + 1}.npz")
        return written

    @sentences()
    def describe(
        self, run: str, owner: str, *, title: str | None = None, tags: str | None = None,
        note: str | None = None, frame: int | None = None,
    ) -> None:  # fmt: skip
        """Names a run, tags it, or writes a note about one of its frames; what is None stays."""
        for name, value, most in (
            ("name", title, LONGEST_TITLE), ("note", note, LONGEST_NOTE), ("tags", tags, LONGEST_TAGS)
        ):  # fmt: skip
            if value is not None and len(value) > most:
                raise InputError(
                    f"The {name} has {len(value):,} characters: shorten it to {most:,} or fewer."
                )
        with self.database.session.begin() as session:
            self._own(session, run, owner)
            row = _note(session, run)
            if title is not None:
                row.title = " ".join(title.split())
            if tags is not None:
                row.tags = "".join(f" {tag}" for tag in dict.fromkeys(_tags(tags)))
                row.tags += " " if row.tags else ""
            if note is not None:
                row.text = note.strip()
                row.frame = frame if row.text else None

    @sentences()
    def remove(self, runs: Sequence[str], owner: str) -> int:
        """Takes runs out of the history, with their links; :meth:`restore` brings them back for a while."""
        now = self.clock.now()
        with self.database.session.begin() as session:
            for run in runs:
                found = self._own(session, run, owner)
                if found.state == "running":
                    raise InputError("A run that goes on cannot be removed: cancel it first.")
                _note(session, found.id).removed = now
                session.execute(update(Note).where(Note.part_of == found.id).values(removed=now))
        audit("runs-removed", runs=" ".join(runs), count=len(runs))
        return len(runs)

    @sentences()
    def favour(self, run: str, owner: str, *, favourite: bool) -> None:
        """See :meth:`History.favour`; the parts of a grid are kept with it."""
        super().favour(run, owner, favourite=favourite)
        with self.database.session.begin() as session:
            parts = select(Note.run_id).where(Note.part_of == run)
            session.execute(
                update(Run).where(Run.id.in_(parts), Run.owner == owner).values(favourite=favourite)
            )

    @sentences()
    def restore(self, runs: Sequence[str], owner: str) -> int:
        """Brings removed runs back that are not deleted yet; returns how many."""
        wanted = (
            select(Note).join(Run).where(Run.owner == owner, Note.run_id.in_(list(runs)), Run.owner != "")
        )
        with self.database.session.begin() as session:
            found = [note for note in session.scalars(wanted) if note.removed is not None]
            for note in found:
                note.removed = None
                session.execute(update(Note).where(Note.part_of == note.run_id).values(removed=None))
        audit("runs-restored", runs=" ".join(note.run_id for note in found), count=len(found))
        return len(found)

    # ---- one file --------------------------------------------------------------------------------

    def usage(self, who: Visitor) -> Usage:
        """See :meth:`.storage.Storage.usage`."""
        return self.storage.usage(who)

    @sentences()
    def weight(self, owner: str, runs: Sequence[str]) -> float:
        """Bytes of runs, or of all of them for none given: about those that :meth:`export` writes."""
        wanted = [Run.owner == owner, Run.owner != ""]
        if runs:
            wanted.append(or_(Run.id.in_(list(runs)), Note.part_of.in_(list(runs))))
        with self.database.session() as session:
            return session.scalar(select(func.sum(Run.size)).outerjoin(Note).where(*wanted)) or 0

    @sentences()
    def export(self, owner: str, runs: Sequence[str], file: Path) -> int:
        """Writes finished runs, or all of them for none given, into one file; returns how many."""
        query = (
            select(Run).outerjoin(Note).options(selectinload(Run.note))
            .where(Run.owner == owner, Run.owner != "", Run.state == "done", Note.removed.is_(None))
            .order_by(Run.created)
        )  # fmt: skip
        if runs:
            query = query.where(or_(Run.id.in_(list(runs)), Note.part_of.in_(list(runs))))
        with self.database.session() as session:
            found = [_packed(run, self.folder / run.id) for run in session.scalars(query)]
        if not found:
            raise InputError("None of these runs has a result to export.")
        pack(found, file)
        return len(found)

    def take_in(self, owner: str, file: Path, *, address: str = "") -> Generator[tuple[int, int], None, None]:
        """Adds the runs of a file of :meth:`export` to the owner's, under ids of their own: all, or none.

        Nothing of it is believed: every motion is read with the limits of an upload and written anew. Only runs that
        the owner has removed already make way for it.

        Args:
            owner: whose runs they become; one import goes on at a time.
            file: the workspace.
            address: that it comes from, where strangers are known by cookies that they could throw away.

        Yields:
            how many runs have been read, and of how many. They are there when the iterator has ended; closed before,
            it leaves nothing.

        Raises:
            InputError: if anything in the file is not as :meth:`export` writes it, or there is too little room.
        """
        if not owner:
            raise InputError("There is no history here to import into: sign in or allow cookies first.")
        self._check_disk()
        with self._alone(owner), intake(self.folder, self.node) as folder:
            address = digest(address) if address else ""
            taken = yield from unpack(file, folder, self.storage.importable(owner, address))
            with sentences():
                gone = self._enter_all(owner, address, taken, folder)
        self.storage.drop(gone)
        audit("import", count=len(taken), made_way=len(gone))

    @contextmanager
    def _alone(self, owner: str) -> Iterator[None]:
        """Holds a person's only import here."""
        with self._lock:
            if owner in self._importing:
                raise InputError("You are importing a workspace already: wait for it, or cancel it.")
            self._importing.add(owner)
        try:
            yield
        finally:
            with self._lock:
                self._importing.discard(owner)

    def _enter_all(self, owner: str, address: str, taken: Sequence[Taken], folder: Path) -> list[str]:
        """Makes imported runs part of the history; returns the removed ones that made way."""
        now = self.clock.now()
        announce(folder, [run.row["id"] for run in taken])
        try:
            with self.database.session.begin() as session:
                locked(session)
                size = sum(run.row["size"] for run in taken)
                gone = self.storage.make_room(session, owner, address, size, only_removed=True)
                for run in taken:
                    session.add(
                        Run(owner=owner, state="done", node="", stored=now, address=address, **run.row)
                    )
                    session.flush()
                    session.add(Note(run_id=run.row["id"], **run.note))
                for run in taken:
                    run.folder.rename(self.folder / run.row["id"])
        except BaseException:
            self.storage.drop([run.row["id"] for run in taken])
            raise
        return gone


_ALONE = or_(Note.part_of.is_(None), Note.part_of == "")
"""No part of another run's grid."""


def _conditions(wanted: Search) -> list[ColumnElement[bool]]:
    found: list[ColumnElement[bool]] = []
    for word in wanted.words.split()[:10]:
        columns = (Run.title, Note.title, Note.text, Note.tags, Run.request)
        found.append(or_(*(column.icontains(word[:100], autoescape=True) for column in columns)))
    if wanted.kind:
        found.append(Run.kind == wanted.kind)
    if wanted.model:
        found.append(Run.request.contains(f'"model": {json.dumps(wanted.model)}', autoescape=True))
    if wanted.tag:
        found.append(Note.tags.contains(f" {wanted.tag} ", autoescape=True))
    if wanted.starred:
        found.append(Run.favourite.is_(True))
    if wanted.since is not None:
        found.append(Run.created >= wanted.since)
    if wanted.until is not None:
        found.append(Run.created < wanted.until)
    return found


def _tags(text: str) -> list[str]:
    return [tag.strip("#") for tag in text.replace(",", " ").split() if tag.strip("#")]


def _note(session: Session, run: str) -> Note:
    found = session.get(Note, run)
    if found is None:
        found = Note(run_id=run)
        session.add(found)
    return found


def _packed(run: Run, folder: Path) -> Packed:
    entry = entry_of(run)
    row = {
        "kind": run.kind, "title": run.title, "created": run.created, "favourite": run.favourite,
        "request": entry.request, "outcome": fields_of(run.outcome),
    }  # fmt: skip
    note = run.note
    written = {"title": note.title, "tags": note.tags, "text": note.text, "frame": note.frame} if note else {}
    return Packed(row, written, folder, fields_of(note.kept) if note else {})
