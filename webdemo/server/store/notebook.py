"""The history as a notebook: search, names, tags and notes, undo, how a tab was set, and one file of everything."""

from __future__ import annotations

import json
import re
import zipfile
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

from sqlalchemy import ColumnElement, case, func, or_, select, true, update

from motion import Clip, Duet, InputError, formats
from motion.metrics import compare
from webdemo.inference.run import Result
from webdemo.inference.story import SceneRequest
from webdemo.server.accounts.visitors import digest
from webdemo.server.audit import audit
from webdemo.ui.history import Entry, Found, Kept, Opened, Search, Usage
from webdemo.ui.visitor import Visitor

from .database import Run, entry_of, fields_of, locked, owned, sentences
from .history import History
from .storage import weight_of

LONGEST_TITLE, LONGEST_NOTE, LONGEST_TAGS = 200, 4000, 300
LONGEST_PERSON = 60.0
"""Seconds of a chosen file that are kept with a run."""
MOST_PEOPLE = 6
MOST_BESIDE = 8
"""Runs of a grid beside its first."""
MOST_TAKEN = 100
"""Files of one import."""
LARGEST_REQUEST = 2**16
"""Characters of a request that is imported: a list of runs reads those of all of them."""
_KINDS = ("generate", "scene", "react", "predict")
LARGEST_KEPT = 20_000
"""Characters of the settings of a tab."""


