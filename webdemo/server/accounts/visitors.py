"""Identifies visitors by sign-in, cookie or address, and tracks the owners of page sessions."""

from __future__ import annotations

import hashlib
import re
import secrets
import threading
from collections import OrderedDict
from dataclasses import replace
from functools import lru_cache
from typing import Any, cast

from starlette.datastructures import Headers
from starlette.requests import cookie_parser
from starlette.responses import Response
from starlette.types import Scope
from uvicorn.middleware.proxy_headers import ProxyHeadersMiddleware

from webdemo.server.accounts.quotas import network_of
from webdemo.server.http.routes import Refused
from webdemo.server.settings import Settings, is_loopback, on_a_space
from webdemo.server.store.database import Account
from webdemo.ui.visitor import Visitor

from .accounts import SUSPENDED, Accounts

SESSION_COOKIE = "pasdedeux_session"
VISITOR_COOKIE = "pasdedeux_visitor"
KNOWN_COOKIE = "pasdedeux_known"
YEAR = 365 * 86_400.0
_MOST = 20_000
_NOT_OPEN = "This server answers only its own machine: its owner can make accounts or set PASDEDEUX_OPEN=1."


def find_visitor(settings: Settings, accounts: Accounts, scope: Scope, nobody: Visitor) -> Visitor | None:
    """The sender of a request, or None if they must sign in first.

    Args:
        settings: whether there are accounts, and whether other machines may connect.
        accounts: of people who sign in, or whom a proxy names.
        scope: the request's.
        nobody: a visitor of whom no more is known than the request.

    Raises:
        Refused: if a request from elsewhere arrives at a server that is not open, or at one whose people sign in at its
            proxy alone.
    """
    cookies = cookie_parser(dict(scope["headers"]).get(b"cookie", b"").decode("latin-1"))
    if settings.sign_in:
        account: Account | None
        if by_proxy := person_by_proxy(settings, scope):
            account = accounts.arrive(by_proxy)
            if account.suspended:
                raise Refused(403, SUSPENDED, "suspended")
        elif not settings.accounts:
            raise Refused(401, _NOT_BY_PROXY, "proxy")
        else:
            token = cookies.get(SESSION_COOKIE, "")
            account = accounts.person(token) if token else None
        if account is None:
            return None
        return replace(nobody, person=account.owner, owner=account.owner, account=account.name)
    address = (scope.get("client") or ("127.0.0.1", 0))[0]
    if not is_loopback(address) and not settings.open:
        raise Refused(403, _NOT_OPEN, "not open")
    token = cookies.get(VISITOR_COOKIE, "")
    browser = f"visitor {digest(token)}" if 20 <= len(token) <= 100 else ""
    if settings.open:
        return replace(nobody, person=browser or nobody.person, owner=browser, address=network_of(address))
    return replace(nobody, person=browser or "local", owner="local")


class Bindings:
    """Tracks the owners of page sessions and calls: the first person who uses a session owns it.

    Gradio hands the results of a session, and of a call, to anybody who names it; here only its owner is let
    through.
    """

    def __init__(self) -> None:
        self._owners: OrderedDict[str, tuple[str, str]] = OrderedDict()
        self._lock = threading.Lock()

    def home(self, name: str) -> str:
        """Where a session comes from, see :attr:`.Visitor.source`; "" if it is unknown."""
        return self._owners.get(name, ("", ""))[1]

    def check(self, name: object, person: str, source: str = "", *, begin: bool = False, known: bool = False) -> None:
        """Raises Refused if a session or call is another person's.

        Args:
            name: of the session or call.
            person: who uses it.
            source: theirs.
            begin: makes an unknown one theirs.
            known: refuses an unknown one.
        """
        if not isinstance(name, str) or not name:  # Gradio takes an empty one for another name
            raise Refused(400, "The session has no name: reload the page.", "forged")
        if len(name) > 100:
            raise Refused(400, "The session's name is too long: reload the page.", "forged")
        with self._lock:
            owner, _ = self._owners.get(name, (None, ""))
            if owner is None and begin:
                self._owners[name] = person, source
                while len(self._owners) > _MOST:
                    self._owners.popitem(last=False)
            elif owner is not None:
                self._owners.move_to_end(name)
        if owner is None and known:
            raise Refused(404, "There is no such call: send it again.", "forged")
        if owner is not None and owner != person:
            raise Refused(403, "This session is somebody else's: reload the page.", "forged")

    def forget(self, name: str) -> None:
        """Makes a session or call unknown."""
        with self._lock:
            self._owners.pop(name, None)


def digest(token: str) -> str:
    """A hash that identifies a secret without storing it."""
    return hashlib.sha256(token.encode()).hexdigest()[:32]


def new_token() -> str:
    """An unguessable name for a browser."""
    return secrets.token_urlsafe(24)


# ---- cookies ----------------------------------------------------------------------------------------


def set_cookie(response: Response, name: str, value: str, *, seconds: float, root: str, secure: bool) -> None:
    """Sets a cookie that scripts cannot read and other sites' forms do not send.

    Args:
        response: carries it.
        name: of the cookie.
        value: of the cookie.
        seconds: how long the browser keeps it.
        root: path below which it is sent; empty for all.
        secure: whether it is sent over TLS only.
    """
    space = on_a_space()  # there the page is in a frame of another site's
    response.set_cookie(
        name,
        value,
        max_age=int(seconds),
        path=root or "/",
        httponly=True,
        secure=secure or space,
        samesite="none" if space else "lax",
    )


# ---- the header of a proxy -----------------------------------------------------------------------
# Who a person is, the proxy says, and nobody else can. uvicorn puts the forwarded address in the place of the proxy's.
# So the connection itself writes down where it came from (:mod:`webdemo.server.http.connections`), and a header counts
# only if that is a trusted proxy's.


PEER = "peer"
"""Key of the state of a request's scope: the address that its connection came from."""
_PROXY_NAME = re.compile(r"\A[a-z0-9][a-z0-9._@+-]{0,79}\Z")
"""Names of people who sign in elsewhere, in lower case: also addresses of mail."""
_NOT_BY_PROXY = "This lab is reached through its proxy, where you sign in: open its usual address."
_BAD_NAME = "The proxy's name for you cannot be used here: tell the person who runs this server."


@lru_cache(maxsize=8)
def trusted_hosts(proxies: tuple[str, ...]) -> Any:
    """uvicorn's reading of addresses and networks: what it trusts to forward is also what may name people."""
    return cast(Any, ProxyHeadersMiddleware)(None, trusted_hosts=list(proxies)).trusted_hosts


def person_by_proxy(settings: Settings, scope: Scope) -> str:
    """The name that a trusted proxy gives the sender of a request; "" where it gives none.

    Raises:
        Refused: for a request that did not come through a trusted proxy and bears the header, and for a name that
            cannot be used.
    """
    names = Headers(scope=scope).getlist(settings.proxy_user) if settings.proxy_user else []
    if not names:
        return ""
    if scope.get("state", {}).get(PEER, "") not in trusted_hosts(tuple(settings.proxies)):
        raise Refused(403, _NOT_BY_PROXY, "proxy")
    name = names[0].strip().lower()
    if not name:
        return ""
    if len(names) > 1 or not _PROXY_NAME.match(name):
        raise Refused(403, _BAD_NAME, "proxy")
    return name
