"""The acts of administrators on people, for their page and the shell alike."""

from __future__ import annotations

import shutil
from collections.abc import Collection
from dataclasses import dataclass

from sqlalchemy import delete, func, select

from motion import InputError
from webdemo.server.audit import audit
from webdemo.server.settings import Settings
from webdemo.server.store.database import Database, Person, Published, Run, Study

from .people import ADMIN, People
from .users import Users
from .visitors import digest


@dataclass(frozen=True)
class Row:
    """One account, as an administrator sees it.

    Attributes:
        runs: kept in the history.
        megabytes: of runs and studies.
    """

    name: str
    role: str
    suspended: bool
    runs: int
    megabytes: float


class Administration:
    """Acts of administrators on people; each is audited.

    Args:
        database: of the lab.
        users: the accounts; None where people sign in elsewhere alone.
        settings: of the lab, where people may sign in elsewhere, so that not everybody is among the accounts.
    """

    def __init__(self, database: Database, users: Users | None, settings: Settings) -> None:
        self.database, self.users, self.data = database, users, settings.data
        self.people, self.elsewhere = People(database), bool(settings.proxy_user)

    def _names(self, known: Collection[str]) -> list[str]:
        """Everybody with an account, and everybody who has signed in elsewhere: a key without an id."""
        accounts = self.users.names if self.users is not None else []
        return sorted({*accounts, *(key for key in known if self.elsewhere and "#" not in key)})

    def key(self, name: str) -> str:
        """The key to which everything of a person belongs."""
        return (self.users.key(name) if self.users is not None else None) or name

    def rows(self) -> list[Row]:
        """All people with what they use."""
        with self.database.session() as session:
            counts = dict(session.execute(select(Run.owner, func.count()).group_by(Run.owner)).tuples().all())
            sizes: dict[str, float] = {}
            for table in (Run, Study):
                for owner, size in session.execute(select(table.owner, func.sum(table.size)).group_by(table.owner)):
                    sizes[owner] = sizes.get(owner, 0.0) + (size or 0)
        known = self.people.all()
        found = []
        for name in self._names(known):
            key = self.key(name)
            owner, person = f"user {key}", known.get(key) or self.people.of(key)
            used = sizes.get(owner, 0.0) / 2**20
            found.append(Row(name, person.role, person.suspended, counts.get(owner, 0), used))
        return found

    def set_role(self, name: str, *, admin: bool) -> None:
        """Makes a person an administrator, or no longer."""
        self.people.set(self._known(name), role=ADMIN if admin else "")
        audit("admin-role", target=name, role=ADMIN if admin else "none")

    def suspend(self, name: str, *, suspended: bool) -> None:
        """Signs a person out and keeps them out, or lets them in again."""
        self.people.set(self._known(name), suspended=suspended)
        if suspended:
            self.people.sign_out(self.key(name))
        audit("admin-suspend" if suspended else "admin-let-in", target=name)

    def delete(self, name: str) -> int:
        """Deletes an account with its runs, studies and files; returns the number of runs."""
        key = self._known(name)
        owner = f"user {key}"
        if self.users is not None and name in self.users.names:
            self.users.remove(name)
        self.people.sign_out(key)
        with self.database.session.begin() as session:
            runs = list(session.scalars(select(Run.id).where(Run.owner == owner)))
            studies = list(session.scalars(select(Study.id).where(Study.owner == owner)))
            for table in (Published, Run, Study):  # with what is written on them
                session.execute(delete(table).where(table.owner == owner))
            session.execute(delete(Person).where(Person.key == key))
        folders = [self.data / "motions" / run for run in runs] + [self.data / "studies" / study for study in studies]
        for folder in (*folders, self.data / "scratch" / "uploads" / digest(owner)):
            shutil.rmtree(folder, ignore_errors=True)
        audit("admin-delete", target=name, runs=len(runs), studies=len(studies))
        return len(runs)

    def _known(self, name: str) -> str:
        """The key of a person; raises InputError if there is no such account."""
        if name not in self._names(self.people.all()):
            raise InputError(f"There is no account {name!r:.60}: see `admin list`.")
        return self.key(name)
