"""Who asks: by sign-in, by a cookie, or by address; and whose page session is whose."""

from __future__ import annotations

import hashlib
import secrets
import threading
import time
from collections import OrderedDict
from collections.abc import Mapping

from webdemo.ui.visitor import Visitor

from .accounts import SignIns
from .bodies import Refused
from .settings import Settings, is_loopback

SESSION_COOKIE = "pasdedeux_session"
VISITOR_COOKIE = "pasdedeux_visitor"
_REMEMBERED = 10.0
"""Seconds for which a sign-in is not looked up anew."""
_MOST = 20_000


class Visitors:
    """Tells who a request is from.

    Args:
        settings: whether there are accounts, and whether others than this machine are let in.
        sign_ins: sessions of people with accounts; None without accounts.
    """

    def __init__(self, settings: Settings, sign_ins: SignIns | None) -> None:
        self.settings, self.sign_ins = settings, sign_ins
        self._lock = threading.Lock()
        self._known: OrderedDict[str, tuple[str | None, float]] = OrderedDict()

    def of(self, cookies: Mapping[str, str], address: str, *, reference: str, base: str) -> Visitor | None:
        """The visitor, or None for one who has to sign in first.

        Raises:
            Refused: where others come through a proxy and nobody said that they may.
        """
        if self.sign_ins is not None:
            person = self._signed_in(cookies.get(SESSION_COOKIE, ""))
            name = f"user {person}"
            return None if person is None else Visitor(name, name, reference, base, person)
        local = is_loopback(address)
        if not local and not self.settings.open:
            raise Refused(
                403,
                "This server is for its own machine: its owner can make accounts or set PASDEDEUX_OPEN=1.",
                "not open",
            )
        token = cookies.get(VISITOR_COOKIE, "")
        browser = f"visitor {digest(token)}" if 20 <= len(token) <= 100 else ""
        if self.settings.open:
            return Visitor(browser or f"address {address}", browser, reference, base, address=address)
        return Visitor(browser or "local", "local", reference, base)

    def forget(self, token: str) -> None:
        """A session was signed out."""
        with self._lock:
            self._known.pop(digest(token), None)

    def _signed_in(self, token: str) -> str | None:
        if not token or self.sign_ins is None:
            return None
        key, now = digest(token), time.monotonic()
        with self._lock:
            known = self._known.get(key)
        if known is not None and known[1] > now:
            return known[0]
        person = self.sign_ins.person(token)
        with self._lock:
            self._known[key] = (person, now + _REMEMBERED)
            while len(self._known) > _MOST:
                self._known.popitem(last=False)
        return person


class Bindings:
    """Whose page session is whose: the first who uses one keeps it.

    Gradio hands a session's results to anybody who names it; here only its owner is let through.
    """

    def __init__(self) -> None:
        self._owners: OrderedDict[str, str] = OrderedDict()
        self._lock = threading.Lock()

    def check(self, session: str, person: str, *, begin: bool) -> None:
        """Raises Refused where the session is another person's; ``begin`` makes an unknown one theirs."""
        if len(session) > 100:
            raise Refused(400, "The session's name is too long: reload the page.", "forged")
        with self._lock:
            owner = self._owners.get(session)
            if owner is None and begin:
                self._owners[session] = person
                while len(self._owners) > _MOST:
                    self._owners.popitem(last=False)
            elif owner is not None:
                self._owners.move_to_end(session)
        if owner is not None and owner != person:
            raise Refused(403, "This session is somebody else's: reload the page.", "forged")


class Rates:
    """A bucket of requests for every person, refilled steadily.

    Args:
        a_minute: how many; as many may come at once.
    """

    def __init__(self, a_minute: int) -> None:
        self.a_minute = a_minute
        self._buckets: OrderedDict[str, tuple[float, float]] = OrderedDict()

    def take(self, person: str, weight: float = 1.0) -> None:
        """Takes a request, or one as heavy as several; raises Refused where too little is left.

        A bucket that is full is enough for any one request.
        """
        now = time.monotonic()
        left, then = self._buckets.pop(person, (float(self.a_minute), now))
        left = min(self.a_minute, left + (now - then) * self.a_minute / 60)
        enough = left >= min(weight, self.a_minute)
        self._buckets[person] = (max(left - weight, 0.0) if enough else left, now)
        while len(self._buckets) > _MOST:
            self._buckets.popitem(last=False)
        if not enough:
            raise Refused(429, "These are too many requests in a minute: wait a little.", "rate")


def digest(token: str) -> str:
    """By which a secret is known without being kept."""
    return hashlib.sha256(token.encode()).hexdigest()[:32]


def new_token() -> str:
    """An unguessable name for a browser."""
    return secrets.token_urlsafe(24)
