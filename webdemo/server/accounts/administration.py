"""The acts of administrators on people, for their page and the shell alike."""

from __future__ import annotations

import shutil
from dataclasses import dataclass
from pathlib import Path

from sqlalchemy import delete, func, literal, select
from sqlalchemy.orm import Session

from motion import InputError
from webdemo.server.audit import audit
from webdemo.server.store.database import Account, Database, Run, SignIn, Study, locked

from .accounts import ADMIN
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
        data: folder of the lab.
    """

    def __init__(self, database: Database, data: Path) -> None:
        self.database, self.data = database, data

    def rows(self) -> list[Row]:
        """All people with what they use."""
        mine = literal("user ") + Account.key
        count = select(func.count()).where(Run.owner == mine).scalar_subquery()
        sizes = [
            select(func.coalesce(func.sum(table.size), 0)).where(table.owner == mine).scalar_subquery()
            for table in (Run, Study)
        ]
        with self.database.session() as session:
            rows_ = session.execute(select(Account, count, sizes[0] + sizes[1]).order_by(Account.name))
            return [Row(a.name, a.role, a.suspended, runs, size / 2**20) for a, runs, size in rows_]

    def set_role(self, name: str, *, admin: bool) -> None:
        """Makes a person an administrator, or no longer."""
        self._set(name, role=ADMIN if admin else "")
        audit("admin-role", target=name, role=ADMIN if admin else "none")

    def suspend(self, name: str, *, suspended: bool) -> None:
        """Signs a person out and keeps them out, or lets them in again."""
        self._set(name, suspended=suspended)
        audit("admin-suspend" if suspended else "admin-let-in", target=name)

    def _set(self, name: str, **values: str | bool) -> None:
        with self.database.session.begin() as session:
            account = _known(session, name)
            for field, value in values.items():
                setattr(account, field, value)
            if account.suspended:
                session.execute(delete(SignIn).where(SignIn.person == name))

    def delete(self, name: str) -> int:
        """Deletes an account with its runs, studies and files; returns the number of runs."""
        with self.database.session.begin() as session:
            locked(session)
            account = _known(session, name)
            gone = {
                folder: list(session.scalars(delete(table).where(table.owner == account.owner).returning(table.id)))
                for folder, table in (("motions", Run), ("studies", Study))
            }  # with what is written on them
            session.delete(account)
        for folder in (self.data / kind / key for kind, keys in gone.items() for key in keys):
            shutil.rmtree(folder, ignore_errors=True)
        shutil.rmtree(self.data / "scratch" / "uploads" / digest(account.owner), ignore_errors=True)
        audit("admin-delete", target=name, runs=len(gone["motions"]), studies=len(gone["studies"]))
        return len(gone["motions"])


def _known(session: Session, name: str) -> Account:
    """An account; raises InputError if there is none of this name."""
    account = session.get(Account, name)
    if account is None:
        raise InputError(f"There is no account {name!r:.60}: see `admin list`.")
    return account