class Notebook(History):
    """A history whose owners can search it, write in it, show it and take it along; see :class:`History`."""

    # ---- finding ---------------------------------------------------------------------------------

    @sentences()
    def search(self, owner: str, wanted: Search) -> Found:
        """The owner's runs that fit, newest first."""
        mine = (owned(Run, owner), Run.removed.is_(None))
        fit = (*mine, Run.part_of == "", *_conditions(wanted))  # a part of a grid has no card of its own
        query = select(Run).where(*fit).order_by(Run.created.desc(), Run.id).limit(min(max(wanted.limit, 1), 500))
        with self.database.session() as session:
            total = session.scalar(select(func.count()).select_from(Run).where(*fit)) or 0
            entries = [entry_of(run) for run in session.scalars(query)]
            tags = session.scalars(select(Run.tags).where(*mine, Run.tags != "").distinct())
            # SQLite reads them all while other threads go on
            model = case((func.json_valid(Run.request), func.json_extract(Run.request, "$.model")))
            models = sorted(str(name) for name in session.scalars(select(model).where(*mine).distinct()) if name)
            return Found(entries, total, sorted({tag for line in tags for tag in line.split()}), models)

    @sentences()
    def entry(self, run: str, owner: str) -> Entry:
        """One of the owner's runs."""
        with self.database.session() as session:
            return entry_of(self._own(session, run, owner))

    def open(self, key: str, owner: str) -> Opened:
        """A run by its id, for its owner, or by a link, for anybody; how its tab was set, what it was compared with.

        Raises:
            InputError: the same sentence for an unknown run, another person's run and an expired link, to reveal
                nothing; a different one for the owner's run without a result.
        """
        run = self._shown(key, owner)
        opened, kept = self._opened(run), fields_of(run.kept)
        mine = bool(owner) and owner == run.owner  # a link shows the motion, not the file that it began with
        files = sorted((self.folder / opened.entry.id).glob("given-*.npz")) if mine else []
        people = []
        with suppress(OSError, ValueError):
            people = [clip for clip in map(formats.read, files) if isinstance(clip, Clip)]
        beside = []
        for other in kept.get("compared", ())[:MOST_BESIDE]:
            with suppress(InputError):  # it was removed meanwhile
                beside.append(self._opened(self._shown(str(other), run.owner)))
        state = Kept(controls=kept.get("controls", {}), people=tuple(people), compared=tuple(kept.get("compared", ())))
        return replace(opened, kept=state, beside=tuple(beside))

    # ---- writing ---------------------------------------------------------------------------------

    @sentences()
    def keep(self, run: str, owner: str, kept: Kept) -> None:
        """Writes down how the tab was set; people of a file too long to react to are left out."""
        record: dict[str, Any] = {"controls": dict(kept.controls), "compared": list(kept.compared)}
        if len(json.dumps(record)) > LARGEST_KEPT:
            return
        together = (run, *kept.compared[:MOST_BESIDE])
        with self.database.session() as session:
            for each in together:
                self._own(session, each, owner)
        folder = self.folder / run
        added = self._keep_people(kept, folder)
        with self.database.session.begin() as session:
            locked(session)
            mine, *beside = (self._own(session, each, owner) for each in together)
            room = partial(self.storage.make_room, session, owner, mine.address, spare=together)
            try:
                gone = room(weight_of(mine, folder) - mine.size)
            except InputError:  # the files alone are left out
                for path in added:
                    path.unlink(missing_ok=True)
                gone = room(weight_of(mine, folder) - mine.size)
            mine.size, mine.kept = weight_of(mine, folder), json.dumps(record)
            for other in beside:
                other.part_of = run
        self.storage.drop(gone)

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
        self, run: str, owner: str, *, title: str | None = None, tags: str | None = None, note: str | None = None
    ) -> None:
        """Names a run, tags it, or writes a note; what is None stays."""
        for name, value, most in (
            ("name", title, LONGEST_TITLE),
            ("note", note, LONGEST_NOTE),
            ("tags", tags, LONGEST_TAGS),
        ):
            if value is not None and len(value) > most:
                raise InputError(f"The {name} has {len(value):,} characters: shorten it to {most:,} or fewer.")
        with self.database.session.begin() as session:
            row = self._own(session, run, owner)
            if title is not None:
                row.name = " ".join(title.split())
            if tags is not None:
                named = (tag.strip("#") for tag in tags.replace(",", " ").split())
                row.tags = "".join(f" {tag}" for tag in dict.fromkeys(filter(None, named)))
                row.tags += " " if row.tags else ""
            if note is not None:
                row.note = note.strip()

    @sentences()
    def remove(self, runs: Sequence[str], owner: str) -> int:
        """Takes runs out of the history, with their links; :meth:`restore` brings them back for a while."""
        now = self.clock()
        with self.database.session.begin() as session:
            for run in runs:
                row = self._own(session, run, owner)
                if row.state == "running":
                    raise InputError("A run cannot be removed while it is being made: cancel it first.")
                session.execute(update(Run).where(_with_parts(row.id)).values(removed=now))
        audit("runs-removed", runs=" ".join(runs), count=len(runs))
        return len(runs)

    @sentences()
    def favour(self, run: str, owner: str, *, favourite: bool) -> None:
        """Marks a run as one to keep, or no longer, with the parts of its grid."""
        with self.database.session.begin() as session:
            self._own(session, run, owner)
            session.execute(update(Run).where(_with_parts(run)).values(favourite=favourite))

    @sentences()
    def restore(self, runs: Sequence[str], owner: str) -> int:
        """Brings removed runs back that are not deleted yet; returns how many."""
        wanted = (owned(Run, owner), Run.id.in_(list(runs)), Run.removed.is_not(None))
        with self.database.session.begin() as session:
            keys = list(session.scalars(select(Run.id).where(*wanted)))
            for run in keys:
                session.execute(update(Run).where(_with_parts(run)).values(removed=None))
        audit("runs-restored", runs=" ".join(keys), count=len(keys))
        return len(keys)

    # ---- one file --------------------------------------------------------------------------------

    def usage(self, who: Visitor) -> Usage:
        """See :meth:`.storage.Storage.usage`."""
        return self.storage.usage(who)

    @sentences()
    def weight(self, owner: str, runs: Sequence[str]) -> float:
        """Bytes of runs, or of all of them for none given: about those that :meth:`export` writes."""
        wanted = (owned(Run, owner), _with_parts(*runs) if runs else true())
        with self.database.session() as session:
            return session.scalar(select(func.sum(Run.size)).where(*wanted)) or 0

    @sentences()
    def export(self, owner: str, runs: Sequence[str], file: Path) -> int:
        """Writes the motions of finished runs, or of all for none given, into one .zip; returns how many runs."""
        mine = (owned(Run, owner), Run.state == "done", Run.removed.is_(None))
        query = select(Run).where(*mine, _with_parts(*runs) if runs else true()).order_by(Run.created)
        with self.database.session() as session:
            entries = [entry_of(run) for run in session.scalars(query)]
        if not entries:
            raise InputError("None of these runs has a result to export.")
        with zipfile.ZipFile(file, "w", zipfile.ZIP_STORED) as archive:  # they are packed already
            for number, entry in enumerate(entries, 1):
                motions = sorted((self.folder / entry.id).glob("[0-9]*.npz"))
                if not motions:
                    raise InputError(f"The files of “{entry.title[:60]}” are gone: remove that run first.")
                name = re.sub(r"[^\w-]+", "-", entry.title)[:60].strip("-")
                for path in motions:
                    archive.write(path, f"{number:03d}-{name}-{path.name}")
        return len(entries)

    def take_in(self, owner: str, files: Sequence[Path], *, address: str = "") -> int:
        """Adds results to the owner's runs, each from its .npz, which holds its request; returns how many.

        Args:
            owner: whose runs they become.
            files: the results, read with the limits of an upload.
            address: that they come from, as for :meth:`begin`.

        Raises:
            InputError: for the first that is no result, or does not fit into the owner's room. Those before it stay.
        """
        if not owner:
            raise InputError("There is no history here to import into: sign in or allow cookies first.")
        if len(files) > MOST_TAKEN:
            raise InputError(f"{len(files)} files are too many at once: choose {MOST_TAKEN} or fewer.")
        for number, file in enumerate(files):
            try:
                room = self.storage.importable(owner, digest(address) if address else "")
                if file.stat().st_size > room:
                    raise InputError("your room is used up: remove some of your runs first.")
                self._take_in(owner, file, address)
            except InputError as error:
                before = f" {number} of the {len(files)} files were imported before it." if number else ""
                raise InputError(f"{file.name[:60]} was not imported: {error}{before}") from None
        audit("import", count=len(files))
        return len(files)

    def _take_in(self, owner: str, file: Path, address: str) -> None:
        duet = formats.read(file)
        manifest = duet.manifest if isinstance(duet, Duet) else None
        asked = (manifest or {}).get("request")
        kind = asked.get("kind", "generate") if isinstance(asked, dict) else ""
        if not isinstance(duet, Duet) or not isinstance(asked, dict) or kind not in _KINDS:
            raise InputError("it holds no result of Pas de Deux: save one as Motion .npz.")
        if len(json.dumps(asked)) > LARGEST_REQUEST:
            raise InputError(f"its request has more than {LARGEST_REQUEST:,} characters: no result of the lab's has.")
        if kind == "scene":
            try:
                SceneRequest.from_dict(asked, duet if "motion" in asked else None)
            except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError):
                raise InputError("its scene has no story: save it again.") from None
        title = str(asked.get("prompt") or file.stem)[:500]
        run = self.begin(owner, {**asked, "kind": kind}, title, address=address)
        self.finish(
            run, Result(duets=(duet,), manifest=manifest or {}, readouts=(compare(None, duet),), timings={}, notes=())
        )


def _with_parts(*runs: str) -> ColumnElement[bool]:
    """Runs and the parts of their grids."""
    return or_(Run.id.in_(runs), Run.part_of.in_(runs))


def _conditions(wanted: Search) -> list[ColumnElement[bool]]:
    conditions: list[ColumnElement[bool]] = []
    for word in wanted.words.split()[:10]:
        columns = (Run.title, Run.name, Run.note, Run.tags, Run.request)
        conditions.append(or_(*(column.icontains(word[:100], autoescape=True) for column in columns)))
    if wanted.kind:
        conditions.append(Run.kind == wanted.kind)
    if wanted.model:
        conditions.append(Run.request.contains(f'"model": {json.dumps(wanted.model)}', autoescape=True))
    if wanted.tag:
        conditions.append(Run.tags.contains(f" {wanted.tag} ", autoescape=True))
    if wanted.starred:
        conditions.append(Run.favourite.is_(True))
    return conditions
