"""The room that each person has, and what makes way where it is used up: always something of their own.

Everything that is stored counts: runs with the files that they were made from, imported ones and favourites, studies,
uploads, films and other files for download. A part of a person's room is for the latter, which are soon removed, so
that an upload never costs a run.
"""

from __future__ import annotations

import math
import shutil
import tempfile
from collections.abc import Collection
from pathlib import Path
from typing import Any

from sqlalchemy import delete, func, select
from sqlalchemy.orm import Session

from motion import InputError
from webdemo.server.accounts.quotas import Quota
from webdemo.server.accounts.visitors import digest
from webdemo.ui.history import Usage
from webdemo.ui.visitor import Visitor

from .database import DISK_FULL, Database, Run, Study, changed, is_full, owned, sentences
from .folders import make_folder
from .scratch import Scratch

SET_ASIDE = 0.25
"""Share of a person's room that is for uploads and files for download."""
ROW_BYTES = 4096
"""What a run weighs beside its files, its request and its outcome: its row and its thumbnail."""
RUN_BYTES = 2**18
"""Room that there has to be, or that runs can make, before a run begins."""
MB = 2**20
OWN_ROOM = (
    "Your room of {:,.0f} MB for runs and studies is used up by favourites and studies, which are not removed on their "
    "own: stop keeping one, or delete a study."
)
EVERYBODYS_ROOM = (
    "The room for everybody's runs on this server is used up, and others' runs are not removed for yours: remove runs "
    "of your own, or tell the person who runs the server."
)
ADDRESS_ROOM = "The room for runs of people from your network is used up: remove runs of your own."


