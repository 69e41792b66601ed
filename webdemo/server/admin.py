"""The acts of administrators, for their page and the shell alike: each is audited."""

from __future__ import annotations

import shutil
from collections.abc import Collection
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from sqlalchemy import delete, func, select

from motion import InputError
from webdemo.server.accounts.users import Users
from webdemo.server.accounts.visitors import digest
from webdemo.server.audit import audit
from webdemo.server.store.database import Database, Published, Run, Study
from webdemo.server.store.people import ADMIN, People
from webdemo.server.store.storage import SET_ASIDE, forget


@dataclass(frozen=True)
class Row:
    """One account, as an administrator sees it.

    Attributes:
        runs: kept in the history.
        megabytes: of runs and studies.
        room: of megabytes altogether.
        kept: the part of the room that runs and studies may fill.
        full: another run of this person's usual size does not fit, so that their oldest makes way for it.
        own_room: the room was set for this person.
        computed: runs that were computed, and their minutes of a worker.
    """

    name: str
    role: str
    suspended: bool
    runs: int
    megabytes: float
    room: float
    kept: float
    full: bool
    own_room: bool
    computed: int
    minutes: float


class Administration:
    """Acts of administrators on people.

    Args:
        database: of the lab.
        users: the accounts; None where people sign in elsewhere alone.
        data: the data folder.
        person_bytes: room of a person for whom none is set.
        elsewhere: people may sign in elsewhere, so that not everybody is among the accounts.
    """

    def __init__(
        self, database: Database, users: Users | None, data: Path, person_bytes: float, *, elsewhere: bool = False
    ) -> None:
        self.database, self.users, self.data, self.person_bytes = database, users, data, person_bytes
        self.people, self.elsewhere = People(database), elsewhere

    @property
    def names(self) -> list[str]:
        """Everybody with an account, and everybody who has signed in elsewhere."""
        return sorted({*self._accounts, *self._elsewhere(self.people.all())})

    def _elsewhere(self, known: Collection[str]) -> list[str]:
        """The names of those who have signed in elsewhere: the keys without an id."""
        return [key for key in known if "#" not in key] if self.elsewhere else []

    def key(self, name: str) -> str:
        """The key to which everything of a person belongs."""
        return (self.users.key(name) if self.users is not None else None) or name

    @property
    def _accounts(self) -> list[str]:
        return self.users.names if self.users is not None else []

    def rows(self) -> list[Row]:
        """All people with what they use."""
        with self.database.session() as session:
            counts = dict(session.execute(select(Run.owner, func.count()).group_by(Run.owner)).tuples().all())
            sizes: dict[str, float] = {}
            for table in (Run, Study):
                for owner, size in session.execute(select(table.owner, func.sum(table.size)).group_by(table.owner)):
                    sizes[owner] = sizes.get(owner, 0.0) + (size or 0)
        known, computed = self.people.all(), self.people.computed()
        found = []
        for name in sorted({*self._accounts, *self._elsewhere(known)}):
            key = self.key(name)
            owner, row = f"user {key}", known.get(key)
            room = row.megabytes if row is not None else None
            allowed = self.person_bytes / 2**20 if room is None else room
            kept, megabytes = (1 - SET_ASIDE) * allowed, sizes.get(owner, 0.0) / 2**20
            full = megabytes + megabytes / max(counts.get(owner, 0), 1) > kept
            runs, seconds = computed.get(owner, (0, 0.0))
            found.append(
                Row(
                    name,
                    row.role if row else "",
                    bool(row and row.suspended),
                    counts.get(owner, 0),
                    megabytes,
                    allowed,
                    kept,
                    full,
                    room is not None,
                    runs,
                    seconds / 60,
                )
            )
        return found

    def set_role(self, name: str, *, admin: bool) -> None:
        """Makes a person an administrator, or no longer."""
        self._check(name)
        self.people.set(self.key(name), role=ADMIN if admin else "")
        audit("admin-role", target=name, role=ADMIN if admin else "none")

    def set_room(self, name: str, megabytes: float | None) -> None:
        """Sets a person's room; None lifts it."""
        self._check(name)
        if megabytes is not None and not 1 <= megabytes <= 1e9:
            raise InputError("Give a room of 1 MB or more, or none to lift it.")
        self.people.set(self.key(name), megabytes=megabytes)
        audit("admin-room", target=name, megabytes=megabytes)

    def suspend(self, name: str, *, suspended: bool) -> None:
        """Signs a person out and keeps them out, or lets them in again."""
        self._check(name)
        self.people.set(self.key(name), suspended=suspended)
        if suspended:
            self.people.sign_out(self.key(name))
        audit("admin-suspend" if suspended else "admin-let-in", target=name)

    def sign_out(self, name: str) -> int:
        """Ends all of a person's sessions; returns how many there were."""
        self._check(name)
        ended = self.people.sign_out(self.key(name))
        audit("admin-sign-out", target=name, sessions=ended)
        return ended

    def delete(self, name: str) -> int:
        """Deletes an account with its runs, studies and files; returns the number of runs."""
        self._check(name)
        key = self.key(name)
        owner = f"user {key}"
        if self.users is not None and name in self._accounts:
            self.users.remove(name)
        with self.database.session.begin() as session:
            runs = list(session.scalars(select(Run.id).where(Run.owner == owner)))
            for run in runs:
                forget(session, run)
            studies = list(session.scalars(select(Study).where(Study.owner == owner)))
            for study in studies:
                session.delete(study)
            session.execute(delete(Published).where(Published.owner == owner))
        for folder, ids in (("motions", runs), ("studies", [study.id for study in studies])):
            for each in ids:
                shutil.rmtree(self.data / folder / each, ignore_errors=True)
        for scratch in (self.data / "scratch").glob(f"*/uploads/{digest(owner)}"):
            shutil.rmtree(scratch, ignore_errors=True)
        self.people.forget(key)
        audit("admin-delete", target=name, runs=len(runs), studies=len(studies))
        return len(runs)

    def announce(self, text: str) -> None:
        """Shows everybody a line; an empty one removes it."""
        self.people.announce(text)
        audit("admin-announce", characters=len(text))

    def _check(self, name: str) -> None:
        if name not in self.names:
            raise InputError(f"There is no account {name!r:.60}: see `admin list`.")


@cache
def versions() -> dict[str, Any]:
    """Versions of the program's main parts."""
    from importlib.metadata import version

    return {name: version(name) for name in ("gradio", "torch", "numpy", "SQLAlchemy", "alembic")}
