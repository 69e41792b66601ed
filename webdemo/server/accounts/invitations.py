"""Invitations: a link by which a person chooses the password of an account that an administrator has named."""

from __future__ import annotations

import hashlib
import secrets
import time
from typing import Any, cast

from fastapi import APIRouter, Form, Request
from sqlalchemy import CursorResult, delete
from starlette.concurrency import run_in_threadpool
from starlette.responses import HTMLResponse, RedirectResponse, Response

from motion import InputError
from webdemo.server.audit import audit
from webdemo.server.http.cookies import set_cookie
from webdemo.server.http.error_pages import invitation_card, never_kept
from webdemo.server.http.networks import network_of
from webdemo.server.http.refused import Refused
from webdemo.server.settings import Settings
from webdemo.server.store.database import Database, Invitation
from webdemo.server.store.people import People

from .users import NAME, SignIns, Users
from .visitors import SESSION_COOKIE

DAYS = 7.0
"""How long an invitation lasts unless something else is said."""
MOST_DAYS = 90.0
PATH = "/login/invited/"
"""Before an invitation's key."""
_ENDED = "This invitation has been used or has ended: ask the person who runs this server for another one."
_DIFFER = "The two passwords differ: type them again."


class Invitations:
    """Invitations that nobody has used yet; only the hash of a link's key is stored.

    Args:
        database: holds them.
        users: the accounts.
    """

    def __init__(self, database: Database, users: Users) -> None:
        self.database, self.users, self.people = database, users, People(database)

    def invite(self, name: str, *, megabytes: float | None = None, days: float = DAYS) -> str:
        """The path of a new link, on which somebody makes the account ``name``; an earlier link to it ends.

        Args:
            name: of the account.
            megabytes: the account's room; None: as everybody's.
            days: how long the link lasts.

        Raises:
            InputError: if the name is taken or cannot be used, or a number is out of its range.
        """
        if not NAME.match(name):
            raise InputError(
                f"{name!r:.60} is not a valid account name: use up to 40 of a-z, 0-9, '.', '_' and '-'."
            )
        if self.users.path.exists() and self.users.entry(name) is not None:
            raise InputError(f"There is an account {name} already: choose another name.")
        if megabytes is not None and not 1 <= megabytes <= 1e9:
            raise InputError("Give a room of 1 MB or more, or none for everybody's.")
        if not 0 < days <= MOST_DAYS:
            raise InputError(f"An invitation lasts up to {MOST_DAYS:g} days.")
        key, now = secrets.token_urlsafe(24), time.time()
        with self.database.session.begin() as session:
            session.execute(delete(Invitation).where((Invitation.name == name) | (Invitation.until < now)))
            until = now + 86_400 * days
            session.add(Invitation(digest=_digest(key), name=name, megabytes=megabytes, until=until))
        return PATH + key

    def name_of(self, key: str) -> str | None:
        """The account that somebody may make by a link; None if it was used, has ended, or never was."""
        found = self._found(key)
        return found.name if found is not None else None

    def _found(self, key: str) -> Invitation | None:
        with self.database.session() as session:
            found = session.get(Invitation, _digest(key))
        return found if found is not None and found.until >= time.time() else None

    def accept(self, key: str, password: str) -> str | None:
        """Makes the account; returns its name, or None if the link no longer works.

        Raises:
            InputError: if the password is too short or too long, or the name was taken meanwhile; the link still works.
        """
        found = self._found(key)
        if found is None:
            return None
        name, room = found.name, found.megabytes
        if self.users.path.exists() and self.users.entry(name) is not None:
            raise InputError(f"There is an account {name} already: ask for an invitation to another name.")
        self.users.check(name, password)
        with self.database.session.begin() as session:
            used = session.execute(delete(Invitation).where(Invitation.digest == _digest(key)))
        if not cast(CursorResult[Any], used).rowcount:  # by another request meanwhile
            return None
        self.users.add(name, password)
        if room is not None:
            self.people.set(name, megabytes=room)
        return name


def invitation_routes(settings: Settings, sign_ins: SignIns, invitations: Invitations) -> APIRouter:
    """``/login/invited/KEY``: a form for a password, and POST for it."""
    router, root = APIRouter(), settings.root_path

    def page(key: str, name: str, *, error: str = "", status: int = 200) -> HTMLResponse:
        body = invitation_card(action=f"{root}{PATH}{key}", name=name, error=error)
        return never_kept(body, status)

    @router.get(PATH + "{key}")
    def ask(key: str) -> Response:
        return page(key, _invited(invitations, key))

    @router.post(PATH + "{key}")
    async def accept(
        request: Request,
        key: str,
        new: str = Form("", max_length=1000),
        again: str = Form("", max_length=1000),
    ) -> Response:
        name = await run_in_threadpool(_invited, invitations, key)
        if new != again:
            return page(key, name, error=_DIFFER, status=422)
        try:
            made = await run_in_threadpool(invitations.accept, key, new)
        except InputError as error:
            return page(key, name, error=str(error), status=422)
        if made is None:
            raise Refused(404, _ENDED, "invitation")
        audit("invitation-accepted", person=made)
        address = network_of(request.client.host if request.client else "")
        token = await run_in_threadpool(sign_ins.begin, made, new, address)
        response = RedirectResponse(f"{root}/", status_code=303)
        if token is not None:
            secure = request.url.scheme == "https"
            set_cookie(response, SESSION_COOKIE, token, seconds=sign_ins.seconds, root=root, secure=secure)
        return response

    return router


def _invited(invitations: Invitations, key: str) -> str:
    """The name on an invitation; raises Refused for one that no longer works."""
    name = invitations.name_of(key[:100])
    if name is None:
        raise Refused(404, _ENDED, "invitation")
    return name


def _digest(key: str) -> str:
    return hashlib.sha256(key.encode(errors="replace")).hexdigest()