class Storage:
    """Counts what people store, and makes room.

    Args:
        database: knows whose everything is.
        motions: folder of the runs' files.
        room: how many bytes may be stored.
        scratch: uploads and files for download; None where they are not counted.
        free_bytes: free disk space below which nothing more is kept.

    Raises:
        InputError: if the folder cannot be made.
    """

    def __init__(
        self,
        database: Database,
        motions: Path,
        room: Quota | None = None,
        *,
        scratch: Scratch | None = None,
        free_bytes: float = 0,
    ) -> None:
        self.database, self.motions, self.scratch, self.free_bytes = database, make_folder(motions), scratch, free_bytes
        self.room = room or Quota("bytes", everybody=2e9)

    @property
    def kept_bytes(self) -> float:
        """A person's room for runs and studies."""
        return (1 - SET_ASIDE) * self.room.person

    @property
    def scratch_bytes(self) -> float:
        """A person's room for uploads and files for download."""
        return SET_ASIDE * self.room.person

    def check_disk(self, size: float = 4096) -> None:
        """Raises InputError if the disk has no room for so many bytes more, or cannot be written."""
        try:
            if self.free_bytes and shutil.disk_usage(self.motions).free < self.free_bytes + size:
                raise InputError(DISK_FULL)
            with tempfile.TemporaryFile(dir=self.motions) as file:
                file.write(b"0" * 4096)
                file.flush()
        except OSError as error:
            raise InputError(
                DISK_FULL if is_full(error) else f"The server's disk cannot be written: {error.strerror}."
            ) from None

    # ---- what there is ---------------------------------------------------------------------------

    @sentences()
    def usage(self, who: Visitor) -> Usage:
        """The room that a person uses."""
        with self.database.session() as session:
            runs = session.execute(
                select(Run.favourite, func.sum(Run.size)).where(Run.owner == who.owner).group_by(Run.favourite)
            )
            sizes = {favourite: size or 0 for favourite, size in runs} if who.owner else {}
            studies = _sum(session, Study, Study.owner == who.owner) if who.owner else 0
        return Usage(
            runs=sizes.get(False, 0),
            favourites=sizes.get(True, 0),
            studies=studies,
            temporary=self.scratch.used(digest(who.person)) if self.scratch else 0,
            allowed=self.room.person if math.isfinite(self.room.person) else self.room.everybody,
            kept=min(self.kept_bytes, self.room.everybody),
        )

    def importable(self, owner: str, address: str) -> float:
        """Bytes that a person may import: what is free, and what they have removed themselves."""
        with sentences(), self.database.session() as session:
            removed = sum(weight for _, weight, removed in _evictable(session, owner, ()) if removed)
            return min(left for left, _ in self._left(session, owner, address)) + removed

    def _left(self, session: Session, owner: str, address: str) -> list[tuple[float, str]]:
        """The room left under each limit that holds for a person, and the sentence where it is too little."""
        own = _sum(session, Run, Run.owner == owner) + _sum(session, Study, Study.owner == owner)
        total = _sum(session, Run) + _sum(session, Study)
        near = _sum(session, Run, Run.address == address) + _sum(session, Study, Study.address == address)
        return [
            (self.kept_bytes - own, OWN_ROOM.format(self.kept_bytes / MB)),
            (self.room.everybody - total, EVERYBODYS_ROOM),
            (self.room.address - near if address else math.inf, ADDRESS_ROOM),
        ]

    # ---- making room -----------------------------------------------------------------------------

    def check(self, session: Session, owner: str, address: str, size: float) -> None:
        """Raises InputError if so much could not be stored even if the person's own runs made way."""
        rows = _evictable(session, owner, ())
        self._needed(session, owner, address, size, sum(weight for _, weight, _ in rows))

    def make_room(
        self, session: Session, owner: str, address: str, size: float, *, spare: Collection[str] = ()
    ) -> list[str]:
        """Deletes a person's own runs until so much more can be stored: removed ones first, then the oldest.

        Favourites, studies and runs that go on stay. Where more was stored before than a limit allows, such as after
        it was lowered, no more makes way than what comes.

        Args:
            session: in a transaction that has called :func:`.database.locked`.
            owner: whose runs.
            address: from which they come, as a run has it.
            size: bytes that come.
            spare: runs that stay.

        Returns:
            the deleted runs, whose files :meth:`drop` removes when the transaction is over.

        Raises:
            InputError: if that is not enough; nothing is deleted.
        """
        rows = _evictable(session, owner, spare)
        needed = self._needed(session, owner, address, size, sum(weight for _, weight, _ in rows))
        gone, freed = [], 0.0
        for run, weight, _ in rows:
            if freed >= needed:
                break
            if forget(session, run):
                gone.append(run)
            freed += weight
        return gone

    def _needed(self, session: Session, owner: str, address: str, size: float, can_go: float) -> float:
        """Bytes that must make way for so many that come; raises InputError if fewer can go."""
        needed = 0.0
        for left, sentence in self._left(session, owner, address):
            missing = min(size - left, size)
            if missing > max(can_go, 0.0):
                raise InputError(sentence)
            needed = max(needed, missing)
        return needed

    def drop(self, runs: Collection[str]) -> None:
        """Removes the files of deleted runs."""
        for run in runs:
            shutil.rmtree(self.motions / run, ignore_errors=True)

    # ---- uploads and files for download ----------------------------------------------------------

    def admit(self, who: Visitor, size: float) -> None:
        """Makes room for an upload or a file for download by removing the person's own older ones.

        Raises:
            InputError: if there is too little room.
        """
        if self.scratch is not None:
            self.scratch.admit(digest(who.person), who.address, size, self.scratch_bytes)

    def tidy(self, keep: Collection[str] = ()) -> None:
        """Removes the uploads and files for download that are too old or too many for their owner; ``keep`` stays."""
        if self.scratch is not None:
            self.scratch.clean(keep, self.scratch_bytes)


def sweep(database: Database, table: type[Run] | type[Study], folder: Path) -> None:
    """Removes folders that belong to no row, such as those that a killed process was writing or removing."""
    with database.session() as session:
        known = set(session.scalars(select(table.id)))
    for path in folder.glob("*"):
        if path.is_dir() and path.name not in known:
            shutil.rmtree(path, ignore_errors=True)


def weight_of(run: Run, folder: Path) -> int:
    """Bytes of a run: its files, its request and its outcome, and what is written about it."""
    files = sum(path.stat().st_size for path in folder.iterdir())
    return ROW_BYTES + files + len(run.request) + len(run.outcome or "")


def _sum(session: Session, table: type[Run] | type[Study], *conditions: Any) -> int:
    return session.scalar(select(func.sum(table.size)).where(*conditions)) or 0


def _evictable(session: Session, owner: str, spare: Collection[str]) -> list[tuple[str, int, bool]]:
    """A person's runs that may make way, with their bytes and whether their owner has removed them; first those."""
    rows = session.execute(
        select(Run.id, Run.size, Run.favourite, Run.removed)
        .where(owned(Run, owner), Run.state != "running")
        .order_by(Run.created, Run.id)
    )
    runs = [
        (run, size, removed is not None)
        for run, size, favourite, removed in rows
        if run not in spare and (removed is not None or not favourite)
    ]
    return sorted(runs, key=lambda row: not row[2])


def forget(session: Session, run: str) -> bool:
    """Deletes a run with what shows it to others; False if that was done already."""
    return bool(changed(session, delete(Run).where(Run.id == run)))
